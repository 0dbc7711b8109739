#!/usr/bin/env python3
"""`candela check`: each defect is planted in an asset that is clean without it, and found alone."""

import base64
import json
import math
import re
import struct
import time
import zlib

import candela
from candela import CliTest

GREY = {"pbrMetallicRoughness": {"baseColorFactor": [0.4, 0.4, 0.4, 1], "metallicFactor": 0, "roughnessFactor": 0.6}}


def png(width, height, texel):
    """An 8-bit RGB or RGBA PNG; texel(x, y) gives its codes."""
    rows = b"".join(b"\0" + b"".join(bytes(texel(x, y)) for x in range(width)) for y in range(height))
    kind = 2 if len(texel(0, 0)) == 3 else 6

    def chunk(name, body):
        return struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))

    head = struct.pack(">IIBBBBB", width, height, 8, kind, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def data_uri(data, kind="application/octet-stream"):
    return f"data:{kind};base64," + base64.b64encode(data).decode()


def bumps(x, y, size=64):
    """Slopes to the right and up, at texel (x, y), of waves that repeat."""
    u, v = 2 * math.pi * x / size, -2 * math.pi * y / size
    phase = 3 * u + 2 * v
    other = 2 * u - 4 * v
    return 0.3 * 3 * math.cos(phase) / 3 - 0.2 * 2 * math.sin(other) / 3, 0.3 * 2 * math.cos(phase) / 3 + 0.2 * 4 * math.sin(other) / 3


def normal_texel(x, y, flip=1, scale=1.0, encode=lambda c: c, height=1.0):
    p, q = (height * slope for slope in bumps(x, y))
    n = [-p, -q * flip, 1.0]
    length = math.sqrt(sum(c * c for c in n)) / scale
    return [round(255 * encode(0.5 + 0.5 * c / length)) for c in n]


def srgb(c):
    return 12.92 * c if c <= 0.0031308 else 1.055 * c ** (1 / 2.4) - 0.055


class Asset:
    """Grows into a glTF; everything is in data URIs."""

    def __init__(self):
        self.data = b""
        self.json = {
            "asset": {"version": "2.0"},
            "scenes": [{"nodes": []}],
            "nodes": [],
            "meshes": [],
            "materials": [],
            "textures": [],
            "images": [],
            "accessors": [],
            "bufferViews": [],
        }

    def accessor(self, values, kind, components=5126):
        code = {5126: "f", 5125: "I"}[components]
        flat = [v for value in values for v in (value if isinstance(value, (list, tuple)) else [value])]
        packed = struct.pack(f"<{len(flat)}{code}", *flat)
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": len(self.data), "byteLength": len(packed)})
        self.data += packed
        view = len(self.json["bufferViews"]) - 1
        self.json["accessors"].append(
            {"bufferView": view, "componentType": components, "count": len(values), "type": kind}
        )
        return len(self.json["accessors"]) - 1

    def texture(self, data, kind="image/png"):
        self.json["images"].append({"uri": data if isinstance(data, str) else data_uri(data, kind)})
        self.json["textures"].append({"source": len(self.json["images"]) - 1})
        return {"index": len(self.json["textures"]) - 1}

    def material(self, material):
        self.json["materials"].append(material)
        return len(self.json["materials"]) - 1

    def mesh(self, material, positions, triangles, **attributes):
        kinds = {"NORMAL": "VEC3", "TANGENT": "VEC4", "TEXCOORD_0": "VEC2", "COLOR_0": "VEC3"}
        named = {"POSITION": self.accessor(positions, "VEC3")}
        named |= {name: self.accessor(values, kinds[name]) for name, values in attributes.items()}
        primitive = {"attributes": named, "indices": self.accessor([i for t in triangles for i in t], "SCALAR", 5125)}
        if material is not None:
            primitive["material"] = material
        self.json["meshes"].append({"primitives": [primitive]})
        return self.node(mesh=len(self.json["meshes"]) - 1)

    def quad(self, material, uvs=((0, 1), (1, 1), (1, 0), (0, 0)), tangents=True, normal=(0, 0, 1), color=None):
        """2 m wide, looking along +z, with all attributes."""
        more = {"TEXCOORD_0": uvs} if uvs else {}
        more |= {"TANGENT": [(1, 0, 0, 1)] * 4} if tangents else {}
        more |= {"COLOR_0": [color] * 4} if color else {}
        corners = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
        return self.mesh(material, corners, [(0, 1, 2), (0, 2, 3)], NORMAL=[normal] * 4, **more)

    def cube(self, material, side=1.0, drop=(), turn=(), inward=False):
        """Six faces with corners of their own; `drop` leaves out, `turn` reverses faces."""
        positions, triangles = [], []
        for axis in range(3):
            for sign in (-1, 1):
                face = 2 * axis + (sign > 0)
                if face in drop:
                    continue
                first = len(positions)
                for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                    corner = [0, 0, 0]
                    corner[axis], corner[(axis + 1) % 3], corner[(axis + 2) % 3] = sign, a, b
                    positions.append([side / 2 * c for c in corner])
                outward = (sign > 0) ^ (face in turn) ^ inward
                for t in ((0, 1, 2), (0, 2, 3)):
                    triangles.append([first + i for i in (t if outward else t[::-1])])
        return self.mesh(material, positions, triangles, TEXCOORD_0=[(0.5, 0.5)] * len(positions))

    def join_last_mesh(self):
        """Makes the last mesh part of the one before it."""
        self.json["meshes"][-2]["primitives"] += self.json["meshes"].pop()["primitives"]
        self.json["nodes"].pop()
        self.json["scenes"][0]["nodes"].pop()

    def node(self, **node):
        self.json["nodes"].append(node)
        self.json["scenes"][0]["nodes"].append(len(self.json["nodes"]) - 1)
        return self.json["nodes"][-1]

    def extension(self, *names, required=False):
        self.json.setdefault("extensionsUsed", []).extend(names)
        if required:
            self.json.setdefault("extensionsRequired", []).extend(names)

    def light(self, **light):
        self.extension("KHR_lights_punctual")
        lights = self.json.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})["lights"]
        lights.append(light)
        self.node(extensions={"KHR_lights_punctual": {"light": len(lights) - 1}})

    def text(self):
        whole = {key: value for key, value in self.json.items() if value}
        if self.data:
            whole["buffers"] = [{"byteLength": len(self.data), "uri": data_uri(self.data)}]
        return json.dumps(whole)


