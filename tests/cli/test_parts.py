#!/usr/bin/env python3
"""A program without some of its parts: what needs one is refused in one line that names its option, the rest is done."""

import base64
import json
import os
import struct
import subprocess

import candela
from candela import CliTest

PARTS = set(filter(None, os.environ.get("CANDELA_PARTS", "").split(",")))


def glass_gltf(turned=False):
    """A tetrahedron of glass, a tenth as thick as it says."""
    positions = base64.b64encode(struct.pack("<12f", 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1)).decode()
    faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    order = [i for a, b, c in faces for i in ((a, c, b) if turned else (a, b, c))]
    triangles = base64.b64encode(struct.pack("<12H", *order)).decode()
    extensions = {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_volume": {"thicknessFactor": 10}}
    scene = {
        "asset": {"version": "2.0"},
        "extensionsUsed": list(extensions),
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0.2}, "extensions": extensions}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]},
            {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"},
        ],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 1, "byteLength": 24}],
        "buffers": [
            {"byteLength": 48, "uri": "data:application/octet-stream;base64," + positions},
            {"byteLength": 24, "uri": "data:application/octet-stream;base64," + triangles},
        ],
    }
    return json.dumps(scene)


class PartsTest(CliTest):
    def refuses_without(self, part, *arguments):
        self.fails(*arguments, says=f"-DCANDELA_WITH_{part.upper()}=ON")

    def codes(self, *arguments):
        report = json.loads(self.succeeds("check", *arguments, "--json").out)
        return {f["code"]: f for asset in report["assets"] for f in asset["findings"]}

    def test_scenes_are_read_and_described(self):
        (self.folder / "a.glb").write_bytes(candela.triangle_glb())
        self.assertIn("triangles", self.succeeds("info", "a.glb").out)
        self.assertIn("a.glb: ", self.succeeds("check", "a.glb").out)

    def test_light_is_baked(self):
        self.succeeds("bake", "studio", "-o", "light", "--size", "16", "--levels", "2", "-q")
        self.assertTrue(any((self.folder / "light").iterdir()))
        self.succeeds("bake", "sky", "-o", "three", "--profile", "three", "--size", "16", "-q")

    def test_materials_are_measured(self):
        report = json.loads(self.succeeds("furnace", "--json", "-q", timeout=600).out)
        self.assertTrue(report)

    def test_check_says_which_rays_it_could_not_cast(self):
        (self.folder / "glass.gltf").write_text(glass_gltf())
        found = self.codes("glass.gltf")
        if "path" in PARTS:
            self.assertIn("thickness-mismatch", found)
            self.assertNotIn("volume-unmeasured", found)
        else:
            self.assertEqual(found["volume-unmeasured"]["severity"], "note")
            self.assertEqual(found["volume-unmeasured"]["subject"], "1 body")
            self.assertIn("CANDELA_WITH_PATH", found["volume-unmeasured"]["message"])
        (self.folder / "turned.gltf").write_text(glass_gltf(turned=True))
        self.assertIn("volume-inside-out", self.codes("turned.gltf"))

    def test_what_traces_needs_the_path_tracer(self):
        if "path" in PARTS:
            self.succeeds("render", "demo:spheres", "-o", "a.png", *candela.TINY)
            return
        self.refuses_without("path", "render", "demo:spheres", "-o", "a.png")
        self.refuses_without("path", "figures", "-o", "book")
        self.refuses_without("path", "bake", "--from-scene", "demo:spheres", "--at", "0,1,0", "-o", "light")

    def test_what_draws_needs_the_rasterizer(self):
        if "raster" in PARTS:
            return
        self.refuses_without("raster", "render", "demo:spheres", "-o", "a.png", "--engine", "raster")
        self.refuses_without("raster", "render", "demo:spheres", "-o", "a.png", "--engine", "raster", "--view", "normal")

    def test_a_window_needs_windows(self):
        if "window" not in PARTS:
            self.refuses_without("window" if "raster" in PARTS else "raster", "view", "demo:spheres", "--env", "sky")

    def test_other_formats_need_assimp(self):
        (self.folder / "a.stl").write_text("solid a\nfacet normal 0 0 1\n")
        if "assimp" not in PARTS:
            self.refuses_without("assimp", "info", "a.stl")

    def test_no_library_of_an_absent_part_is_loaded(self):
        loaded = subprocess.run(["ldd", candela.PROGRAM], capture_output=True, text=True, check=True).stdout
        self.assertIn("libOpenEXR", loaded)
        for part, library in (("path", "embree"), ("raster", "libEGL"), ("raster", "libGLES"), ("assimp", "libassimp")):
            self.assertEqual(part in PARTS, library in loaded, library)
        self.assertNotIn("libglfw", loaded)  # which a window alone looks for


if __name__ == "__main__":
    candela.main()
