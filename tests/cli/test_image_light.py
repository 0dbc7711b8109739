#!/usr/bin/env python3
"""EXT_lights_image_based: a scene's own light from everywhere, and `candela bake --format gltf`, which writes one."""

import base64
import json
import math
import struct
import unittest

from candela import TINY, CliTest, png_pixels

SMALL = ("--size", "64", "--levels", "3", "--irradiance-size", "4", "--proof", "0", "--format", "gltf", "-q")


def ball(slices=32, stacks=16):
    """A white matt ball of radius 1 about the origin, as parts of a glTF."""
    normals, triangles = [], []
    for i in range(stacks + 1):
        polar = math.pi * i / stacks
        for k in range(slices + 1):
            around = 2 * math.pi * k / slices
            normals += [math.sin(polar) * math.cos(around), math.cos(polar), math.sin(polar) * math.sin(around)]
    for i in range(stacks):
        for k in range(slices):
            a, b = i * (slices + 1) + k, (i + 1) * (slices + 1) + k
            triangles += [a, a + 1, b, a + 1, b + 1, b]
    points, faces = struct.pack(f"<{len(normals)}f", *normals), struct.pack(f"<{len(triangles)}H", *triangles)
    uri = "data:application/octet-stream;base64," + base64.b64encode(points + faces).decode()
    return {
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 0}, "indices": 1, "material": 0}]}],
        "materials": [
            {
                "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 1},
                "extensions": {"KHR_materials_specular": {"specularFactor": 0}},
            }
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(normals) // 3, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": len(triangles), "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": len(points)},
            {"buffer": 0, "byteOffset": len(points), "byteLength": len(faces)},
        ],
        "buffers": [{"byteLength": len(points + faces), "uri": uri}],
    }