def pbr(color=(0.4, 0.4, 0.4), metallic=0.0, roughness=0.6, **more):
    inner = {"baseColorFactor": [*color, 1][:4], "metallicFactor": metallic, "roughnessFactor": roughness}
    inner |= {key: more.pop(key) for key in ("baseColorTexture", "metallicRoughnessTexture") if key in more}
    return {"pbrMetallicRoughness": inner, **more}


class CheckTest(CliTest):
    def write(self, asset, name="a.gltf"):
        (self.folder / name).write_text(asset if isinstance(asset, str) else asset.text())

    def findings(self, asset, *options):
        self.write(asset)
        report = json.loads(self.succeeds("check", "a.gltf", "--json", *options).out)
        return report["assets"][0]["findings"]

    def only(self, asset, code, severity):
        """The one finding that there is."""
        found = self.findings(asset)
        self.assertEqual([(f["code"], f["severity"]) for f in found], [(code, severity)], found)
        self.assertTrue(found[0]["message"])
        return found[0]

    def clean(self, asset):
        self.assertEqual(self.findings(asset), [])

    def quad_of(self, material, **options):
        asset = Asset()
        asset.quad(asset.material(material), **options)
        return asset


class Surfaces(CheckTest):
    def test_plausible_surfaces_are_clean(self):
        self.clean(self.quad_of(GREY))
        self.clean(self.quad_of(pbr((0.56, 0.57, 0.58), metallic=1, roughness=0.2)))
        self.clean(self.quad_of(pbr((0.89, 0.89, 0.89))))
        self.clean(self.quad_of(pbr((0.021, 0.021, 0.021))))
        self.clean(self.quad_of(pbr((1, 0, 0))))  # one channel is no luminance
        self.assertEqual(self.succeeds("check", "a.gltf").out, "a.gltf: clean (1 material, 2 triangles)\n")

    def test_albedo_out_of_range(self):
        bright = self.only(self.quad_of(pbr((0.95, 0.95, 0.95), name="snow")), "albedo-too-bright", "warning")
        self.assertEqual((bright["material"], bright["share"]), ("material 'snow'", 1.0))
        self.assertAlmostEqual(bright["measured"]["mean"], 0.95, delta=1e-3)
        self.only(self.quad_of(pbr((0.01, 0.01, 0.01))), "albedo-too-dark", "note")
        self.only(self.quad_of(pbr((0, 0, 0))), "albedo-too-dark", "warning")

    def half_white(self, uvs, **more):
        asset = Asset()
        texture = asset.texture(png(64, 64, lambda x, y: [255] * 3 if x < 32 else [160] * 3))
        asset.quad(asset.material(pbr((1, 1, 1), baseColorTexture=texture, **more)), uvs=uvs)
        return asset

    def test_texels_count_by_the_surface_that_shows_them(self):
        whole = self.only(self.half_white(((0, 1), (1, 1), (1, 0), (0, 0))), "albedo-too-bright", "warning")
        self.assertAlmostEqual(whole["share"], 0.5, delta=0.02)
        quarter = self.only(self.half_white(((0.4, 1), (0.8, 1), (0.8, 0), (0.4, 0))), "albedo-too-bright", "warning")
        self.assertAlmostEqual(quarter["share"], 0.25, delta=0.02)
        self.clean(self.half_white(((0.6, 1), (0.9, 1), (0.9, 0), (0.6, 0))))

    def test_shares_are_of_area_over_all_instances(self):
        asset = self.half_white(((0, 1), (0.45, 1), (0.45, 0), (0, 0)))
        asset.quad(0, uvs=((0.55, 1), (0.95, 1), (0.95, 0), (0.55, 0)))["scale"] = [2, 2, 2]
        self.assertAlmostEqual(self.only(asset, "albedo-too-bright", "warning")["share"], 0.2, delta=0.01)

    def test_what_is_cut_away_does_not_count(self):
        asset = Asset()
        texture = asset.texture(png(64, 64, lambda x, y: [255, 255, 255, 0] if x < 32 else [160, 160, 160, 255]))
        asset.quad(asset.material(pbr((1, 1, 1), baseColorTexture=texture, alphaMode="MASK")))
        self.clean(asset)

    def test_clear_glowing_and_piled_surfaces_may_be_black_or_white(self):
        clear = self.quad_of(pbr((1, 1, 1), extensions={"KHR_materials_transmission": {"transmissionFactor": 1}}))
        clear.extension("KHR_materials_transmission")
        self.clean(clear)
        self.clean(self.quad_of(pbr((0, 0, 0), emissiveFactor=[1, 1, 1])))
        pile = {"KHR_materials_sheen": {"sheenColorFactor": [0.5, 0.1, 0.1], "sheenRoughnessFactor": 0.4}}
        velvet = self.quad_of(pbr((0, 0, 0), extensions=pile))
        velvet.extension("KHR_materials_sheen")
        self.clean(velvet)

    def test_vertex_colors_count(self):
        self.only(self.quad_of(GREY, color=(0, 0, 0)), "albedo-too-dark", "warning")

    def test_dark_metal(self):
        found = self.only(self.quad_of(pbr((0.2, 0.2, 0.2), metallic=1)), "metal-too-dark", "warning")
        self.assertEqual(found["share"], 1.0)
        self.assertIn("metallicFactor 0", found["fix"])
        # A measured metal is what it is, whatever its base colour.
        named = pbr((0.2, 0.2, 0.2), metallic=1, extras={"candela": {"conductor": "tungsten"}})
        self.clean(self.quad_of(named))

    def chart(self, paper, ink, share, bend=0.0):
        """A quad with a picture of which `share` is ink; `bend` lifts one of its corners."""
        asset = Asset()
        texture = asset.texture(png(64, 64, lambda x, y: [ink] * 3 if 64 * y + x < share * 4096 else [paper] * 3))
        corners = [(-1, -1, 0), (1, -1, 0), (1, 1, bend), (-1, 1, 0)]
        asset.mesh(asset.material(pbr((1, 1, 1), baseColorTexture=texture)), corners, [(0, 1, 2), (0, 2, 3)],
                   NORMAL=[(0, 0, 1)] * 4, TEXCOORD_0=[(0, 1), (1, 1), (1, 0), (0, 0)])  # fmt: skip
        return asset

    def test_print_on_a_chart_has_no_albedo(self):
        self.clean(self.chart(255, 0, 0.1))
        self.clean(self.chart(0, 255, 0.1))  # white on black
        # What is curved, what has no print, and what is no print for the most part are surfaces.
        self.only(self.chart(255, 0, 0.05, bend=1.0), "albedo-too-bright", "warning")
        self.only(self.chart(255, 255, 0.1), "albedo-too-bright", "warning")
        self.only(self.chart(255, 160, 0.5), "albedo-too-bright", "warning")

    def test_unlit_surfaces_reflect_nothing(self):
        asset = self.quad_of(pbr((0, 0, 0), metallic=1, extensions={"KHR_materials_unlit": {}}))
        asset.extension("KHR_materials_unlit")
        self.clean(asset)

    def test_metallic_between(self):
        found = self.only(self.quad_of(pbr((0.6, 0.6, 0.6), metallic=0.5)), "metallic-between", "note")
        self.assertAlmostEqual(found["measured"]["mean"], 0.5, delta=1e-3)

    def test_roughness_zero(self):
        self.only(self.quad_of(pbr(roughness=0)), "roughness-zero", "note")
        self.clean(self.quad_of(pbr(roughness=0.05)))

    def test_occlusion_in_the_wrong_channel(self):
        asset = Asset()
        texture = asset.texture(png(8, 8, lambda x, y: [0, 200, 0]))
        asset.quad(asset.material(pbr(occlusionTexture=texture)))
        self.only(asset, "occlusion-black", "warning")

    def test_blend_that_never_blends(self):
        self.only(self.quad_of(pbr(alphaMode="BLEND")), "blend-but-opaque", "note")
        half = pbr(alphaMode="BLEND")
        half["pbrMetallicRoughness"]["baseColorFactor"][3] = 0.5
        self.clean(self.quad_of(half))

    def test_invisible(self):
        half = pbr(alphaMode="BLEND")
        half["pbrMetallicRoughness"]["baseColorFactor"][3] = 0
        self.only(self.quad_of(half), "invisible", "warning")

    def test_texture_times_zero(self):
        asset = Asset()
        texture = asset.texture(png(8, 8, lambda x, y: [200, 200, 100]))
        asset.quad(asset.material(pbr(emissiveTexture=texture)))
        self.assertIn("emissiveTexture", self.only(asset, "texture-without-effect", "note")["message"])
        asset.json["materials"][0]["emissiveFactor"] = [1, 1, 1]
        self.clean(asset)

    def test_index_of_refraction(self):
        asset = self.quad_of(pbr(extensions={"KHR_materials_ior": {"ior": 4}}))
        asset.extension("KHR_materials_ior")
        self.only(asset, "ior-too-high", "warning")

    def test_reflectance_of_dielectrics(self):
        bright = {"KHR_materials_specular": {"specularColorFactor": [10, 10, 10]}}
        asset = self.quad_of(pbr(extensions=bright))
        asset.extension("KHR_materials_specular")
        found = self.only(asset, "specular-too-bright", "warning")
        self.assertAlmostEqual(found["measured"]["reflectance"], 0.4, delta=1e-3)
        asset.json["materials"][0]["pbrMetallicRoughness"] |= {"metallicFactor": 1, "baseColorFactor": [0.6, 0.6, 0.6, 1]}
        self.clean(asset)  # of metals it says nothing


