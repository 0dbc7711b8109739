"""Pictures of a model by Cycles at one sample, from evenly spaced azimuths, with depth, normals and object numbers, in one process:

    blender -b --factory-startup -noaudio -P cycles_views.py -- MODEL SIZE AZIMUTHS ENV OUT

AZIMUTHS are degrees, separated by commas; OUT is a prefix, to which Blender adds the number and .exr.
"""

import math
import sys

import bpy
import mathutils
import numpy

numpy.bool = bool  # which Blender 3.4's importer of glTF still asks for, and newer versions of numpy have not


def main():
    model, size, azimuths, environment, out = sys.argv[sys.argv.index("--") + 1 :]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=model)
    scene = bpy.context.scene
    for number, thing in enumerate(scene.objects, 1):
        thing.pass_index = number
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 1
    scene.cycles.use_denoising = False
    scene.render.use_persistent_data = True  # what does not change between pictures is kept
    scene.render.resolution_x = scene.render.resolution_y = int(size)
    scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    layer = bpy.context.view_layer
    layer.use_pass_z = layer.use_pass_normal = layer.use_pass_object_index = True

    world = scene.world = bpy.data.worlds.new("world")
    world.use_nodes = True
    nodes = world.node_tree.nodes
    picture = nodes.new("ShaderNodeTexEnvironment")
    picture.image = bpy.data.images.load(environment)
    world.node_tree.links.new(picture.outputs["Color"], nodes["Background"].inputs["Color"])

    corners = [o.matrix_world @ mathutils.Vector(c) for o in scene.objects if o.type == "MESH" for c in o.bound_box]
    low = mathutils.Vector(min(c[i] for c in corners) for i in range(3))
    high = mathutils.Vector(max(c[i] for c in corners) for i in range(3))
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.angle = math.radians(45)
    scene.collection.objects.link(camera)
    scene.camera = camera
    distance = 0.55 * (high - low).length / math.tan(math.radians(22.5))
    for index, azimuth in enumerate(map(float, azimuths.split(","))):
        angle = math.radians(azimuth)
        away = mathutils.Vector((math.sin(angle), -math.cos(angle), 0.36)).normalized()
        camera.location = 0.5 * (low + high) + distance * away
        camera.rotation_euler = away.to_track_quat("Z", "Y").to_euler()
        scene.render.filepath = f"{out}{index:03}.exr"
        bpy.ops.render.render(write_still=True)


main()
