#!/usr/bin/env python3
"""What files of real tools are shown as: their numbers, their lamps, their cameras, and what is wrong with them."""

import json
import struct

import candela
from candela import TINY, CliTest, png_pixels
from test_check import Asset, pbr

FLAT = ("--env", "none", "--exposure", "0", "--tonemap", "linear")
ENGINES = ("path", "raster")


class Files(CliTest):
    def write(self, asset, name="a.gltf"):
        (self.folder / name).write_text(asset if isinstance(asset, str) else asset.text())

    def camera(self, asset, at=(0, 0, 5), **more):
        cameras = asset.json.setdefault("cameras", [])
        cameras.append({"type": "perspective", "perspective": {"yfov": 0.6, "znear": 0.1}, **more})
        return asset.node(camera=len(cameras) - 1, translation=list(at))

    def quad_of(self, material):
        asset = Asset()
        asset.quad(asset.material(material))
        return asset

    def warnings(self, *arguments):
        return [line for line in self.succeeds(*arguments).err.splitlines() if line.startswith("warning: ")]

    def share_of_white(self, name):
        _, _, channels, rows = png_pixels(self.folder / name)
        pixels = [row[i : i + 3] for row in rows for i in range(0, len(row), channels)]
        return sum(min(p) >= 254 for p in pixels) / len(pixels)

    # ----- cameras

    def test_a_camera_that_sees_nothing_is_told_and_the_subject_framed(self):
        framed = self.quad_of(pbr())
        self.write(framed, "framed.gltf")
        away = self.quad_of(pbr())
        self.camera(away, (0, 0, -5), name="wrong way")  # it looks along -z
        self.write(away)
        for engine in ENGINES:
            out = ("--engine", engine, "--size", "32x24", "--spp", "2")
            told = self.warnings("render", "a.gltf", *out, "-o", "a.png")
            self.assertEqual(len(told), 1, told)
            self.assertIn("the camera 0 'wrong way' sees nothing of the scene; the whole scene is framed", told[0])
            self.assertEqual(self.warnings("render", "framed.gltf", *out, "-o", "b.png"), [])
            self.assertEqual(png_pixels(self.folder / "a.png"), png_pixels(self.folder / "b.png"))
        # Whoever asks for it gets it, with a word.
        asked = self.warnings("render", "a.gltf", *TINY, "--camera", "0", "-o", "c.png")
        self.assertEqual(asked, ["warning: a.gltf: the camera 0 sees nothing of the scene"])
        self.fails("render", "a.gltf", *TINY, "-q", "--strict", "-o", "d.png", says="sees nothing")
        self.assertIn("sees nothing", json.loads(self.succeeds("info", "a.gltf", "--json").out)["warnings"][0])
        # Another view makes it nobody's business.
        self.assertEqual(self.warnings("render", "a.gltf", *TINY, "--orbit", "0,0", "-o", "e.png"), [])

    def test_cameras_in_rooms_and_of_scenes_without_meshes_are_left_alone(self):
        room = Asset()
        room.cube(room.material(pbr()), side=4.0, inward=True)
        self.camera(room, (0, 0, 0))
        self.write(room)
        self.assertEqual(self.warnings("render", "a.gltf", *TINY, "-o", "a.png"), [])
        sky = Asset()
        self.camera(sky)
        self.write(sky)
        told = self.warnings("render", "a.gltf", *TINY, "-o", "a.png")
        self.assertEqual(told, ["warning: a.gltf: nothing in the scene has a mesh"])

    def test_a_camera_is_asked_for_by_its_number_in_the_file(self):
        asset = self.quad_of(pbr())
        for z in (5, 9):
            self.camera(asset, (0, 0, z))
        asset.json["scenes"][0]["nodes"].remove(1)  # the first camera's node is in no scene
        self.write(asset)
        self.succeeds("render", "a.gltf", *TINY, "--camera", "1", "-o", "a.png")
        self.fails("render", "a.gltf", *TINY, "--camera", "0", "-o", "b.png", says=r'no camera "0" \(known: 1\)')
        info = json.loads(self.succeeds("info", "a.gltf", "--json").out)
        self.assertEqual([c["index"] for c in info["cameras"]], [1])
        self.assertRegex(self.succeeds("info", "a.gltf").out, r"(?m)^cameras +1\n +1 \(no name\)")

    # ----- light

    def lit_by(self, light, **more):
        asset = Asset()
        asset.mesh(asset.material(pbr((0.5, 0.5, 0.5))), [(-5, 0, 5), (5, 0, 5), (5, 0, -5), (-5, 0, -5)], [(0, 1, 2), (0, 2, 3)])
        if light:
            asset.json["extensionsUsed"] = ["KHR_lights_punctual"]
            asset.json["extensions"] = {"KHR_lights_punctual": {"lights": [light]}}
            asset.node(translation=[0, 2, 0], extensions={"KHR_lights_punctual": {"light": 0}})
        asset.json |= more
        return asset

    def test_lamps_in_real_units_are_metered(self):
        for name, light in {
            "bulb of 100 W": {"type": "point", "intensity": 5435},
            "sun": {"type": "directional", "intensity": 1e5},
        }.items():
            asset = self.lit_by(light)
            if name == "sun":
                asset.json["nodes"][-1]["rotation"] = [-0.7071068, 0, 0, 0.7071068]
            self.write(asset)
            for engine in ENGINES:
                with self.subTest(name, engine=engine):
                    out = ("--engine", engine, "--size", "48x36", "--spp", "4", "-q", "--orbit", "0,45,0.5")
                    self.succeeds("render", "a.gltf", *out, "-o", "a.png")
                    self.assertLess(self.share_of_white("a.png"), 0.25)
                    self.succeeds("render", "a.gltf", *out, "--exposure", "0", "-o", "b.png")
                    self.assertGreater(self.share_of_white("b.png"), 0.5, "an exposure that is asked for is obeyed")

    def test_a_backdrop_that_lamps_do_not_light_does_not_make_what_they_light_white(self):
        # A box on a floor, seen before the studio, which is a thousandth as bright.
        for intensity in (3e3, 6830, 1e5, 1e6):
            asset = self.lit_by({"type": "directional", "intensity": intensity})
            asset.json["nodes"][-1]["rotation"] = [-0.7071068, 0, 0, 0.7071068]
            asset.cube(asset.material(pbr((0.7, 0.2, 0.1))))
            self.write(asset)
            for env in ("studio", "none"):
                means = []
                for engine in ENGINES:
                    with self.subTest(intensity, env=env, engine=engine):
                        out = ("--engine", engine, "--size", "48x36", "--spp", "16", "-q", "--env", env, "--orbit", "20,25,1")
                        self.succeeds("render", "a.gltf", *out, "-o", "a.png")
                        self.assertLess(self.share_of_white("a.png"), 0.05)
                        *_, rows = png_pixels(self.folder / "a.png")
                        means.append(sum(map(sum, rows)))
                self.assertAlmostEqual(means[0] / means[1], 1.0, delta=0.2, msg=f"{intensity}, {env}")

    def test_lamps_that_give_next_to_nothing_keep_the_studios_exposure(self):
        out = (*TINY, "-q", "--orbit", "0,45,0.5")
        for light in (None, {"type": "point", "intensity": 1e-4}):
            self.write(self.lit_by(light))
            self.succeeds("render", "a.gltf", *out, "-o", "a.png")
            self.succeeds("render", "a.gltf", *out, "--exposure", "0", "-o", "b.png")
            self.assertEqual(png_pixels(self.folder / "a.png"), png_pixels(self.folder / "b.png"))

    # ----- colours of instances

    def test_instances_have_their_colours(self):
        for engine in ENGINES:
            asset = self.quad_of(pbr((1, 1, 1), extensions={"KHR_materials_unlit": {}}))
            self.camera(asset, (0, 0, 9))
            asset.json["extensionsUsed"] = ["EXT_mesh_gpu_instancing", "KHR_materials_unlit"]
            attributes = {
                "TRANSLATION": asset.accessor([(-2, 0, 0), (0, 0, 0), (2, 0, 0)], "VEC3"),
                "SCALE": asset.accessor([(0.8, 0.8, 0.8)] * 3, "VEC3"),
                "_COLOR_0": asset.accessor([(1, 0, 0), (0, 1, 0), (0, 0, 1)], "VEC3"),
            }
            asset.json["nodes"][0]["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": attributes}}
            self.write(asset)
            self.succeeds("render", "a.gltf", *FLAT, "--engine", engine, "--size", "54x18", "--spp", "4", "-q", "-o", "a.png")
            _, _, channels, rows = png_pixels(self.folder / "a.png")
            for x, color in ((20, (255, 0, 0)), (27, (0, 255, 0)), (33, (0, 0, 255))):
                self.assertEqual(tuple(rows[9][x * channels : x * channels + 3]), color, engine)

    # ----- images

    def test_a_missing_texture_is_a_warning_and_the_factor_shows(self):
        asset = self.quad_of(pbr())
        asset.json["materials"][0] = pbr((0.0, 1.0, 0.0), baseColorTexture=asset.texture("absent.png"), extensions={"KHR_materials_unlit": {}})
        asset.json["extensionsUsed"] = ["KHR_materials_unlit"]
        self.camera(asset, (0, 0, 2))
        self.write(asset)
        for engine in ENGINES:
            told = self.warnings("render", "a.gltf", *FLAT, *TINY, "--engine", engine, "-o", "a.png")
            self.assertEqual(len(told), 1, told)
            self.assertRegex(told[0], "#/images/0/uri: 'absent.png': .*; shown without it")
            _, _, channels, rows = png_pixels(self.folder / "a.png")
            self.assertEqual(tuple(rows[6][8 * channels : 8 * channels + 3]), (0, 255, 0), engine)
        self.fails("render", "a.gltf", *TINY, "-q", "--strict", "-o", "b.png", says="absent.png.*--strict")
        info = json.loads(self.succeeds("info", "a.gltf", "--json").out)
        self.assertIn("absent.png", info["images"][0]["error"])
        self.assertRegex(self.succeeds("info", "a.gltf").out, r"(?m)^ +0 absent.png: .*cannot be read")

    # ----- what is odd

    def test_notes_are_for_info_and_check_and_no_warnings(self):
        asset = self.quad_of(pbr())
        asset.json["extensionsUsed"] = ["KHR_physics_rigid_bodies"]
        asset.json["nodes"][0]["extensions"] = {"KHR_physics_rigid_bodies": {"motion": {"mass": 1}}}
        self.write(asset)
        self.assertEqual(self.warnings("render", "a.gltf", *TINY, "--strict", "-o", "a.png"), [])
        info = json.loads(self.succeeds("info", "a.gltf", "--json").out)
        self.assertEqual((info["warnings"], len(info["notes"])), ([], 1))
        self.assertEqual(info["extensions"]["all"][0]["status"], "no effect on pixels")
        self.assertRegex(self.succeeds("check", "a.gltf", "--strict").out, "note +no-effect .*KHR_physics_rigid_bodies changes no pixel")

    def test_a_vertex_far_out_is_told_where_the_scene_is_framed(self):
        asset = Asset()
        asset.cube(asset.material(pbr()))
        asset.data = struct.pack("<3f", 1e6, 0, 0) + asset.data[12:]
        self.write(asset)
        told = self.warnings("render", "a.gltf", *TINY, "-o", "a.png")
        self.assertEqual(len(told), 1, told)
        self.assertIn("node 0 has a vertex 1e+06 m from the rest", told[0])
        self.assertEqual(self.warnings("render", "a.gltf", *TINY, "--eye", "0,0,5", "-o", "a.png"), [])
        self.assertIn("1e+06 m from the rest", json.loads(self.succeeds("info", "a.gltf", "--json").out)["warnings"][0])
        self.assertRegex(self.succeeds("check", "a.gltf").out, "warning +vertex-far-out ")

    def test_things_too_far_apart_to_be_seen_are_told_where_the_scene_is_framed(self):
        asset = Asset()
        asset.cube(asset.material(pbr()))
        asset.json["nodes"].append({"mesh": 0, "translation": [1e6, 0, 0]})
        asset.json["scenes"][0]["nodes"].append(len(asset.json["nodes"]) - 1)
        self.write(asset)
        says = "node 0 and node 1 lie 1e+06 m apart"
        for engine in ("path", "raster"):
            told = self.warnings("render", "a.gltf", *TINY, "--engine", engine, "-o", "a.png")
            self.assertEqual(len(told), 1, told)
            self.assertIn(says, told[0])
        self.assertEqual(self.warnings("render", "a.gltf", *TINY, "--eye", "0,0,5", "-o", "a.png"), [])
        self.assertIn(says, json.loads(self.succeeds("info", "a.gltf", "--json").out)["warnings"][0])
        self.assertRegex(self.succeeds("check", "a.gltf").out, "warning +vertex-far-out ")

    def test_meshes_of_points_and_no_meshes_are_told_apart(self):
        for mode, says in ((0, "no mesh of the scene has a triangle"), (None, "nothing in the scene has a mesh")):
            asset = self.quad_of(pbr())
            if mode is None:
                del asset.json["nodes"][0]["mesh"]
            else:
                asset.json["meshes"][0]["primitives"][0]["mode"] = mode
            self.write(asset)
            self.assertTrue(any(says in w for w in self.warnings("render", "a.gltf", *TINY, "-o", "a.png")), says)
            self.assertIn(says, json.loads(self.succeeds("info", "a.gltf", "--json").out)["warnings"][-1])
            self.assertIn(says, self.succeeds("check", "a.gltf").out)

    def test_check_speaks_of_the_files_own_numbers(self):
        asset = Asset()
        asset.material(pbr())
        asset.quad(asset.material(pbr((0, 0, 0))))
        self.write(asset)
        found = json.loads(self.succeeds("check", "a.gltf", "--json").out)["assets"][0]["findings"][0]
        self.assertEqual((found["material"], found["material_index"]), ("material 1", 1))


if __name__ == "__main__":
    candela.main()
