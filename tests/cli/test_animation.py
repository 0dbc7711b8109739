#!/usr/bin/env python3
"""What KHR_animation_pointer moves, by both engines: moments, sequences, motion blur, and files that are wrong."""

import base64
import copy
import json
import os
import pathlib
import shutil
import struct
import tempfile

import candela
from candela import CliTest, png_pixels

COLOR = "/materials/0/pbrMetallicRoughness/baseColorFactor"
YFOV = "/cameras/0/perspective/yfov"
INTENSITY = "/extensions/KHR_lights_punctual/lights/0/intensity"
VISIBLE = "/nodes/0/extensions/KHR_node_visibility/visible"
ENGINES = {"path": ("--spp", "16"), "raster": ("--engine", "raster")}


def asset(extension=None):
    """A square that fills a quarter of the picture, before a camera and a lamp; nothing moves."""
    positions = struct.pack("<12f", -1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0) + struct.pack("<6H", 0, 1, 2, 0, 2, 3)
    return {
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_animation_pointer"],
        "scenes": [{"nodes": [0, 1, 2]}],
        "nodes": [{"mesh": 0, "extensions": {"KHR_node_visibility": {"visible": True}}},
                  {"camera": 0, "translation": [0, 0, 4]},
                  {"translation": [0, 0, 3], "extensions": {"KHR_lights_punctual": {"light": 0}}}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.9273, "znear": 0.1}}],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 9}]}},
        "materials": [{"extensions": {extension: {}} if extension else {},
                       "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 1], "metallicFactor": 0}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0]},
                      {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
        "buffers": [{"byteLength": len(positions), "uri": "data:;base64," + base64.b64encode(positions).decode()}],
    }  # fmt: skip


def animate(scene, pointer, *values, times=(0.0, 1.0), interpolation="LINEAR"):
    """Moves what is at `pointer` through `values`, of which bools are bytes."""
    animation = scene.setdefault("animations", [{"name": "all", "channels": [], "samplers": []}])[0]

    def accessor(data, component, type_, count, **more):
        scene["buffers"].append({"byteLength": len(data), "uri": "data:;base64," + base64.b64encode(data).decode()})
        scene["bufferViews"].append({"buffer": len(scene["buffers"]) - 1, "byteLength": len(data)})
        scene["accessors"].append({"bufferView": len(scene["bufferViews"]) - 1, "componentType": component, "count": count,
                                   "type": type_, **more})  # fmt: skip
        return len(scene["accessors"]) - 1

    moments = accessor(struct.pack(f"<{len(times)}f", *times), 5126, "SCALAR", len(times), min=[times[0]], max=[times[-1]])
    if isinstance(values[0], bool):
        output = accessor(bytes(values), 5121, "SCALAR", len(values))
    else:
        rows = [value if isinstance(value, (list, tuple)) else [value] for value in values]
        numbers = [number for row in rows for number in row]
        type_ = "SCALAR" if len(rows[0]) == 1 else f"VEC{len(rows[0])}"
        output = accessor(struct.pack(f"<{len(numbers)}f", *numbers), 5126, type_, len(rows))
    animation["samplers"].append({"input": moments, "output": output, "interpolation": interpolation})
    animation["channels"].append({"sampler": len(animation["samplers"]) - 1,
                                  "target": {"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": pointer}}}})  # fmt: skip
    return scene


def written_in(scene, values):
    """The same file without animations, with `values` by pointer."""
    still = copy.deepcopy(scene)
    still.pop("animations", None)
    for pointer, value in values.items():
        *way, last = pointer[1:].split("/")
        place = still
        for step in way:
            place = place[int(step) if isinstance(place, list) else step]
        place[last] = value
    return still


class AnimationTest(CliTest):
    def setUp(self):
        super().setUp()
        elsewhere = pathlib.Path(tempfile.mkdtemp(prefix="candela-cli-"))
        self.addCleanup(shutil.rmtree, elsewhere)
        self.environment = {**os.environ, "LIBGL_ALWAYS_SOFTWARE": "1", "XDG_CACHE_HOME": str(elsewhere)}
        self.write(asset(), "probe.gltf")
        probe = self.run_candela("render", "probe.gltf", "-o", "probe.png", "--engine", "raster", "--size", "8x8",
                                 "--env", "none", env=self.environment)  # fmt: skip
        self.engines = {name: options for name, options in ENGINES.items() if name == "path" or probe.code == 0}

    def write(self, scene, name="a.gltf"):
        (self.folder / name).write_text(json.dumps(scene))
        return name

    def picture(self, name, *options, output="a.png"):
        """The rows of a 24x24 picture, RGB."""
        self.succeeds("render", name, "-o", output, "--size", "24x24", "--env", "none", "--exposure", "0", "--tonemap", "linear",
                      *options, env=self.environment)  # fmt: skip
        return png_pixels(self.folder / output.replace("%d", "0"))[3]

    def middle(self, rows):
        return tuple(rows[12][36:39])


