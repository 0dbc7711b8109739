#!/usr/bin/env python3
"""`--texture-memory`: images that are made to fit, said once."""

import base64
import json
import struct
import zlib

import candela
from candela import TINY, CliTest, png_pixels
from test_raster import RasterTest

SIDE = 64
FULL = 4 * SIDE * SIDE  # bytes
SEEN = ("--exposure", "0", "--tonemap", "linear", "--background", "#000000")


def chess():
    """A PNG of single texels, black and white."""
    rows = b"".join(b"\0" + bytes(255 * ((x + y) % 2) for x in range(SIDE)) for y in range(SIDE))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", SIDE, SIDE, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def textured_gltf():
    """A triangle that fills the picture and shows the chessboard, as it is, once across its legs."""

    def uri(data):
        return "data:application/octet-stream;base64," + base64.b64encode(data).decode()

    corners = struct.pack("<9f", -4, -4, 0, 4, -4, 0, 0, 8, 0) + struct.pack("<6f", 0, 1, 1, 1, 0, 0)
    material = {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}, "extensions": {"KHR_materials_unlit": {}}}
    return json.dumps({
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_materials_unlit"],
        "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0}, {"camera": 0, "translation": [0, 0, 3]}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.6, "znear": 0.1}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0}]}],
        "materials": [material],
        "textures": [{"source": 0}],
        "images": [{"uri": uri(chess())}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"bufferView": 0, "byteOffset": 36, "componentType": 5126, "count": 3, "type": "VEC2"},
        ],
        "bufferViews": [{"buffer": 0, "byteLength": 60}],
        "buffers": [{"byteLength": 60, "uri": uri(corners)}],
    })  # fmt: skip


class Traced(CliTest):
    def setUp(self):
        super().setUp()
        (self.folder / "a.gltf").write_text(textured_gltf())

    def render(self, name, *arguments):
        return self.succeeds("render", "a.gltf", *TINY, *SEEN, "-o", name, *arguments)

    def test_an_ample_budget_changes_no_bit(self):
        self.render("all.exr")
        for size in (f"{FULL}", "17K", "1GB", "1.5GiB"):
            self.assertNotIn("texture memory", self.render("ample.exr", "--texture-memory", size).err)
            self.assertEqual((self.folder / "ample.exr").read_bytes(), (self.folder / "all.exr").read_bytes())

    def test_what_is_dropped_is_said_once_and_its_light_stays(self):
        result = self.render("small.png", "--texture-memory", str(FULL - 1))
        self.assertEqual(result.err.count("texture memory"), 1, result.err)
        self.assertIn("64 x 64 texels become 32 x 32", result.err)
        # Half of the light has the code 188, half of the code would be 128.
        _, _, _, rows = png_pixels(self.folder / "small.png")
        for code in b"".join(rows):
            self.assertLessEqual(abs(code - 188), 1)

    def test_strict_takes_it_for_an_error(self):
        self.fails("render", "a.gltf", *TINY, "-o", "a.png", "--strict", "--texture-memory", "4K", says="texture memory")

    def test_too_little_for_a_texel_is_an_error(self):
        self.fails("render", "a.gltf", *TINY, "-o", "a.png", "--texture-memory", "3B", says="no room in")


class Usage(CliTest):
    def test_what_is_no_size_is_refused(self):
        for size in ("0", "-1", "-2GB", "", "much", "2XB", "2 GB", "1e30", "nan", "inf", "0.1"):
            self.refuses("render", "demo:spheres", "-o", "a.png", f"--texture-memory={size}", says="--texture-memory")

    def test_a_built_in_scene_is_made_to_fit_too(self):
        result = self.succeeds("render", "demo:materials", *TINY, "-o", "a.png", "--texture-memory", "1GB")
        self.assertNotIn("texture memory", result.err)


class Drawn(RasterTest):
    def test_smaller_levels_count_too(self):
        (self.folder / "a.gltf").write_text(textured_gltf())
        view = ("render", "a.gltf", "--engine", "raster", "--size", "32x24", *SEEN)
        self.draws(*view, "-o", "all.png")
        ample = self.draws(*view, "-o", "ample.png", "--texture-memory", str(FULL * 4 // 3))
        self.assertNotIn("texture memory", ample.err)
        self.assertEqual((self.folder / "ample.png").read_bytes(), (self.folder / "all.png").read_bytes())
        small = self.draws(*view, "-o", "small.png", "--texture-memory", str(FULL))
        self.assertIn("64 x 64 texels become 32 x 32", small.err)


if __name__ == "__main__":
    candela.main()
