#!/usr/bin/env python3
"""`candela bake`: files, errors, bad input."""

import hashlib
import json
import struct
import unittest
import zlib

import candela
from candela import CliTest

SMALL = ("--size", "16", "--levels", "3", "--irradiance-size", "4", "--proof", "8")


def hdr(width, height, texel):
    """A Radiance file without run lengths; `texel(x, y)` gives four bytes."""
    body = b"".join(bytes(texel(x, y)) for y in range(height) for x in range(width))
    return f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n".encode() + body


def grey_png(width, height):
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    raw = (b"\0" + b"\x80" * width) * height
    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b"")


def exr(width, height, value):
    """An uncompressed OpenEXR file of 32-bit floats; `value(x, y)` is grey."""

    def attribute(name, kind, body):
        return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(body)) + body

    channels = b"".join(c + b"\0" + struct.pack("<iB3xii", 2, 0, 1, 1) for c in (b"B", b"G", b"R")) + b"\0"
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    head = b"\x76\x2f\x31\x01\x02\0\0\0" + b"".join(
        (
            attribute("channels", "chlist", channels),
            attribute("compression", "compression", b"\0"),
            attribute("dataWindow", "box2i", window),
            attribute("displayWindow", "box2i", window),
            attribute("lineOrder", "lineOrder", b"\0"),
            attribute("pixelAspectRatio", "float", struct.pack("<f", 1)),
            attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)),
            attribute("screenWindowWidth", "float", struct.pack("<f", 1)),
            b"\0",
        )
    )
    line = 8 + 12 * width
    first = len(head) + 8 * height
    offsets = struct.pack(f"<{height}Q", *(first + y * line for y in range(height)))
    rows = (struct.pack(f"<{width}f", *(value(x, y) for x in range(width))) for y in range(height))
    return head + offsets + b"".join(struct.pack("<ii", y, 12 * width) + 3 * row for y, row in enumerate(rows))


