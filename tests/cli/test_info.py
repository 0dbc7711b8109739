#!/usr/bin/env python3
"""`candela info`: what it says about scenes and images, for readers and for machines."""

import base64
import json
import math
import re
import struct
import time
import zlib

import candela
from candela import CliTest, TINY, triangle_glb, variants_gltf


def ktx2_cube(levels):
    """Faces of one grey each, 32-bit float RGBA, the smallest level first as the specification wants it."""
    pair = b"maker\0candela tests\0"
    pairs = struct.pack("<I", len(pair)) + pair + bytes(-len(pair) % 4)
    size = 1 << (len(levels) - 1)
    index, data, at = {}, b"", 80 + 24 * len(levels) + len(pairs)
    padding = -at % 16
    data += bytes(padding)
    for number in reversed(range(len(levels))):
        side = size >> number
        level = b"".join(struct.pack("<4f", grey, grey, grey, 1) * (side * side) for grey in levels[number])
        index[number] = struct.pack("<3Q", at + len(data), len(level), len(level))
        data += level
    head = b"\xabKTX 20\xbb\r\n\x1a\n" + struct.pack("<9I", 109, 4, size, size, 0, 0, 6, len(levels), 0)
    head += struct.pack("<4I2Q", 0, 0, 80 + 24 * len(levels), len(pairs), 0, 0)
    return head + b"".join(index[number] for number in range(len(levels))) + pairs + data


def meshopt_attributes(data, stride):
    """One block of up to 256 elements, version 0, every delta a whole byte."""
    count = len(data) // stride
    groups = (count + 15) // 16
    out = b"\xa0"
    for k in range(stride):
        column = list(data[k::stride])
        column += column[-1:] * (16 * groups - count)
        deltas = [(now - before) % 256 for before, now in zip([0] + column, column)]
        out += b"\xff" * ((groups + 3) // 4) + bytes((2 * d if d < 128 else 511 - 2 * d) for d in deltas)
    return out + bytes(max(stride, 32))


def meshopt_indices(indices):
    """Each below 32 from the last, which one byte says."""
    deltas = [now - before for before, now in zip([0] + indices, indices)]
    return b"\xd1" + bytes(2 * (2 * d if d >= 0 else -2 * d - 1) for d in deltas) + bytes(4)


def grid_gltf(is_packed):
    """A square of four times four squares; packed or plain."""
    side = 5
    positions = [c for y in range(side) for x in range(side) for c in (x, y, 0.25 * (x * y % 3))]
    corners = []
    for y in range(side - 1):
        for x in range(side - 1):
            i = y * side + x
            corners += [i, i + 1, i + side, i + side, i + 1, i + side + 1]
    numbers = struct.pack(f"<{3 * side * side}f", *positions)
    normals = struct.pack("<3f", 0, 0, 1) * (side * side)
    plain = [(numbers, 12, "ATTRIBUTES"), (normals, 12, "ATTRIBUTES"), (struct.pack(f"<{len(corners)}H", *corners), 2, "INDICES")]
    data, views = b"", []
    for raw, stride, mode in plain:
        count = len(raw) // stride
        stored = raw if not is_packed else meshopt_indices(corners) if mode == "INDICES" else meshopt_attributes(raw, stride)
        place = {"buffer": 0, "byteOffset": len(data), "byteLength": len(stored)}
        packing = {**place, "byteStride": stride, "count": count, "mode": mode}
        views.append({"buffer": 1, "byteLength": len(raw), "extensions": {"EXT_meshopt_compression": packing}} if is_packed else place)
        data += stored + bytes(-len(stored) % 4)
    bounds = {"min": [0, 0, 0], "max": [4, 4, 0.5]}
    accessors = [
        {"bufferView": 0, "componentType": 5126, "count": side * side, "type": "VEC3", **bounds},
        {"bufferView": 1, "componentType": 5126, "count": side * side, "type": "VEC3"},
        {"bufferView": 2, "componentType": 5123, "count": len(corners), "type": "SCALAR"},
    ]
    buffers = [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}]
    if is_packed:
        buffers.append({"byteLength": sum(len(raw) for raw, _, _ in plain), "extensions": {"EXT_meshopt_compression": {"fallback": True}}})
    return {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "translation": [1, 2, 3]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2}]}],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": buffers,
        **({"extensionsUsed": ["EXT_meshopt_compression"], "extensionsRequired": ["EXT_meshopt_compression"]} if is_packed else {}),
    }