class Maps(CheckTest):
    def with_normal_map(self, texel, tangents=True, **more):
        asset = Asset()
        texture = asset.texture(png(64, 64, texel))
        asset.quad(asset.material(pbr(normalTexture=texture, **more)), tangents=tangents)
        return asset

    def test_right_map_is_clean(self):
        self.clean(self.with_normal_map(normal_texel))

    def test_direction_of_green(self):
        found = self.only(self.with_normal_map(lambda x, y: normal_texel(x, y, flip=-1)), "normal-map-flipped-y", "warning")
        self.assertLess(found["measured"]["curl_correlation"], -0.8)
        self.assertLess(found["measured"]["curl_residual_flipped"], 0.3 * found["measured"]["curl_residual"])
        self.assertIn("green", found["fix"])

    def test_green_of_part_of_a_map_is_not_clear(self):
        self.clean(self.with_normal_map(lambda x, y: normal_texel(x, y, flip=-1 if x < 32 else 1)))
        # A steep decal against a faint relief, and the other way round.
        decal = lambda sign: lambda x, y: normal_texel(x, y, sign if x < 12 else -sign, height=1.5 if x < 12 else 0.3)
        self.clean(self.with_normal_map(decal(-1)))
        self.clean(self.with_normal_map(decal(1)))

    def test_srgb_codes(self):
        found = self.only(self.with_normal_map(lambda x, y: normal_texel(x, y, encode=srgb)), "normal-map-srgb", "warning")
        self.assertGreater(found["measured"]["mean_x"], 0.3)

    def test_short_vectors(self):
        found = self.only(self.with_normal_map(lambda x, y: normal_texel(x, y, scale=0.5)), "normal-map-not-unit", "warning")
        self.assertAlmostEqual(found["measured"]["median_length"], 0.5, delta=0.02)

    def test_map_without_blue(self):
        self.only(self.with_normal_map(lambda x, y: normal_texel(x, y)[:2] + [0]), "normal-map-inward", "warning")

    def test_tangents_missing(self):
        self.only(self.with_normal_map(normal_texel, tangents=False), "tangents-missing", "note")

    def test_normal_map_as_base_color(self):
        asset = Asset()
        texture = asset.texture(png(64, 64, normal_texel))
        asset.quad(asset.material(pbr((1, 1, 1), baseColorTexture=texture)))
        self.only(asset, "base-color-is-normal-map", "warning")
        plain = Asset()
        texture = plain.texture(png(8, 8, lambda x, y: [126 + x % 4, 126 + y % 4, 255]))
        plain.quad(plain.material(pbr((1, 1, 1), baseColorTexture=texture)))
        self.clean(plain)  # lavender

    def test_one_image_in_slots_of_two_kinds(self):
        asset = Asset()
        texture = asset.texture(png(64, 64, normal_texel))
        asset.quad(asset.material(pbr((1, 1, 1), baseColorTexture=texture, normalTexture=texture)))
        self.only(asset, "normal-map-as-other", "warning")
        asset = Asset()
        texture = asset.texture(png(8, 8, lambda x, y: [100 + 10 * x, 150, 0]))
        inner = {"metallicRoughnessTexture": texture, "baseColorTexture": texture}
        asset.quad(asset.material(pbr((1, 1, 1), **inner)))
        found = self.only(asset, "data-as-color", "warning")
        self.assertIn("baseColorTexture and metallicRoughnessTexture", found["message"])

    def test_one_plain_texel_may_serve_everywhere(self):
        asset = Asset()
        texture = asset.texture(png(2, 2, lambda x, y: [200, 200, 200]))
        asset.quad(asset.material(pbr(baseColorTexture=texture, occlusionTexture=texture)))
        self.clean(asset)

    def test_packed_images_are_meant(self):
        asset = Asset()
        texture = asset.texture(png(8, 8, lambda x, y: [200 + 5 * x, 150, 0]))
        asset.quad(asset.material(pbr(metallicRoughnessTexture=texture, occlusionTexture=texture)))
        self.clean(asset)