class Bake(CliTest):
    def test_furnace_is_white_and_the_errors_are_told(self):
        report = json.loads(self.succeeds("bake", "furnace", "-o", "out", "--json", *SMALL).out)
        for channel_in, channel_out in zip(report["energy"]["in"], report["energy"]["out"]):
            self.assertAlmostEqual(channel_in, 4 * 3.14159265, 5)
            self.assertAlmostEqual(channel_out, channel_in, 5)
        self.assertEqual([level["size"] for level in report["specular"]], [16, 8, 4])
        self.assertAlmostEqual(report["specular"][1]["roughness"], 0.7071, 4)
        for level in report["specular"][1:]:
            self.assertLess(level["error_at_texels"]["max"], 1e-3)
        self.assertEqual(report["proof"]["directions"], 8)
        sh = json.loads((self.folder / "out/sh.json").read_text())
        self.assertEqual(len(sh["coefficients"]), 9)
        self.assertAlmostEqual(sh["coefficients"][0][0], 3.14159265 * (4 * 3.14159265) ** 0.5, 3)
        info = self.succeeds("info", "out/specular_m1_px.exr").out
        self.assertIn("8", info)
        self.assertEqual(json.loads((self.folder / "out/bake.json").read_text())["specular"], report["specular"])

    def test_every_option_changes_what_it_says(self):
        base = json.loads(self.succeeds("bake", "sky", "-o", "a", "--json", *SMALL).out)

        def with_options(*options):
            return json.loads(self.succeeds("bake", "sky", "-o", "b", "--json", *SMALL, *options).out)

        self.assertAlmostEqual(with_options("--env-intensity", "2")["energy"]["in"][0], 2 * base["energy"]["in"][0], 4)
        self.assertEqual([v["roughness"] for v in with_options("--mapping", "linear")["specular"]], [0, 0.5, 1])
        self.assertGreater(len(with_options("--sheen")["sheen"]), 2)
        self.assertEqual(with_options("--sh-order", "4")["sh"]["order"], 4)
        self.assertGreater(with_options("--window", "hann")["sh"]["window_width"], 0)
        noisy = with_options("--method", "montecarlo", "--samples", "16")["specular"][1]
        self.assertEqual(noisy["method"], "montecarlo")
        self.assertGreater(noisy["error_at_texels"]["max"], 0.05)
        riemann = with_options("--irradiance", "riemann", "--samples", "64")["irradiance"]
        self.assertGreater(riemann["error_at_texels"]["max"], base["irradiance"]["error_at_texels"]["max"])
        turned = with_options("--env-rotation", "90", "--extract-sun")["suns"][0]["direction"]
        straight = with_options("--extract-sun")["suns"][0]["direction"]
        # A quarter turn about +y, counter-clockwise from above: x becomes -z.
        self.assertAlmostEqual(turned[2], -straight[0], 4)
        self.assertAlmostEqual(turned[1], straight[1], 5)

    def test_sun_and_tables_are_files(self):
        self.succeeds("bake", "sky:40", "-o", "out", "--extract-sun", "--tables", "--table-size", "8", *SMALL)
        suns = json.loads((self.folder / "out/suns.json").read_text())["suns"]
        self.assertEqual(len(suns), 1)
        self.assertAlmostEqual(suns[0]["direction"][1], 0.6428, 3)
        self.assertAlmostEqual(suns[0]["angular_diameter_deg"], 0.53, 1)
        self.assertGreater(suns[0]["illuminance"], 5)
        for name in ("dfg.exr", "dfg_k_ibl.exr", "without_suns.exr"):
            self.assertTrue((self.folder / "out" / name).is_file(), name)
        self.succeeds("bake", "--tables", "--table-size", "4", "-o", "alone")
        self.assertEqual(
            sorted(path.name for path in (self.folder / "alone").iterdir()),
            sorted(["bake.json", *(f"dfg{k}.{x}" for k in ("", "_k_ibl") for x in ("exr", "h", "json", "ktx2"))]),
        )

    def test_report_is_a_page_with_pictures(self):
        self.succeeds("bake", "studio", "-o", "out", "--report", "page.html", *SMALL)
        page = (self.folder / "page.html").read_text()
        self.assertEqual(page.count("data:image/png;base64,"), 4)
        self.assertIn("error at texels", page)

    def test_any_number_of_threads_gives_the_same_bytes(self):
        digests = []
        for threads in ("1", "2"):
            self.succeeds("bake", "studio", "-o", threads, "--threads", threads, *SMALL)
            files = sorted((self.folder / threads).glob("*.exr"))
            digests.append([hashlib.sha256(path.read_bytes()).hexdigest() for path in files])
        self.assertEqual(digests[0], digests[1])
        self.assertEqual(len(digests[0]), 24)

    def test_each_format_is_a_file_that_is_read_again(self):
        self.succeeds("bake", "studio", "-o", "exr", *SMALL)
        formats = ("hdr", "ktx2", "ktx2-rgba32f", "ktx2-rgb9e5", "ktx1", "ktx1-rgba16f", "dds", "dds-rgba32f")
        for name in formats:
            self.succeeds("bake", "studio", "-o", name, "--format", name, *SMALL)
            textures = [f"{name}/specular{end}" for end in (".ktx2", ".ktx", ".dds", "_m0_%s.hdr")]
            file = next(f for f in textures if (self.folder / f.replace("%s", "px")).is_file())
            # One against the other: what is read back is the cube that was baked, to the steps of the format.
            diff = self.succeeds("bake", "--diff", file, "exr/specular_m0_%s.exr", "--json") if "hdr" in name else None
            if diff is None:
                self.succeeds("bake", file, "-o", "again", "--format", "ktx2-rgba32f", *SMALL)
                diff = self.succeeds("bake", "--diff", file, "again/specular.ktx2", "--json")
            sharp = json.loads(diff.out)["levels"][0]
            self.assertLess(sharp["max"], 0.04, name)
            self.assertLess(abs(sharp["mean"]), 0.02, name)
        # Pictures are seen from inside and textures looked up by the direction: read again they are the same light.
        one = ("--size", "16", "--levels", "1", "--irradiance-size", "4", "--proof", "0")
        self.succeeds("bake", "sky", "-o", "one", "--format", "ktx2-rgba32f", *one)
        self.succeeds("bake", "sky", "-o", "other", "--format", "exr", *one)
        same = self.succeeds("bake", "--diff", "one/specular.ktx2", "other/specular_%s.exr", "--json")
        self.assertEqual(json.loads(same.out)["levels"][0]["max"], 0)
        self.succeeds("bake", "studio", "-o", "pictures", "--format", "rgbm", *SMALL)
        self.assertTrue((self.folder / "pictures/specular_m1_nz.png").is_file())
        self.succeeds("bake", "studio", "-o", "flat", "--format", "panorama", *SMALL)
        self.assertRegex(self.succeeds("info", "flat/specular_m0.exr").out, "64 x 32")

    def test_each_engine_gets_what_it_reads(self):
        engines = {
            "filament": "specular.ktx",
            "three": "specular_px.hdr",
            "babylon": "specular.dds",
            "khronos": "specular.ktx2",
            "bevy": "diffuse.ktx2",
            "godot": "environment.exr",
            "unreal": "specular.dds",
            "unity": "specular.dds",
        }
        for engine, file in engines.items():
            small = ["--size", "32", "--proof", "0"]
            small += ["--irradiance-size", "4"] if engine in ("khronos", "bevy") else []
            small += ["--levels", "4"] if engine not in ("three", "godot", "unreal") else []
            report = self.succeeds("bake", "sky", "-o", engine, "--profile", engine, "--json", *small).out
            self.assertEqual(json.loads(report)["profile"], engine)
            self.assertTrue((self.folder / engine / file).is_file(), engine)
        # lod = r (2 - r) (n - 1)
        report = json.loads((self.folder / "filament/bake.json").read_text())
        self.assertAlmostEqual(report["specular"][1]["roughness"], 1 - (2 / 3) ** 0.5, 4)

    def test_the_code_that_loads_a_bake_names_its_files(self):
        names = {"filament": "specular.ktx", "three": "specular_${face}.hdr", "babylon": "specular.dds", "khronos": "specular.ktx2",
                 "bevy": "diffuse.ktx2", "godot": "environment.exr", "unreal": "specular.dds", "unity": "specular.dds"}  # fmt: skip
        for engine, name in names.items():
            told = self.succeeds("bake", "sky", "-o", engine, "--profile", engine, "--size", "16", "--proof", "0").out
            code = told.split(" loads it so:")[1]
            self.assertIn(name, code)
            self.assertLessEqual(code.split(" also reads")[0].count("\n"), 14)
            filters_itself = engine in ("three", "babylon", "godot", "unreal", "unity")
            self.assertEqual("also reads a panorama itself" in told, filters_itself, engine)

    def test_what_an_engine_has_no_use_for_is_refused(self):
        def refused(engine, *options):
            self.refuses("bake", "sky", "-o", "out", "--profile", engine, *options, says=f"{options[0]}: {engine} ")

        for engine in ("three", "godot", "unreal"):
            refused(engine, "--levels", "4")
            refused(engine, "--method", "zonal")
            refused(engine, "--error", "1%")
        for engine in ("filament", "three", "babylon", "godot", "unreal", "unity"):
            refused(engine, "--irradiance-size", "8")
            refused(engine, "--irradiance", "riemann")
        for engine in ("khronos", "bevy", "godot", "unreal", "unity"):
            refused(engine, "--window", "hann")
        for engine in ("filament", "three", "babylon", "khronos", "bevy", "godot", "unreal", "unity"):
            refused(engine, "--sh-order", "3")
            refused(engine, "--sheen")
        for engine in ("bevy", "godot", "unreal", "unity"):
            refused(engine, "--tables")

    def test_what_a_scene_sees_is_baked(self):
        small = ("--size", "16", "--levels", "2", "--irradiance-size", "4", "--proof", "0", "--spp", "4")
        self.succeeds("bake", "furnace", "--from-scene", "demo:furnace", "--at", "0,50,0", "-o", "out", *small)
        sh = json.loads((self.folder / "out/sh.json").read_text())["coefficients"]
        # Far above white things in a furnace: the furnace.
        self.assertAlmostEqual(sh[0][0], 3.14159265 * (4 * 3.14159265) ** 0.5, 2)
        box = ("bake", "none", "--from-scene", "demo:cornell", "--at", "0,0.27,0.1", "--format", "ktx2", *small)
        self.succeeds(*box, "-o", "1", "--threads", "1")
        self.succeeds(*box, "-o", "2", "--threads", "2")
        for name in ("specular.ktx2", "irradiance.ktx2"):
            self.assertEqual((self.folder / "1" / name).read_bytes(), (self.folder / "2" / name).read_bytes())
        harmonics = json.loads((self.folder / "1/sh.json").read_text())["coefficients"]
        # The red wall is at -x, the green one at +x: (l, m) = (1, 1) goes with x.
        self.assertLess(harmonics[3][0], 0)
        self.assertGreater(harmonics[3][1], 0)

    def test_clamped_texels_are_told(self):
        (self.folder / "sun.hdr").write_bytes(
            hdr(16, 8, lambda x, y: (255, 255, 255, 148 if (x, y) == (5, 2) else 120))
        )
        told = self.succeeds("bake", "sun.hdr", "-o", "out", "--format", "ktx2", *SMALL).err
        self.assertRegex(told, "above what the format holds were clamped")
        self.assertNotRegex(self.succeeds("bake", "sun.hdr", "-o", "b", "--format", "ktx2-rgba32f", *SMALL).err, "clamped")

    def test_oddities_are_told_and_survived(self):
        (self.folder / "grey.png").write_bytes(grey_png(16, 8))
        self.assertRegex(self.succeeds("bake", "grey.png", "-o", "out", *SMALL).err, "end at white")
        odd = {(3, 2): float("nan"), (9, 2): float("inf"), (1, 5): -2.0}
        (self.folder / "odd.exr").write_bytes(exr(16, 8, lambda x, y: odd.get((x, y), 1.0)))
        done = self.succeeds("bake", "odd.exr", "-o", "out", "--json", *SMALL)
        self.assertRegex(done.err, "2 texels are not finite, the first at 3,2")
        self.assertRegex(done.err, "1 texel is negative, at 1,5: it became 0")
        self.assertLess(json.loads(done.out)["energy"]["in"][0], 4 * 3.1416)

    def test_bad_input_leaves_nothing(self):
        (self.folder / "square.hdr").write_bytes(hdr(8, 8, lambda x, y: (128, 128, 128, 128)))
        (self.folder / "black.hdr").write_bytes(hdr(16, 8, lambda x, y: (0, 0, 0, 0)))
        (self.folder / "short.hdr").write_bytes(hdr(16, 8, lambda x, y: (9, 9, 9, 128))[:-9])
        self.fails("bake", "square.hdr", "-o", "out", says="twice as wide as high.*8x8")
        self.fails("bake", "black.hdr", "-o", "out", says="black everywhere")
        self.fails("bake", "short.hdr", "-o", "out", says="short.hdr")
        self.fails("bake", "absent.hdr", "-o", "out", says="absent.hdr")
        self.fails("bake", "sky", "-o", "/proc/absent/out", *SMALL, says="/proc/absent/out: cannot")
        self.fails("bake", "sky", "-o", "square.hdr", *SMALL, says="not a folder")
        (self.folder / "cube.ktx2").write_bytes(b"\xabKTX 20\xbb\r\n\x1a\n" + bytes(20))
        self.fails("bake", "cube.ktx2", "-o", "out", says="cube.ktx2")
        self.fails("bake", "--diff", "cube.ktx2", "cube.ktx2", says="cube.ktx2")
        self.fails("bake", "--from-scene", "absent.glb", "--at", "0,0,0", "-o", "out", says="absent.glb")
        noise = ("--method", "montecarlo", "--samples", "1")
        self.fails("bake", "sky", "-o", "out", "--error", "1e-7", *noise, *SMALL, says="--error.*refinements")

    def test_wrong_usage(self):
        self.refuses("bake", says="environment")
        self.refuses("bake", "sky", says="-o DIR")
        self.refuses("bake", "sky", "-o", "out", "--levels", "9", "--size", "100", says="--levels")
        self.refuses("bake", "sky", "-o", "out", "--method", "magic", says="--method.*magic")
        self.refuses("bake", "sky", "-o", "out", "--error", "0", says="--error")
        self.refuses("bake", "sky", "-o", "out", "--error", "1%", "--proof", "0", says="--error")
        self.refuses("bake", "--tables", "-o", "out", "--report", "x.html", says="--report")
        self.refuses("bake", "sky", "-o", "out", "--at", "0,0,0", says="--at")
        self.refuses("bake", "--from-scene", "demo:cornell", "-o", "out", says="--at")
        self.refuses("bake", "sky", "-o", "out", "--profile", "blender", says="--profile.*filament")
        self.refuses("bake", "sky", "-o", "out", "--profile", "three", "--format", "dds", says="--profile")
        self.refuses("bake", "sky", "-o", "out", "--format", "bmp", says="--format.*ktx2")
        self.refuses("bake", "sky", "-o", "out", "--axes", "+x+x+y", says="--axes")
        self.refuses("bake", "sky", "-o", "out", "--axes", "+x+y+z", says="--axes.*no cube map")


if __name__ == "__main__":
    candela.main()