class Moments(AnimationTest):
    def test_a_moment_is_the_file_with_its_values_written_in(self):
        scene = asset()
        animate(scene, COLOR, [1, 0, 0, 1], [0, 1, 0.5, 1])
        animate(scene, YFOV, 0.9273, 0.5)
        animate(scene, INTENSITY, 1, 9)
        self.write(scene)
        self.write(written_in(scene, {COLOR: [0.5, 0.5, 0.25, 1], YFOV: (0.9273 + 0.5) / 2, INTENSITY: 5}), "still.gltf")
        seen = {}
        for engine, options in self.engines.items():
            moving = self.picture("a.gltf", *options, "--frame-time", "0.5s")
            self.assertEqual(moving, self.picture("still.gltf", *options), engine)
            self.assertNotEqual(moving, self.picture("a.gltf", *options), engine + ": at rest")
            seen[engine] = self.middle(moving)
        for engine, pixel in seen.items():
            for found, expected in zip(pixel, seen["path"]):
                self.assertAlmostEqual(found, expected, delta=3, msg=engine)

    def test_a_sequence_shows_them_all(self):
        scene = animate(asset("KHR_materials_unlit"), COLOR, [0, 0, 0, 1], [1, 1, 1, 1])
        self.write(scene)
        (self.folder / "s").mkdir()
        for engine, options in self.engines.items():
            self.picture("a.gltf", *options, "--sequence", "4", output=f"s/{engine}%d.png")
            values = [self.middle(png_pixels(self.folder / "s" / f"{engine}{i}.png")[3])[0] for i in range(4)]
            for found, expected in zip(values, (0, 137, 188, 225)):  # sRGB of 0, 1/4, 1/2, 3/4
                self.assertAlmostEqual(found, expected, delta=1, msg=engine)

    def test_blur_is_the_mean_over_the_shutter(self):
        scene = animate(asset("KHR_materials_unlit"), COLOR, [0, 0, 0, 1], [1, 1, 1, 1])
        self.write(scene)
        for engine in self.engines:
            rows = self.picture("a.gltf", "--engine", engine, "--shutter", "1s", "--spp", "32")
            self.assertAlmostEqual(self.middle(rows)[0], 188, delta=1, msg=engine)

    def test_a_variant_that_moves_is_worn(self):
        scene = asset("KHR_materials_unlit")
        scene["materials"].append({"extensions": {"KHR_materials_unlit": {}}, "pbrMetallicRoughness": {}})
        scene["extensions"]["KHR_materials_variants"] = {"variants": [{"name": "red"}]}
        scene["meshes"][0]["primitives"][0]["extensions"] = {
            "KHR_materials_variants": {"mappings": [{"material": 1, "variants": [0]}]}}  # fmt: skip
        animate(scene, COLOR.replace("/0/", "/1/", 1), [1, 1, 1, 1], [1, 0, 0, 1])
        self.write(scene)
        for engine, options in self.engines.items():
            self.assertEqual(self.middle(self.picture("a.gltf", *options, "--frame-time", "1s")), (255,) * 3, engine)
            worn = self.picture("a.gltf", *options, "--frame-time", "1s", "--variant", "red")
            self.assertEqual(self.middle(worn), (255, 0, 0), engine)

    def test_nodes_are_hidden_and_shown(self):
        scene = animate(asset("KHR_materials_unlit"), VISIBLE, True, False, True, times=(0, 1, 2), interpolation="STEP")
        self.write(scene)
        if "KHR_node_visibility" in self.succeeds("render", "a.gltf", "-o", "a.png", "--size", "8x8", "--spp", "1",
                                                  "--frame-time", "0s").err:  # fmt: skip
            self.skipTest("visibility is not read")
        for engine, options in self.engines.items():
            for time, expected in (("0.5s", 255), ("1.5s", 0), ("2.5s", 255)):
                rows = self.picture("a.gltf", *options, "--frame-time", time)
                self.assertEqual(self.middle(rows)[0], expected, f"{engine} at {time}")

    def test_info_lists_what_moves(self):
        self.write(animate(asset(), COLOR, [0, 0, 0, 1], [1, 1, 1, 1], times=(0, 2.5)))
        self.assertRegex(self.succeeds("info", "a.gltf").out, f"2.5 s, 1 channel(.|\n)*{COLOR}")
        animation = json.loads(self.succeeds("info", "a.gltf", "--json").out)["animation_list"][0]
        self.assertEqual((animation["duration_s"], animation["pointers"]), (2.5, [COLOR]))


class Mistakes(AnimationTest):
    def fails_at(self, scene, says, *options):
        self.write(scene)
        self.fails("render", "a.gltf", "-o", "b.png", "--size", "8x8", "--spp", "1", *options, says=says)
        self.assertFalse((self.folder / "b.png").exists())

    def test_pointers_into_nothing_are_one_line(self):
        for pointer in ("/materials/7/alphaCutoff", "/materials/0/extensions/KHR_materials_sheen/sheenRoughnessFactor",
                        "/cameras/0/perspective/zfar", "/nothing/here", "/nodes/0/weights/3", "materials"):  # fmt: skip
            scene = animate(asset(), pointer, 0, 1)
            self.fails_at(scene, pointer, "--frame-time", "0.5s")
            self.fails_at(scene, pointer)

    def test_values_of_another_kind_are_one_line(self):
        self.fails_at(animate(asset(), COLOR, [0, 0, 0], [1, 1, 1]), "VEC3", "--frame-time", "0.5s")
        self.fails_at(animate(asset(), COLOR, [0] * 4, [1] * 4, [1] * 4, [1] * 4), "for each key", "--frame-time", "0.5s")

    def test_two_channels_for_one_property_are_a_warning(self):
        scene = animate(asset(), COLOR, [0, 0, 0, 1], [1, 1, 1, 1])
        animate(scene, COLOR, [1, 0, 0, 1], [1, 0, 0, 1])
        self.write(scene)
        arguments = ("render", "a.gltf", "-o", "b.png", "--size", "8x8", "--spp", "1")
        self.assertIn("two channels move " + COLOR, self.succeeds(*arguments).err)
        self.fails(*arguments, "--strict", says="two channels")


if __name__ == "__main__":
    candela.main()