def ktx2(width=8, height=8, color=(170, 170, 170), model=166, vk_format=0, transfer=2, primaries=1, flags=0, keys=None):
    """A KTX 2 of one plain colour in blocks of UASTC (mode 8), or what else the words say."""
    bits = 0x17
    for i, code in enumerate((*color, 255)):
        bits |= code << (5 + 8 * i)
    data = bits.to_bytes(16, "little") * (((width + 3) // 4) * ((height + 3) // 4))
    if vk_format == 43:
        data = bytes((*color, 255)) * (width * height)
    pairs = b""
    for key, value in (keys or {}).items():
        pair = key.encode() + b"\0" + value.encode() + b"\0"
        pairs += struct.pack("<I", len(pair)) + pair + b"\0" * (-len(pair) % 4)
    descriptor = struct.pack("<IIHHBBBB8s8s", 44, 0, 2, 40, model, primaries, transfer, flags, b"\3\3", b"\x10")
    descriptor += struct.pack("<IIII", 127 << 16 | 3 << 24, 0, 0, 0xFFFFFFFF)
    at = 104 + len(descriptor) + len(pairs)
    head = b"\xabKTX 20\xbb\r\n\x1a\n" + struct.pack("<9I", vk_format, 1, width, height, 0, 0, 1, 1, 0)
    head += struct.pack("<4I2Q", 104, len(descriptor), 104 + len(descriptor) if pairs else 0, len(pairs), 0, 0)
    return head + struct.pack("<3Q", at, len(data), len(data)) + descriptor + pairs + data


class TextureFiles(CheckTest):
    """What a KTX 2 says of itself, against its slot and what glTF allows."""

    def asset(self, slot, file, extension="KHR_texture_basisu"):
        asset = Asset()
        texture = asset.texture(data_uri(file, "image/ktx2"))
        source = asset.json["textures"][0].pop("source")
        asset.json["textures"][0]["extensions"] = {extension: {"source": source}}
        asset.extension(extension, required=True)
        material = {
            "baseColorTexture": pbr((1, 1, 1), baseColorTexture=texture),
            "metallicRoughnessTexture": pbr(roughness=1, metallicRoughnessTexture=texture),
            "occlusionTexture": pbr(occlusionTexture=texture),
        }[slot]
        asset.quad(asset.material(material))
        return asset

    def test_what_gltf_asks_for_is_clean(self):
        self.clean(self.asset("baseColorTexture", ktx2()))
        data = ktx2(color=(255, 150, 0), transfer=1, primaries=0)
        self.clean(self.asset("metallicRoughnessTexture", data))
        self.clean(self.asset("occlusionTexture", ktx2(transfer=1, primaries=1)))  # as encoders write it
        self.clean(self.asset("baseColorTexture", ktx2(keys={"KTXswizzle": "rgba", "KTXorientation": "rd"})))

    def test_transfer_functions(self):
        for transfer in (0, 1, 5):
            self.only(self.asset("baseColorTexture", ktx2(transfer=transfer)), "ktx-transfer", "warning")
        found = self.only(self.asset("occlusionTexture", ktx2(transfer=2)), "ktx-transfer", "warning")
        self.assertIn("read as linear data", found["message"])

    def test_the_slot_decides_whatever_the_file_says(self):
        pictures = []
        for transfer in (1, 2):
            self.write(self.asset("baseColorTexture", ktx2(transfer=transfer)))
            self.succeeds("render", "a.gltf", "-o", "a.png", "--size", "32x32", "--spp", "4")
            pictures.append((self.folder / "a.png").read_bytes())
        self.assertEqual(*pictures)

    def test_primaries(self):
        self.only(self.asset("baseColorTexture", ktx2(primaries=10)), "ktx-primaries", "warning")
        self.only(self.asset("baseColorTexture", ktx2(primaries=0)), "ktx-primaries", "note")

    def test_what_is_not_followed(self):
        for keys, code in (({"KTXswizzle": "rg01"}, "ktx-swizzle"), ({"KTXorientation": "ru"}, "ktx-orientation")):
            self.only(self.asset("baseColorTexture", ktx2(keys=keys)), code, "warning")
        self.only(self.asset("baseColorTexture", ktx2(flags=1)), "ktx-premultiplied", "warning")

    def test_sizes(self):
        for size in ((6, 8), (8, 7), (1, 1)):
            self.only(self.asset("baseColorTexture", ktx2(*size)), "ktx-size", "warning")

    def test_formats(self):
        plain = ktx2(model=1, vk_format=43)
        self.only(self.asset("baseColorTexture", plain), "ktx-format", "warning")
        found = self.findings(self.asset("baseColorTexture", ktx2(model=134, vk_format=145)))[0]
        self.assertEqual(found["code"], "texture-unreadable")
        self.assertIn("bc7", found["message"])

    def test_astc_is_uncommon(self):
        block = b"\xfc\xfd" + b"\xff" * 6 + b"\xaa" * 6 + b"\xff\xff"
        file = bytearray(ktx2(model=162, vk_format=158))
        file[-64:] = block * 4
        self.only(self.asset("baseColorTexture", bytes(file), "EXT_texture_astc"), "extension-uncommon", "note")
        codes = [f["code"] for f in self.findings(self.asset("baseColorTexture", bytes(file)))]
        self.assertEqual(codes, ["ktx-format"])


class Bodies(CheckTest):
    def glass(self, thickness=1.0, **volume):
        extensions = {
            "KHR_materials_transmission": {"transmissionFactor": 1},
            "KHR_materials_volume": {"thicknessFactor": thickness, **volume},
        }
        return pbr((1, 1, 1), roughness=0, extensions=extensions)

    def body(self, material=None, **cube):
        asset = Asset()
        asset.extension("KHR_materials_transmission", "KHR_materials_volume")
        asset.cube(asset.material(material or self.glass()), **cube)
        return asset

    def test_closed_body_is_clean_though_its_corners_are_apart(self):
        self.clean(self.body())

    def test_a_hollow_is_no_fault(self):
        asset = self.body(self.glass(thickness=0.3))
        asset.cube(0, side=0.4, inward=True)
        asset.join_last_mesh()
        self.clean(asset)

    def test_a_hollow_may_be_a_node_or_a_material_of_its_own(self):
        for has_own_material in (False, True):
            asset = self.body(self.glass(thickness=0.3))
            asset.cube(asset.material(self.glass(thickness=0.3)) if has_own_material else 0, side=0.4, inward=True)
            self.clean(asset)
        asset = self.body(self.glass(thickness=0.3))
        asset.cube(0, side=0.4, inward=True)["translation"] = [3, 0, 0]
        self.only(asset, "volume-inside-out", "warning")

    def test_bodies_of_one_mesh_close_each_other(self):
        asset = self.body(drop=[5])
        asset.cube(asset.material(self.glass()), drop=[0, 1, 2, 3, 4])
        asset.join_last_mesh()
        self.clean(asset)

    def test_bodies_of_two_nodes_close_each_other(self):
        asset = self.body(drop=[5])
        asset.cube(asset.material(self.glass()), drop=[0, 1, 2, 3, 4])
        self.clean(asset)

    def test_a_room_does_not_close_a_body_in_it(self):
        asset = self.body(drop=[5])
        asset.cube(asset.material(GREY), side=10, inward=True)
        self.only(asset, "volume-open", "warning")

    def test_open_body(self):
        found = self.only(self.body(drop=[5]), "volume-open", "warning")
        self.assertEqual(found["measured"]["boundary_edges"], 4)
        self.assertGreater(found["share"], 0.1)

    def test_face_turned_round(self):
        found = self.only(self.body(turn=[2]), "volume-inconsistent-winding", "warning")
        self.assertEqual(found["measured"]["inconsistent_edges"], 4)

    def test_inside_out(self):
        self.only(self.body(inward=True), "volume-inside-out", "warning")

    def test_opaque_caps_close(self):
        asset = self.body(drop=[5])
        asset.quad(asset.material(GREY))["translation"] = [0, 0, 0.5]
        self.clean(asset)

    def test_thickness_is_compared_with_the_way_inside(self):
        found = self.only(self.body(self.glass(thickness=20)), "thickness-mismatch", "note")
        self.assertAlmostEqual(found["measured"]["true_m"], 1, delta=0.01)
        self.assertAlmostEqual(found["measured"]["ratio"], 20, delta=0.2)

    def test_thickness_is_times_its_texture(self):
        asset = Asset()
        asset.extension("KHR_materials_transmission", "KHR_materials_volume")
        material = self.glass(thicknessTexture=asset.texture(png(4, 4, lambda x, y: [255, 13, 255])))
        asset.cube(asset.material(material))
        self.assertAlmostEqual(self.only(asset, "thickness-mismatch", "note")["measured"]["ratio"], 13 / 255, delta=0.001)
        material["extensions"]["KHR_materials_volume"]["thicknessFactor"] = 20
        self.clean(asset)

    def test_thickness_scales_with_the_node(self):
        asset = self.body()
        asset.json["nodes"][0]["scale"] = [10, 10, 10]
        self.clean(asset)

    def test_attenuation_out_of_scale(self):
        black = self.glass(attenuationDistance=0.001, attenuationColor=[0.5, 0.5, 0.5])
        self.only(self.body(black), "attenuation-out-of-scale", "note")
        self.clean(self.body(self.glass(attenuationDistance=1, attenuationColor=[0.5, 0.9, 0.5])))

    def test_dispersion(self):
        material = self.glass()
        material["extensions"]["KHR_materials_dispersion"] = {"dispersion": 1.1}
        asset = self.body(material)
        asset.extension("KHR_materials_dispersion")
        self.clean(asset)
        material["extensions"]["KHR_materials_dispersion"]["dispersion"] = 5
        self.only(asset, "dispersion-too-strong", "warning")

    def test_a_body_with_relief_is_probed_on_the_relief(self):
        asset = Asset()
        asset.extension("KHR_materials_transmission", "KHR_materials_volume")
        material = self.glass()
        # White lies on the mesh itself: the same cube, cut into small triangles.
        white = asset.texture(png(4, 4, lambda x, y: [255, 255, 255]))
        material["extras"] = {"candela": {"heightTexture": {**white, "scale": 0.1}}}
        asset.cube(asset.material(material))
        self.clean(asset)
        material["extensions"]["KHR_materials_volume"]["thicknessFactor"] = 20
        self.assertAlmostEqual(self.only(asset, "thickness-mismatch", "note")["measured"]["true_m"], 1, delta=0.01)

    def test_instances_of_a_body(self):
        asset = self.body()
        for i in range(3):
            asset.node(mesh=0, translation=[3 * i + 3, 0, 0], scale=[2, 2, -2])
        self.clean(asset)

    def test_volume_without_transmission(self):
        material = pbr(extensions={"KHR_materials_volume": {"thicknessFactor": 1}})
        self.only(self.body(material), "volume-without-transmission", "note")


class Lights(CheckTest):
    def lit(self, material=None, **light):
        asset = self.quad_of(material or GREY)
        asset.light(**light)
        return asset

    def test_lamps_of_the_world_are_clean(self):
        self.clean(self.lit(type="point", intensity=64))
        self.clean(self.lit(type="directional", intensity=100000))
        self.clean(self.lit(type="spot", intensity=5000, spot={"outerConeAngle": 0.4}))

    def test_implausible_lamps(self):
        found = self.only(self.lit(type="point", intensity=54351, name="Lamp"), "light-too-bright", "warning")
        self.assertAlmostEqual(found["measured"]["flux_lm"], 54351 * 4 * math.pi, delta=100)
        self.assertIn("Lamp", found["subject"])
        self.clean(self.lit(type="point", intensity=54351, color=[0, 0, 0.1]))  # lumens see little blue
        self.only(self.lit(type="directional", intensity=1e6), "light-too-bright", "warning")
        self.only(self.lit(type="directional", intensity=3), "light-without-unit", "note")
        self.only(self.lit(type="point", intensity=0.5), "light-without-unit", "note")

    def test_glow(self):
        bulb = pbr(emissiveFactor=[1, 1, 1])
        self.clean(self.quad_of(bulb))
        found = self.only(self.lit(bulb, type="directional", intensity=100000), "emission-too-faint", "note")
        self.assertAlmostEqual(found["measured"]["white_wall_cd_m2"], 100000 / math.pi, delta=10)
        bulb["extensions"] = {"KHR_materials_emissive_strength": {"emissiveStrength": 1e10}}
        asset = self.quad_of(bulb)
        asset.extension("KHR_materials_emissive_strength")
        self.only(asset, "emission-too-bright", "warning")


class Files(CheckTest):
    def test_uv_missing(self):
        asset = Asset()
        texture = asset.texture(png(8, 8, lambda x, y: [150 + x] * 3))
        asset.quad(asset.material(pbr((1, 1, 1), baseColorTexture=texture)), uvs=None)
        self.assertIn("TEXCOORD_0", self.only(asset, "uv-missing", "error")["message"])

    def test_degenerate_triangles(self):
        asset = Asset()
        corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (2, 0, 0)]
        asset.mesh(asset.material(GREY), corners, [(0, 1, 2), (0, 1, 1), (0, 1, 3)], NORMAL=[(0, 0, 1)] * 4)
        found = self.only(asset, "degenerate-triangles", "note")
        self.assertAlmostEqual(found["share"], 2 / 3)

    def test_normals_off_unit(self):
        found = self.only(self.quad_of(GREY, normal=(0, 0, 2)), "normals-not-unit", "warning")
        self.assertEqual((found["share"], found["measured"]["worst_length"]), (1.0, 2.0))

    def test_extensions(self):
        asset = self.quad_of(GREY)
        asset.extension("VENDOR_unheard_of")
        self.assertEqual(self.only(asset, "extension-ignored", "warning")["subject"], "VENDOR_unheard_of")
        asset.json["extensionsRequired"] = ["VENDOR_unheard_of"]
        self.only(asset, "extension-missing", "error")
        draft = self.quad_of(GREY)
        draft.extension("KHR_materials_volume_scatter")
        self.only(draft, "extension-uncommon", "note")
        candidate = self.quad_of(GREY)
        candidate.extension("KHR_materials_diffuse_transmission")
        self.assertIn("not ratified", self.only(candidate, "extension-uncommon", "note")["message"])

    def test_what_the_loader_puts_right_is_told(self):
        asset = self.quad_of(pbr(roughness=7))
        self.assertIn("roughnessFactor 7", self.only(asset, "file-oddity", "warning")["message"])

    def test_every_variant_is_judged(self):
        asset = self.quad_of(GREY)
        dark = asset.material(pbr((0, 0, 0), name="tar"))
        asset.extension("KHR_materials_variants")
        asset.json["extensions"] = {"KHR_materials_variants": {"variants": [{"name": "day"}, {"name": "night"}]}}
        mapping = {"material": dark, "variants": [1]}
        asset.json["meshes"][0]["primitives"][0]["extensions"] = {"KHR_materials_variants": {"mappings": [mapping]}}
        found = self.only(asset, "albedo-too-dark", "warning")
        self.assertEqual((found["material"], found["subject"]), ("material 'tar'", "variant 'night'"))

    def test_normals_against_winding(self):
        self.only(self.quad_of(GREY, normal=(0, 0, -1)), "normals-against-winding", "warning")

    def test_size(self):
        asset = self.quad_of(GREY)
        asset.json["nodes"][0]["scale"] = [1e5, 1e5, 1e5]
        self.only(asset, "size-unlikely", "note")

    def test_scenes_with_little_in_them(self):
        asset = Asset()
        asset.quad(None, uvs=None, tangents=False)
        self.clean(asset)  # glTF's default material
        empty = Asset()
        empty.node(name="lonely")
        self.only(empty, "nothing-to-see", "note")

    def test_unreadable_images_are_all_named(self):
        asset = Asset()
        broken = asset.texture(png(8, 8, lambda x, y: [9, 9, 9])[:60])
        absent = asset.texture("absent.png")
        whole = asset.texture(png(8, 8, lambda x, y: [200, 200, 200]))
        asset.quad(asset.material(pbr(baseColorTexture=broken, normalTexture=absent, emissiveTexture=whole)))
        self.write(asset)
        report = json.loads(self.succeeds("check", "a.gltf", "--json").out)["assets"][0]
        self.assertTrue(report["readable"], "the rest of it is judged")
        lost = [f for f in report["findings"] if f["code"] == "texture-unreadable"]
        self.assertEqual([f["severity"] for f in lost], ["error"] * 2)
        self.assertIn("absent.png", lost[1]["message"])
        self.assertNotIn("file-oddity", [f["code"] for f in report["findings"]], "each is said once")
        self.fails("check", "a.gltf", "--strict", "-q", says="2 errors")

    def test_a_broken_file_does_not_keep_a_folder_from_being_judged(self):
        (self.folder / "deep").mkdir()
        self.write(self.quad_of(GREY), "deep/good.gltf")
        self.write(self.quad_of(pbr((0, 0, 0))), "dark.GLTF")
        self.write("{", "broken.gltf")
        (self.folder / "other.txt").write_text("no scene")
        result = self.run_candela("check", ".")
        self.assertEqual(result.code, 1)
        self.assertRegex(result.err, "1 of 3 files cannot be read")
        self.assertRegex(result.out, r"(?m)^\./broken.gltf: cannot be read\n  error +unreadable +\S+broken.gltf: JSON error")
        self.assertRegex(result.out, r"(?m)^\./dark.GLTF: 0 errors, 1 warning, 0 notes\n  warning  albedo-too-dark ")
        self.assertRegex(result.out, r"(?m)^\./deep/good.gltf: clean")
        self.assertRegex(result.out, r"3 files, 1 clean, 1 unreadable: 1 error, 1 warning, 0 notes\n\Z")

    def test_nothing_to_check(self):
        self.fails("check", "absent.glb", says="1 of 1 file cannot be read")
        report = json.loads(self.run_candela("check", "absent.glb", "--json").out)["assets"][0]
        self.assertEqual((report["readable"], report["findings"][0]["code"]), (False, "unreadable"))
        self.assertIn("no such file", report["reason"])
        (self.folder / "empty").mkdir()
        self.fails("check", "empty", says="there is no scene in this folder")

    def test_strict(self):
        self.write(self.quad_of(pbr((0, 0, 0))))
        self.succeeds("check", "a.gltf")
        self.fails("check", "a.gltf", "--strict", says="0 errors and 1 warning")
        self.write(self.quad_of(pbr(roughness=0)))
        self.succeeds("check", "a.gltf", "--strict")  # notes are no fault

    def test_one_line_each_whatever_names_hold(self):
        self.write(self.quad_of(pbr((0, 0, 0), name="a\nb\x1b[31m")))
        out = self.succeeds("check", "a.gltf").out
        self.assertEqual(out.count("\n"), 2)
        self.assertNotIn("\x1b", out)

    def test_many_materials(self):
        asset = Asset()
        asset.quad(asset.material(GREY), uvs=None, tangents=False)
        primitive = asset.json["meshes"][0]["primitives"][0]
        for i in range(1, 10000):
            color = 0 if i % 100 == 0 else 0.4
            asset.material(pbr((color,) * 3))
            asset.json["meshes"][0]["primitives"].append(primitive | {"material": i})
        start = time.perf_counter()
        found = self.findings(asset)
        self.assertLess(time.perf_counter() - start, 60)  # 1 s, sanitizers get room
        self.assertEqual([f["material_index"] for f in found], list(range(100, 10000, 100)))
        out = self.succeeds("check", "a.gltf").out
        self.assertLess(out.count("\n"), 8)
        self.assertIn("and 95 more albedo-too-dark", out)

    def test_threads_change_nothing(self):
        asset = self.quad_of(pbr((0.95, 0.95, 0.95), metallic=0.04))
        self.write(asset)
        one = self.succeeds("check", "a.gltf", "--json", "--threads", "1").out
        self.assertEqual(one, self.succeeds("check", "a.gltf", "--json", "--threads", "2").out)

    def test_usage(self):
        self.refuses("check", says="SCENE")
        self.refuses("check", "", says="SCENE")
        self.refuses("check", "a.glb", "--threads", "-1", says="-1")
        text = self.succeeds("check", "--help").out
        self.assertIn("candela check assets/ --strict", text)

    def test_built_in_scenes(self):
        report = json.loads(self.succeeds("check", "demo:spheres", "--json").out)
        self.assertEqual(report["summary"]["files"], 1)


class Models(CheckTest):
    def test_reference_models(self):
        models = self.assets() / "models"
        start = time.perf_counter()
        report = json.loads(self.run_candela("check", models, "--json").out)
        self.assertLess(time.perf_counter() - start, 60)
        found = {asset["file"].split("/")[-1]: asset for asset in report["assets"] if asset["readable"]}
        for name in ("Avocado.gltf", "BoxTextured.glb", "TwoSidedPlane.gltf", "AnimatedCube.gltf"):
            self.assertEqual([f for f in found[name]["findings"] if f["severity"] != "note"], [], name)
        spheres = found["MetalRoughSpheresNoTextures.glb"]["findings"]
        self.assertEqual({f["code"] for f in spheres}, {"metallic-between", "roughness-zero", "degenerate-triangles"})
        codes = [f["code"] for asset in found.values() for f in asset["findings"]]
        self.assertNotIn("normal-map-flipped-y", codes)
        self.assertNotIn("normal-map-srgb", codes)


class Filters(CheckTest):
    """What is not told, and from where on something is."""

    def setUp(self):
        super().setUp()
        self.write("mirror.gltf", self.quad_of(pbr(roughness=0, name="glaze")))
        self.write("snow.gltf", self.quad_of(pbr((0.95, 0.95, 0.95))))

    def write(self, name, asset):
        (self.folder / name).parent.mkdir(exist_ok=True)
        (self.folder / name).write_text(asset.text())

    def codes(self, *arguments):
        told = json.loads(self.succeeds("check", *arguments, "--json").out)
        return [f["code"] for asset in told["assets"] for f in asset["findings"]]

    def test_ignored_codes_are_not_told(self):
        self.assertEqual(self.codes("."), ["roughness-zero", "albedo-too-bright"])
        self.assertEqual(self.codes(".", "--ignore", "albedo-too-bright"), ["roughness-zero"])
        self.assertEqual(self.codes(".", "--ignore", "albedo-too-bright,roughness-zero"), [])
        self.succeeds("check", ".", "--strict", "--ignore", "albedo-too-bright")
        result = self.run_candela("check", ".", "--ignore", "albedo-too-brigth")
        self.assertEqual(result.code, 2)
        self.assertIn("--ignore: no finding has the code 'albedo-too-brigth': did you mean albedo-too-bright?", result.err)

    def test_limits_move(self):
        self.assertEqual(self.codes("snow.gltf", "--limit", "albedo-too-bright=0.96"), [])
        self.assertEqual(self.codes("mirror.gltf", "--limit", "roughness-zero=0"), [])
        self.assertEqual(self.codes("mirror.gltf", "--ignore", "roughness-zero", "--limit", "too-many-triangles=2"), [])
        many = ("--limit", "too-many-triangles=1", "--limit", "too-many-materials=0")
        self.assertEqual(self.codes("mirror.gltf", "--ignore", "roughness-zero", *many),
                         ["too-many-triangles", "too-many-materials"])  # fmt: skip
        self.write("big.gltf", self.half_grey())
        self.assertEqual(self.codes("big.gltf", "--limit", "texture-too-large=64"), [])
        self.assertEqual(self.codes("big.gltf", "--limit", "texture-too-large=63"), ["texture-too-large"])
        self.assertEqual(self.codes("big.gltf", "--limit", "textures-too-heavy=0.016"), ["textures-too-heavy"])
        for text, says in {"x=1": "only albedo-too-bright", "albedo-too-bright": "is not CODE=X",
                           "albedo-too-brigt=1": "did you mean albedo-too-bright", "albedo-too-bright=2": "not within"}.items():  # fmt: skip
            result = self.run_candela("check", ".", "--limit", text)
            self.assertEqual(result.code, 2, text)
            self.assertRegex(result.err, f"--limit: .*{says}")

    def half_grey(self):
        asset = Asset()
        texture = asset.texture(png(64, 64, lambda x, y: [100 + x, 120, 140]))
        asset.quad(asset.material(pbr((1, 1, 1), baseColorTexture=texture)))
        return asset

    def test_what_is_known_is_not_told_again(self):
        self.succeeds("check", ".", "--write-baseline", "kept/known.json")
        known = json.loads((self.folder / "kept/known.json").read_text())["known_findings"]
        self.assertEqual([entry["file"] for entry in known], ["../mirror.gltf", "../snow.gltf"])
        self.assertEqual(self.codes(".", "--baseline", "kept/known.json"), [])
        done = self.succeeds("check", ".", "--baseline", "kept/known.json", "--strict")
        self.assertIn("0 errors, 0 warnings, 0 notes, 2 known\n", done.out)
        # From another folder it means the same files; what is new is told.
        (self.folder / "elsewhere").mkdir()
        self.succeeds("check", str(self.folder), "--baseline", str(self.folder / "kept/known.json"), "--strict")
        self.write("new.gltf", self.quad_of(pbr((0.96, 0.96, 0.96))))
        self.assertEqual(self.codes(".", "--baseline", "kept/known.json"), ["albedo-too-bright"])
        self.fails("check", ".", "--baseline", "kept/known.json", "--strict", says="0 errors and 1 warning")

    def test_no_file_that_is_judged_is_overwritten_by_its_findings(self):
        before = (self.folder / "snow.gltf").read_bytes()
        self.fails("check", "snow.gltf", "--write-baseline", "./snow.gltf", says="is an input and would be overwritten")
        self.assertEqual((self.folder / "snow.gltf").read_bytes(), before)
        self.succeeds("check", "snow.gltf", "--write-baseline", "known.json")
        self.succeeds("check", "snow.gltf", "--baseline", "known.json", "--write-baseline", "known.json")

    def test_what_is_no_baseline_is_one_line(self):
        self.fails("check", ".", "--baseline", "absent.json", says="absent.json: no such file")
        for text in ("", "[]", '{"known_findings": 3}', '{"known_findings": [3]}', "{"):
            (self.folder / "a.json").write_text(text)
            self.fails("check", ".", "--baseline", "a.json", says="a.json: is no file of --write-baseline")

    def test_every_code_is_on_the_page(self):
        page = (candela.ROOT / "docs/check.md").read_text()
        sources = "".join(path.read_text() for path in sorted((candela.ROOT / "src/check").glob("*.cpp")))
        known = set(re.findall(r'"([a-z0-9-]+)"', sources.split("finding_codes()")[1].split("};")[0]))
        self.assertGreater(len(known), 50)
        for code in known:
            self.assertIn(f"`{code}`", page)
        told = set(re.findall(r'(?:code = |add\(|\w+,\s)"([a-z0-9]+(?:-[a-z0-9]+)+)"', sources))
        self.assertLessEqual(told, known)


if __name__ == "__main__":
    candela.main()