class Info(CliTest):
    def json_of(self, name):
        return json.loads(self.succeeds("info", name, "--json").out)

    def test_built_in_scene(self):
        info = self.json_of("demo:spheres")
        self.assertEqual(info["kind"], "scene")
        self.assertGreater(info["triangles"], 0)
        self.assertGreaterEqual(info["instanced_triangles"], info["triangles"])
        self.assertLess(info["bounds"]["lower"][1], info["bounds"]["upper"][1])
        text = self.succeeds("info", "demo:spheres").out
        self.assertIn(str(info["triangles"]), text)

    def test_file_has_the_numbers_of_its_json(self):
        (self.folder / "a.glb").write_bytes(triangle_glb())
        info = self.json_of("a.glb")
        self.assertEqual((info["nodes"], info["meshes"], info["triangles"], info["vertices"]), (3, 1, 1, 3))
        self.assertEqual(info["bounds"], {"lower": [-1, 0, 0], "upper": [1, 2, 0]})
        self.assertEqual([camera["name"] for camera in info["cameras"]], ["near", ""])
        self.assertEqual(info["generator"], "candela tests")
        self.assertEqual(info["bytes"], len(triangle_glb()))

    def test_materials_say_their_lobes_and_variants_are_listed(self):
        (self.folder / "a.gltf").write_text(variants_gltf().replace('"material": 0', '"material": 1'))
        info = self.json_of("a.gltf")
        self.assertEqual(info["materials"], [{"index": 1, "name": "red", "lobes": ["metallic-roughness", "clearcoat"]}])
        self.assertEqual(info["variants"], ["noon", "sunset"])
        text = self.succeeds("info", "a.gltf").out
        self.assertRegex(text, r"(?m)^ +1 red: metallic-roughness, clearcoat$")
        self.assertRegex(text, r"(?m)^variants +2\n +0 noon\n +1 sunset$")

    def test_textures_have_sizes_and_memory(self):
        info = self.json_of(self.assets() / "models" / "BoxTextured" / "glTF-Binary" / "BoxTextured.glb")
        image = info["images"][0]
        self.assertEqual((image["width"], image["height"]), (256, 256))
        self.assertEqual(info["texture_bytes"], 256 * 256 * 4)

    def test_textures_have_formats_uses_and_mips(self):
        def png(depth, kind, extra=b""):
            def chunk(name, body):
                return struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))

            channels = {2: 3, 6: 4}[kind]
            rows = (b"\0" + bytes(4 * channels * depth // 8)) * 2
            head = chunk(b"IHDR", struct.pack(">IIBBBBB", 4, 2, depth, kind, 0, 0, 0))
            body = chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
            return b"\x89PNG\r\n\x1a\n" + head + extra + body

        transparent = struct.pack(">I", 6) + b"tRNS" + bytes(6)
        transparent += struct.pack(">I", zlib.crc32(transparent[4:]))
        for i, data in enumerate((png(8, 2), png(16, 6), png(8, 2, transparent))):
            (self.folder / f"{i}.png").write_bytes(data)
        scene = json.loads(variants_gltf())
        scene["images"] = [{"uri": f"{i}.png"} for i in range(3)]
        scene["textures"] = [{"source": i} for i in range(3)]
        material = scene["materials"][0]
        material["pbrMetallicRoughness"] = {"baseColorTexture": {"index": 0}, "metallicRoughnessTexture": {"index": 1}}
        material["occlusionTexture"] = {"index": 1}
        material["emissiveTexture"] = {"index": 2}
        material["normalTexture"] = {"index": 0}
        (self.folder / "a.gltf").write_text(json.dumps(scene))
        images = self.json_of("a.gltf")["images"]
        self.assertEqual([(i["bits"], i["alpha"]) for i in images], [(8, False), (16, True), (8, True)])
        self.assertEqual([i["format"] for i in images], ["PNG"] * 3)
        self.assertEqual(images[0]["file_bytes"], len(png(8, 2)))
        self.assertEqual(images[1]["slots"], ["metallicRoughnessTexture", "occlusionTexture"])
        self.assertEqual(images[1]["materials"], [0])
        # 4 x 2, 2 x 1, 1 x 1; the first is uploaded as sRGB and as data.
        self.assertEqual([i["gpu_bytes"] for i in images], [11 * 4 * 2, 11 * 8, 11 * 4])
        gpu = self.json_of("a.gltf")["gpu_bytes"]
        self.assertEqual((gpu["vertices"], gpu["indices"], gpu["textures"]), (3 * 72, 12, 88 + 88 + 44))
        text = self.succeeds("info", "a.gltf").out
        self.assertRegex(text, r"(?m)^ +1 1.png: PNG \(.*\), 4 x 2, 16 bits with alpha, 64 B, metallicRoughness \+ occlusion of 1 material$")

    def test_lamps_lenses_and_size_have_units(self):
        spot = {"type": "spot", "intensity": 100, "range": 5, "spot": {"outerConeAngle": 0.5}, "name": "desk"}
        (self.folder / "a.glb").write_bytes(triangle_glb(spot))
        info = self.json_of("a.glb")
        light = info["lights"][0]
        self.assertEqual((light["unit"], light["range_m"]), ("cd", 5))
        # The cone's fall-off leaves between a half and all of 2 pi (1 - cos).
        whole = 100 * 2 * math.pi * (1 - math.cos(0.5))
        self.assertTrue(0.3 * whole < light["lumens"] < whole)
        self.assertAlmostEqual(light["outer_cone_deg"], math.degrees(0.5), delta=1e-3)
        self.assertAlmostEqual(info["cameras"][0]["yfov_deg"], math.degrees(0.8), delta=1e-3)
        self.assertAlmostEqual(info["cameras"][0]["focal_length_mm"], 12 / math.tan(0.4), delta=1e-3)
        self.assertEqual((info["size"], info["size_hint"]), ([2, 2, 0], "a person"))
        self.assertRegex(self.succeeds("info", "a.glb").out, r"(?m)^size +2 x 2 x 0 m, as large as a person$")

    def test_a_cameras_own_lens_is_told(self):
        lens = {"fStop": 2.8, "focalLength": 0.05, "focusDistance": 3}
        physical = {"extensionsUsed": ["EXT_camera_physical"], "scenes": [{"nodes": [0, 1]}], "nodes": [{"camera": 0}, {"camera": 1}]}
        plain = {"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}
        cameras = [plain, {**plain, "extensions": {"EXT_camera_physical": lens}}]
        (self.folder / "a.gltf").write_text(json.dumps({"asset": {"version": "2.0"}, **physical, "cameras": cameras}))
        lenses = [camera["lens"] for camera in self.json_of("a.gltf")["cameras"]]
        self.assertIsNone(lenses[0])
        self.assertAlmostEqual(lenses[1]["f_number"], 2.8, delta=1e-6)
        self.assertAlmostEqual(lenses[1]["focal_length_mm"], 50, delta=1e-4)
        self.assertEqual(lenses[1]["focus_distance_m"], 3)
        self.assertRegex(self.succeeds("info", "a.gltf").out, r"f/2\.8, a lens of 50 mm, sharp at 3 m")

    def test_big_file_answers_at_once(self):
        big = self.assets() / "models" / "DamagedHelmet" / "glTF-Binary" / "DamagedHelmet.glb"
        if not big.exists():
            self.skipTest(f"{big.name} is absent")
        start = time.perf_counter()
        info = self.json_of(big)
        self.assertLess(time.perf_counter() - start, 1.0)  # 0.1 s is the aim; decoding its images takes longer than 1 s
        self.assertGreater(info["triangles"], 10000)

    def test_packed_geometry_is_told_of_as_if_it_were_not(self):
        told = []
        for is_packed in (False, True):
            (self.folder / "a.gltf").write_text(json.dumps(grid_gltf(is_packed)))
            info = self.json_of("a.gltf")
            told.append({key: value for key, value in info.items() if key not in ("bytes", "extensions")})
        self.assertEqual(*told)
        self.assertEqual((told[0]["vertices"], told[0]["triangles"]), (25, 32))
        self.assertEqual(told[0]["bounds"], {"lower": [1, 2, 3], "upper": [5, 6, 3.5]})

    def test_damage_in_packed_geometry_is_an_error_for_those_who_need_it(self):
        scene = grid_gltf(True)
        head, data = scene["buffers"][0]["uri"].split(",")
        broken = bytearray(base64.b64decode(data))
        broken[0] = 0
        scene["buffers"][0]["uri"] = head + "," + base64.b64encode(broken).decode()
        (self.folder / "a.gltf").write_text(json.dumps(scene))
        self.fails("render", "a.gltf", *TINY, "-o", "a.png", says="a.gltf.*damaged meshopt data")
        self.assertRegex(self.fails("check", "a.gltf", says="cannot be read").out, "a.gltf.*damaged meshopt data")
        self.assertEqual(self.json_of("a.gltf")["triangles"], 32)
        # Without bounds it has to look.
        del scene["accessors"][0]["min"]
        (self.folder / "a.gltf").write_text(json.dumps(scene))
        self.fails("info", "a.gltf", says="a.gltf.*damaged meshopt data")

    def test_extensions_and_animations(self):
        scene = {
            "asset": {"version": "2.0"},
            "extensionsUsed": ["KHR_materials_ior", "VENDOR_unheard_of"],
            "scenes": [{"nodes": [0]}],
            "nodes": [{"name": "lonely"}],
        }
        (self.folder / "a.gltf").write_text(json.dumps(scene))
        info = self.json_of("a.gltf")
        self.assertEqual(sorted(info["extensions"]["used"]), ["KHR_materials_ior", "VENDOR_unheard_of"])
        self.assertEqual(info["extensions"]["unsupported"], ["VENDOR_unheard_of"])
        status = {e["name"]: (e["required"], e["status"]) for e in info["extensions"]["all"]}
        self.assertEqual(
            status, {"KHR_materials_ior": (False, "supported"), "VENDOR_unheard_of": (False, "ignored")}
        )
        self.assertEqual(len(info["warnings"]), 2)
        self.assertIn("VENDOR_unheard_of", info["warnings"][0])
        self.assertIn("nothing in the scene has a mesh", info["warnings"][1])
        self.assertEqual(info["animations"], 0)
        self.assertIn("VENDOR_unheard_of", self.succeeds("info", "a.gltf").out)

    def file_that_requires(self, extension, **more):
        """A triangle in a file that cannot do without `extension`."""
        glb = triangle_glb()
        size = struct.unpack("<I", glb[12:16])[0]
        scene = json.loads(glb[20 : 20 + size])
        scene |= {"extensionsUsed": [extension], "extensionsRequired": [extension]} | more
        text = json.dumps(scene).encode()
        text += b" " * (-len(text) % 4)
        rest = struct.pack("<I4s", len(text), b"JSON") + text + glb[20 + size :]
        (self.folder / "a.glb").write_bytes(b"glTF" + struct.pack("<II", 2, 12 + len(rest)) + rest)
        self.fails("render", "a.glb", *TINY, "-o", "a.png", says=f"a.glb.*requires {extension}, which is not supported")
        info = self.json_of("a.glb")
        self.assertEqual(info["extensions"]["required"], [extension])
        self.assertEqual(info["extensions"]["required_unsupported"], [extension])
        self.assertEqual(info["generator"], "candela tests")
        self.assertIn(extension, info["warnings"][0])
        self.assertRegex(self.succeeds("info", "a.glb").out, rf"(?m)^unsupported +{extension}: required")
        return info

    def test_file_that_requires_what_we_lack(self):
        info = self.file_that_requires("VENDOR_unheard_of")
        self.assertEqual((info["nodes"], info["triangles"]), (3, 1))
        self.assertEqual(len(info["warnings"]), 1)

    def test_no_count_is_better_than_a_wrong_one(self):
        accessors = [{"componentType": 5126, "count": 3, "type": "VEC3", "bufferView": 77}]
        info = self.file_that_requires("VENDOR_geometry", accessors=accessors)
        self.assertNotIn("triangles", info)
        self.assertRegex(info["warnings"][-1], "the scene cannot be read")

    def test_an_image_in_an_unknown_format_does_not_hide_the_rest(self):
        info = self.file_that_requires(
            "VENDOR_image_format",
            materials=[{"emissiveTexture": {"index": 0}}],
            textures=[{"source": 0}],
            images=[{"bufferView": 0, "mimeType": "image/vendor"}],
            meshes=[{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        )
        self.assertEqual(info["triangles"], 1)
        self.assertIn("#/images/0", info["images"][0]["error"])
        self.assertRegex(info["warnings"][-1], "#/images/0: .*shown without it")

    def test_an_image_that_cannot_be_read_says_why(self):
        head = b"IHDR" + struct.pack(">IIBBBBB", 1 << 20, 1 << 20, 8, 6, 0, 0, 0)
        wide = b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + head + struct.pack(">I", zlib.crc32(head))
        wide += struct.pack(">I4sI", 0, b"IDAT", zlib.crc32(b"IDAT"))
        for name, content, says in (
            ("absent.png", None, r"0 absent\.png: cannot be read: a\.gltf#/images/0/uri: 'absent\.png': no such file"),
            ("words.png", b"no picture", r"0 words\.png: .*cannot be read: .*words\.png"),
            ("cut.png", wide[:20], r"0 cut\.png: PNG \(20 B\), cannot be read: .*cut\.png"),
            ("wide.png", wide, r"0 wide\.png: PNG \(\d+ B\), cannot be read: .*wide\.png.*large"),
        ):
            with self.subTest(name=name):
                if content is not None:
                    (self.folder / name).write_bytes(content)
                scene = {
                    "asset": {"version": "2.0"},
                    "scenes": [{"nodes": [0]}],
                    "nodes": [{"mesh": 0}],
                    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
                    "materials": [{"emissiveTexture": {"index": 0}}],
                    "textures": [{"source": 0}],
                    "images": [{"uri": name}],
                    "accessors": [{"count": 3, "componentType": 5126, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]}],
                }
                (self.folder / "a.gltf").write_text(json.dumps(scene))
                told = self.succeeds("info", "a.gltf").out
                self.assertRegex(told, says)
                self.assertNotIn("(0 B)", told)

    def test_damage_is_an_error_whatever_the_file_requires(self):
        scene = {"asset": {"version": "2.0"}, "extensionsUsed": [], "scenes": [{"nodes": [7]}]}
        (self.folder / "a.gltf").write_text(json.dumps(scene))
        self.fails("info", "a.gltf", says="a.gltf")

    def test_image_luminance_is_exact(self):
        # A flat RGBE picture, 2 x 1: mantissa 128 with exponent 129 is 1.0, with exponent 130 it is 2.0.
        (self.folder / "a.hdr").write_bytes(
            b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n" + bytes([128, 128, 128, 129, 128, 128, 128, 130])
        )
        info = self.json_of("a.hdr")
        self.assertEqual((info["width"], info["height"], info["format"]), (2, 1, "Radiance HDR"))
        self.assertAlmostEqual(info["luminance"]["min"], 1.0, delta=0.01)
        self.assertAlmostEqual(info["luminance"]["max"], 2.0, delta=0.02)
        self.assertAlmostEqual(info["luminance"]["mean"], 1.5, delta=0.015)

    def test_rendered_pictures(self):
        self.succeeds("render", "demo:spheres", *TINY, "-o", "a.png", "-o", "a.jpg", "-o", "a.hdr", "-o", "a.exr")
        for name, kind in {"a.png": "PNG", "a.jpg": "JPEG", "a.hdr": "Radiance HDR", "a.exr": "OpenEXR"}.items():
            info = self.json_of(name)
            self.assertEqual((info["kind"], info["format"], info["width"], info["height"]), ("image", kind, 16, 12))
        self.assertRegex(self.succeeds("info", "a.exr").out, r"(?m)^size +16 x 12$")

    def test_texture_levels_are_measured_by_solid_angle(self):
        (self.folder / "a.ktx2").write_bytes(ktx2_cube([[1, 1, 1, 1, 1, 4], [2] * 6]))
        info = self.json_of("a.ktx2")
        self.assertEqual((info["kind"], info["container"], info["format"]), ("texture", "KTX 2", "rgba32f"))
        self.assertEqual((info["width"], info["height"], info["faces"]), (2, 2, 6))
        self.assertEqual(info["supercompression"], "none")
        self.assertEqual(info["key_values"], {"maker": "candela tests"})
        self.assertEqual([level["bytes"] for level in info["levels"]], [384, 96])
        first, second = (level["luminance"] for level in info["levels"])
        self.assertEqual((first["min"], first["max"]), (1.0, 4.0))
        self.assertAlmostEqual(first["mean"], 1.5, delta=1e-12)
        self.assertAlmostEqual(second["mean"], 2.0, delta=1e-12)
        text = self.succeeds("info", "a.ktx2").out
        self.assertRegex(text, r"(?m)^type +cube map$")
        self.assertRegex(text, r"(?m)^ +1 1 x 1, 96 B, luminance min 2, max 2, mean 2$")

    def test_texture_with_unknown_pixels_is_described(self):
        whole = ktx2_cube([[1] * 6])
        (self.folder / "a.ktx2").write_bytes(whole[:12] + struct.pack("<I", 143) + whole[16:])
        info = self.json_of("a.ktx2")
        self.assertEqual((info["format"], info["levels"][0]["luminance"]), ("bc6h-ufloat", None))
        self.assertRegex(self.succeeds("info", "a.ktx2").out, r"(?m)^pixels +not read$")

    def test_damaged_textures(self):
        whole = ktx2_cube([[1] * 6])
        for count in list(range(12, len(whole), 17)) + [len(whole) - 1]:
            (self.folder / "cut.ktx2").write_bytes(whole[:count])
            self.fails("info", "cut.ktx2", says="cut.ktx2.*truncated")

    def test_crosses_are_recognised_by_shape_and_empty_corner(self):
        def hdr(width, height, corner):
            pixels = bytearray(bytes([128, 128, 128, 129]) * (width * height))
            pixels[0:4] = bytes([corner, corner, corner, 129])
            head = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n"
            (self.folder / "a.hdr").write_bytes(head.encode() + pixels)
            return self.json_of("a.hdr")["cube_layout"]

        self.assertEqual(hdr(4, 3, 0), "cross-4x3")
        self.assertIsNone(hdr(4, 3, 128))
        self.assertEqual(hdr(6, 1, 128), "strip-6x1")
        self.assertIsNone(hdr(4, 2, 0))

    def test_bad_files(self):
        self.fails("info", "absent.glb", says="absent.glb: no such file")
        (self.folder / "folder").mkdir()
        self.fails("info", "folder", says="folder")
        (self.folder / "text.txt").write_text("hello")
        self.fails("info", "text.txt", says="text.txt")

    def test_damaged_exr_headers(self):
        self.succeeds("render", "demo:spheres", *TINY, "-o", "a.exr")
        whole = (self.folder / "a.exr").read_bytes()
        for count in list(range(4, 400, 7)) + [len(whole) - 1]:
            (self.folder / "cut.exr").write_bytes(whole[:count])
            self.fails("info", "cut.exr", says="cut.exr")
        # A length of four gigabytes in the first attribute.
        at = re.search(rb"chlist\0", whole).end()
        (self.folder / "long.exr").write_bytes(whole[:at] + struct.pack("<I", 0xFFFFFFFF) + whole[at + 4 :])
        self.fails("info", "long.exr", says="long.exr")


if __name__ == "__main__":
    candela.main()