class ImageLight(CliTest):
    def lit_ball(self, environment, **light):
        """`b/ball.gltf` lit by a bake of `environment`."""
        self.succeeds("bake", environment, "-o", "b", *SMALL)
        scene = json.loads((self.folder / "b" / "environment.gltf").read_text())
        scene["extensionsUsed"].append("KHR_materials_specular")
        scene.update(ball())
        scene["scenes"][0]["nodes"] = [0]
        scene["extensions"]["EXT_lights_image_based"]["lights"][0].update(light)
        (self.folder / "b" / "ball.gltf").write_text(json.dumps(scene))
        return scene

    def quadrants(self, *options):
        """Means of the ball's codes, by quadrant of the picture and channel."""
        self.succeeds(
            "render", "b/ball.gltf", "-o", "a.png", "--size", "32x32", "--background", "transparent", "--exposure", "-1",
            "--tonemap", "linear", *options
        )
        width, height, channels, rows = png_pixels(self.folder / "a.png")
        sums = {}
        for y in range(height):
            for x in range(width):
                pixel = rows[y][x * channels : (x + 1) * channels]
                if channels == 4 and pixel[3] == 255:
                    for c in range(3):
                        sums.setdefault((x * 2 // width, y * 2 // height, c), []).append(pixel[c])
        self.assertEqual(len(sums), 12)
        return {key: sum(codes) / len(codes) for key, codes in sums.items()}

    def assert_like(self, found, expected, by):
        for key, code in expected.items():
            self.assertAlmostEqual(found[key], code, delta=by, msg=str(key))

    def test_what_bake_writes_lights_a_ball_as_the_environment_does_in_both_engines(self):
        self.lit_ball("studio")
        for engine in (("--engine", "path", "--spp", "256"), ("--engine", "raster")):
            own = self.quadrants(*engine)
            self.assert_like(own, self.quadrants(*engine, "--env", "studio"), 2)
            self.assertGreater(max(own.values()), 1.3 * min(own.values()), "the light has a side")

    def test_rotation_and_intensity_are_those_of_the_options(self):
        half = math.sqrt(0.5)
        self.lit_ball("studio", rotation=[0, half, 0, half], intensity=0.5)
        for engine in ("path", "raster"):
            own = self.quadrants("--engine", engine, "--spp", "256")
            turned = self.quadrants(
                "--engine", engine, "--spp", "256", "--env", "studio", "--env-rotation", "90", "--env-intensity", "0.5"
            )
            self.assert_like(own, turned, 2)
            self.assert_like(self.quadrants("--engine", engine, "--spp", "64", "--env", "none"), dict.fromkeys(own, 0), 0)

    def test_info_and_check_know_it(self):
        self.lit_ball("sky")
        info = json.loads(self.succeeds("info", "b/ball.gltf", "--json").out)
        self.assertEqual(info["image_light"], {"index": 0, "name": "sky", "size": 64, "levels": 3, "intensity": 1})
        self.assertRegex(self.succeeds("info", "b/ball.gltf").out, "environment +sky, image-based light 0, a cube of 64 x 64, 3 levels")
        findings = json.loads(self.run_candela("check", "b/ball.gltf", "--json").out)["assets"][0]["findings"]
        self.assertEqual([f["code"] for f in findings if f["subject"] == "EXT_lights_image_based"], ["extension-uncommon"])

    def test_coefficients_that_contradict_the_pictures_are_told(self):
        def contradictions(change, **light):
            scene = self.lit_ball("studio", **light)
            own = scene["extensions"]["EXT_lights_image_based"]["lights"][0]
            own["irradianceCoefficients"] = change(own["irradianceCoefficients"])
            (self.folder / "b" / "ball.gltf").write_text(json.dumps(scene))
            findings = json.loads(self.run_candela("check", "b/ball.gltf", "--json").out)["assets"][0]["findings"]
            return [f for f in findings if f["code"] == "irradiance-contradicts"]

        half = math.sqrt(0.5)
        tilted = [0.5, 0.5, 0.5, 0.5]
        for rotation in ([0, 0, 0, 1], [0, half, 0, half], tilted):
            self.assertEqual(contradictions(lambda c: c, rotation=rotation, intensity=3), [], rotation)
        (by_pi,) = contradictions(lambda c: [[x / math.pi for x in rgb] for rgb in c])
        self.assertAlmostEqual(by_pi["measured"]["scale"], math.pi, delta=0.05)
        self.assertEqual((by_pi["severity"], by_pi["subject"]), ("warning", "image-based light 0"))
        self.assertIn("multiply them by 3.1", by_pi["fix"])
        (turned,) = contradictions(lambda c: [c[0], c[3], c[1], c[2], *c[4:]])
        self.assertIsNone(turned["fix"])

    def test_a_light_that_moves_follows_the_moment_and_a_sequence_says_that_it_stands(self):
        scene = self.lit_ball("furnace")
        numbers = base64.b64encode(struct.pack("<4f", 0, 1, 1, 0)).decode()
        scene["buffers"].append({"byteLength": 16, "uri": "data:application/octet-stream;base64," + numbers})
        scene["bufferViews"] += [{"buffer": 1, "byteLength": 8}, {"buffer": 1, "byteOffset": 8, "byteLength": 8}]
        scene["accessors"] += [{"bufferView": view, "componentType": 5126, "count": 2, "type": "SCALAR"} for view in (2, 3)]
        pointer = {"pointer": "/extensions/EXT_lights_image_based/lights/0/intensity"}
        target = {"path": "pointer", "extensions": {"KHR_animation_pointer": pointer}}
        scene["animations"] = [{"samplers": [{"input": 2, "output": 3}], "channels": [{"sampler": 0, "target": target}]}]
        scene["extensions"]["EXT_lights_image_based"]["lights"][0]["intensity"] = 1
        scene["extensionsUsed"].append("KHR_animation_pointer")
        (self.folder / "b" / "ball.gltf").write_text(json.dumps(scene))
        for engine in ("path", "raster"):
            self.assert_like(self.quadrants("--engine", engine, "--spp", "4", "--frame-time", "1s"), dict.fromkeys(self.quadrants(), 0), 0)
            told = self.succeeds("render", "b/ball.gltf", *TINY, "-o", "s%d.png", "--sequence", "2", "--engine", engine).err
            self.assertIn("the image-based light moves, and stands as at the first moment", told)

    def test_bad_ones_are_one_line(self):
        def fails(says, change):
            scene = self.lit_ball("furnace")
            change(scene, scene["extensions"]["EXT_lights_image_based"]["lights"][0])
            (self.folder / "b" / "ball.gltf").write_text(json.dumps(scene))
            self.fails("render", "b/ball.gltf", *TINY, "-o", "a.png", says=says)

        fails("6 faces, this one 5", lambda scene, light: light["specularImages"][0].pop())
        fails("64 x 64, but specularImageSize is 32", lambda scene, light: light.update(specularImageSize=32))
        fails("absent.png", lambda scene, light: scene["images"][3].update(uri="absent.png"))
        fails("image-based light 7", lambda scene, light: scene["scenes"][0]["extensions"]["EXT_lights_image_based"].update(light=7))

    def test_bake_writes_the_convention(self):
        self.succeeds("bake", "furnace", "-o", "b", *SMALL)
        document = json.loads((self.folder / "b" / "environment.gltf").read_text())
        (light,) = document["extensions"]["EXT_lights_image_based"]["lights"]
        self.assertEqual(document["scenes"][0]["extensions"]["EXT_lights_image_based"]["light"], 0)
        self.assertEqual([len(level) for level in light["specularImages"]], [6, 6, 6])
        for level, faces in enumerate(light["specularImages"]):
            width, height, channels, rows = png_pixels(self.folder / "b" / document["images"][faces[0]]["uri"])
            self.assertEqual((width, height), (64 >> level, 64 >> level))
            self.assertGreaterEqual(rows[0][0], 254)
        # Irradiance pi of radiance 1, over the constant harmonic.
        self.assertAlmostEqual(light["irradianceCoefficients"][0][1], math.pi * math.sqrt(4 * math.pi), places=3)
        self.assertAlmostEqual(light["irradianceCoefficients"][3][0], 0, places=3)

    def test_wrong_usage(self):
        refuse = lambda *options, says: self.refuses("bake", "furnace", "-o", "b", "--format", "gltf", *options, says=says)
        refuse("--mapping", "balanced", says="--mapping")
        refuse("--size", "96", "--levels", "3", says="--size.*power of two")
        refuse("--sh-order", "1", says="--sh-order")
        refuse("--sheen", says="--sheen")


if __name__ == "__main__":
    unittest.main()
