"""blender -b --factory-startup -P blender_export.py -- IN.glb OUT.EXT"""

import sys

import numpy

numpy.bool = bool  # Blender 3.4's glTF add-on uses a name that newer versions of numpy lack
import bpy  # noqa: E402

source, result = sys.argv[-2:]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=source)
kind = result.rsplit(".", 1)[1]
if kind == "glb":
    bpy.ops.export_scene.gltf(filepath=result, export_lights=True, export_cameras=True)
elif kind == "fbx":
    bpy.ops.export_scene.fbx(filepath=result, path_mode="COPY", embed_textures=True)
elif kind == "dae":
    bpy.ops.wm.collada_export(filepath=result)
elif kind == "obj":
    bpy.ops.wm.obj_export(filepath=result, export_pbr_extensions=True)
elif kind == "ply":
    bpy.ops.export_mesh.ply(filepath=result, axis_forward="-Z", axis_up="Y")
elif kind == "stl":
    bpy.ops.export_mesh.stl(filepath=result, axis_forward="-Z", axis_up="Y")
