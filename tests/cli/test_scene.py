#!/usr/bin/env python3
"""--scene: one of the scenes that a file holds, for every verb that reads one; and what files say of lamps and lenses."""

import base64
import json
import struct

import candela
from candela import TINY, CliTest, png_pixels

POSITIONS = base64.b64encode(struct.pack("<9f", -4, -4, 0, 4, -4, 0, 0, 8, 0)).decode()


def scenes_gltf(**more):
    """Three scenes of one triangle each: "day" shines red, the second, without a name, green, "night" blue."""
    colors = ([1, 0, 0], [0, 1, 0], [0, 0, 1])
    odd = {"pbrMetallicRoughness": {"metallicFactor": 0}, "extensions": {"KHR_materials_ior": {"ior": 4}}}  # check tells
    scene = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0], "name": "day"}, {"nodes": [1]}, {"nodes": [2], "name": "night"}],
        "nodes": [{"mesh": i} for i in range(3)],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": i}]} for i in range(3)],
        "materials": [{"emissiveFactor": color, **odd} for i, color in enumerate(colors)],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [-4, -4, 0], "max": [4, 8, 0]}
        ],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64," + POSITIONS}],
        **more,
    }
    return json.dumps(scene)


class SceneChoice(CliTest):
    def setUp(self):
        super().setUp()
        (self.folder / "a.gltf").write_text(scenes_gltf())

    def test_the_chosen_one_is_shown(self):
        for engine in ("path", "raster"):
            for choice, channel in ((), 0), (("0",), 0), (("1",), 1), (("2",), 2), (("night",), 2), (("day",), 0):
                options = ("--scene", *choice) if choice else ()
                self.succeeds(
                    "render", "a.gltf", *TINY, "-o", "a.png", "--env", "none", "--eye", "0,0,5", "--exposure", "0",
                    "--engine", engine, *options
                )
                width, height, channels, rows = png_pixels(self.folder / "a.png")
                pixel = rows[height // 2][width // 2 * channels :][:3]
                self.assertEqual(max(range(3), key=lambda c: pixel[c]), channel, (engine, choice, pixel))

    def test_info_and_check_tell_of_it_and_info_lists_all(self):
        for choice, index in ("day", 0), ("1", 1), ("night", 2):
            info = json.loads(self.succeeds("info", "a.gltf", "--json", "--scene", choice).out)
            self.assertEqual((info["scenes"], info["scene_index"]), (["day", "", "night"], index))
            self.assertEqual([material["index"] for material in info["materials"]], [index])
            found = json.loads(self.succeeds("check", "a.gltf", "--json", "--scene", choice).out)["assets"][0]
            self.assertEqual({f["material_index"] for f in found["findings"] if f["code"] == "ior-too-high"}, {index})
        self.assertRegex(self.succeeds("info", "a.gltf", "--scene", "2").out, r"scenes +3\n.*0 day\n.*1 \(no name\)\n.*2 night, ")

    def test_one_that_is_not_there_is_one_line_that_lists_what_is(self):
        says = "there is no scene 'noon'; the file has: 0 'day', 1, 2 'night'"
        self.fails("render", "a.gltf", *TINY, "-o", "a.png", "--scene", "noon", says=says)
        self.fails("render", "a.gltf", *TINY, "-o", "a.png", "--scene", "3", says="there is no scene '3'")
        self.fails("info", "a.gltf", "--scene", "noon", says=says)
        self.fails("bake", "--from-scene", "a.gltf", "--at", "0,0,1", "-o", "b", "--size", "16", "--levels", "2", "--scene", "noon", says=says)
        told = self.run_candela("check", "a.gltf", "--scene", "noon")
        self.assertEqual(told.code, 1)
        self.assertIn(says, told.out)
        self.fails("render", "demo:spheres", *TINY, "-o", "a.png", "--scene", "0", says="built-in scene")
        (self.folder / "b.gltf").write_text(scenes_gltf(scene=9))
        self.fails("info", "b.gltf", says="scene 9 does not exist")
        self.succeeds("info", "b.gltf", "--scene", "day")

    def test_bake_sees_it(self):
        self.succeeds(
            "bake", "none", "--from-scene", "a.gltf", "--at", "0,0,1", "-o", "b", "--size", "16", "--levels", "2", "--spp", "1",
            "--scene", "night"
        )
        red, green, blue = json.loads((self.folder / "b" / "sh.json").read_text())["coefficients"][0]
        self.assertEqual((red, green), (0, 0))
        self.assertGreater(blue, 0.1)

    def test_wrong_usage(self):
        (self.folder / "a.gltf").unlink()
        self.refuses("render", "demo:spheres", "--scene", "", says="--scene")
        self.refuses("bake", "studio", "-o", "b", "--scene", "1", says="--scene.*--from-scene")


class Lamps(CliTest):
    def lamp(self, light, **place):
        lights = {"EXT_lights_area": {"lights": [light]}}
        nodes = [{"mesh": 0}, {"name": "panel", "extensions": {"EXT_lights_area": {"light": 0}}, **place}]
        floor = {"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1], "metallicFactor": 0}}
        text = scenes_gltf(
            scenes=[{"nodes": [0, 1]}], nodes=nodes, materials=[floor] * 3, extensions=lights, extensionsUsed=["EXT_lights_area"]
        )
        (self.folder / "a.gltf").write_text(text)

    def test_info_says_what_an_area_light_gives_and_check_that_it_is_a_draft(self):
        self.lamp({"type": "rect", "rect": {"aspect": 2}, "size": 0.5, "intensity": 100, "name": "softbox"}, translation=[0, 0, 3])
        info = json.loads(self.succeeds("info", "a.gltf", "--json").out)
        self.assertEqual(len(info["materials"]), 1)
        self.assertEqual(info["bounds"]["upper"], [4, 8, 0])
        (light,) = info["lights"]
        self.assertEqual((light["name"], light["type"], light["index"]), ("softbox", "area", 1))
        self.assertAlmostEqual(light["lumens"], 100 * 0.5 * 3.14159265, places=3)
        self.assertRegex(self.succeeds("info", "a.gltf").out, "softbox, area light of node 1, .*157.1 lm")
        findings = json.loads(self.succeeds("check", "a.gltf", "--json").out)["assets"][0]["findings"]
        self.assertEqual([f["code"] for f in findings if f["subject"] == "EXT_lights_area"], ["extension-uncommon"])
        self.assertFalse([f for f in findings if f["material"] and "softbox" in f["material"]])

    def test_an_area_light_lights_what_is_before_it_in_both_engines(self):
        mean = {}
        for engine in ("path", "raster"):
            for turned in (False, True):
                place = {"rotation": [0, 1, 0, 0]} if turned else {}
                self.lamp({"type": "disk", "size": 2, "intensity": 2}, translation=[0, 0, 3], **place)
                self.succeeds(
                    "render", "a.gltf", "--size", "32x32", "--spp", "64", "-o", "a.png", "--env", "none", "--eye", "0,0,2",
                    "--exposure", "0", "--engine", engine
                )
                rows = png_pixels(self.folder / "a.png")[3]
                mean[engine, turned] = sum(sum(row) for row in rows) / sum(len(row) for row in rows)
        for engine in ("path", "raster"):
            self.assertEqual(mean[engine, True], 0, "it shines along its -z alone")
            self.assertGreater(mean[engine, False], 15)
        self.assertAlmostEqual(mean["path", False] / mean["raster", False], 1, delta=0.1)


if __name__ == "__main__":
    candela.main()
