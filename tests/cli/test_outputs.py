#!/usr/bin/env python3
"""What is read is never written: names of pictures, of sets of pictures and of bakes."""

import base64
import json
import os
import pathlib
import shutil
import struct
import subprocess
import tempfile
import zlib

import candela
from candela import CliTest, png_pixels, triangle_glb
from test_bake import SMALL, hdr
from test_raster import environment

SMALLEST = ("--size", "12x8", "--spp", "1", "--threads", "2")
IES = "IESNA:LM-63-2002\nTILT=NONE\n1 1000 1 3 1 1 2 0 0 0\n1 1 1\n0 45 90\n0\n100 80 0\n"


def png(red, green, blue):
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    head = struct.pack(">IIBBBBB", 1, 1, 8, 2, 0, 0, 0)
    pixel = zlib.compress(bytes([0, red, green, blue]))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", pixel) + chunk(b"IEND", b"")


def gltf(buffer, image, **more):
    """A triangle whose numbers and whose texture lie in files."""
    return json.dumps(
        {
            "asset": {"version": "2.0"},
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0}]}],
            "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
            "textures": [{"source": 0}],
            "images": [{"uri": image}, *more.pop("images", [])],
            "accessors": [
                {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"},
            ],
            "bufferViews": [
                {"buffer": 0, "byteLength": 36},
                {"buffer": 0, "byteOffset": 36, "byteLength": 24},
            ],
            "buffers": [{"byteLength": 60, "uri": buffer}],
            **more,
        }
    )


def positions():
    return struct.pack("<15f", -1, -1, 0, 1, -1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1)


def glowing_glb(red, green, blue):
    """A triangle that fills the picture with one colour."""
    numbers = base64.b64encode(struct.pack("<9f", -4, -4, 0, 4, -4, 0, 0, 8, 0)).decode()
    scene = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        "materials": [{"emissiveFactor": [red, green, blue], "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1]}}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64," + numbers}],
    }
    text = json.dumps(scene).encode()
    text += b" " * (-len(text) % 4)
    return b"glTF" + struct.pack("<II", 2, 20 + len(text)) + struct.pack("<I4s", len(text), b"JSON") + text


class Overwriting(CliTest):
    ENGINES = ("path", "raster")

    def setUp(self):
        super().setUp()
        self.elsewhere = pathlib.Path(tempfile.mkdtemp(prefix="candela-cli-"))
        self.addCleanup(shutil.rmtree, self.elsewhere)
        self.environment = environment(self.elsewhere)
        probe = self.render("demo:spheres", "-o", self.elsewhere / "a.png", engine="raster")
        if "no usable OpenGL" in probe.err:
            self.ENGINES = ("path",)

    def render(self, *arguments, engine="path"):
        return self.run_candela("render", *arguments, *SMALLEST, "--engine", engine, env=self.environment)

    def write(self, **files):
        for name, content in files.items():
            path = self.folder / name.replace("__", "/").replace("_", ".")
            path.parent.mkdir(exist_ok=True)
            path.write_bytes(content if isinstance(content, bytes) else content.encode())

    def write_shoe(self, **more):
        self.write(shoe_gltf=gltf("shoe.bin", "shoe.png", **more), shoe_bin=positions(), shoe_png=png(200, 60, 20))

    def snapshot(self):
        return {p.relative_to(self.folder): p.read_bytes() for p in self.folder.rglob("*") if p.is_file()}

    def assert_refused(self, result, before, what):
        self.assertEqual(result.code, 1, result.err)
        self.assertEqual(result.err.count("\n"), 1, result.err)
        self.assertRegex(result.err, what)
        self.assertEqual(self.snapshot(), before)

    def assert_only_added(self, before, *names):
        after = self.snapshot()
        self.assertEqual({k: after[k] for k in before}, before, "an input changed")
        self.assertEqual({str(k) for k in after.keys() - before.keys()}, set(names))

    def test_a_texture_of_the_scenes_own_name_stays(self):
        for engine in self.ENGINES:
            for output in ((), ("-o", ".")):
                with self.subTest(engine=engine, output=output):
                    self.write_shoe()
                    before = self.snapshot()
                    result = self.render("shoe.gltf", *output, engine=engine)
                    self.assertEqual(result.code, 0, result.err)
                    self.assert_only_added(before, "shoe-2.png")
                    (self.folder / "shoe-2.png").unlink()
            before = self.snapshot()
            self.assert_refused(self.render("shoe.gltf", "-o", "shoe.png", engine=engine), before,
                                r"shoe\.png: is an input.*shoe\.gltf#/images/0/uri")  # fmt: skip

    def test_everything_that_a_scene_names_stays_whatever_it_is_called(self):
        """Buffers, profiles, images that no material uses and files of unknown extensions; decoded or not."""
        self.write(
            a_gltf=gltf(
                "numbers.png",
                "a%20map.png",
                images=[{"uri": "spare.png"}],
                extensionsUsed=["EXT_lights_ies", "VENDOR_thing"],
                extensions={
                    "EXT_lights_ies": {"lights": [{"uri": "lamp.jpg"}]},
                    "VENDOR_thing": {"list": [{"uri": "thing.exr"}]},
                },
            ),
            numbers_png=positions(),
            spare_png=b"no picture",
            lamp_jpg=IES,
            thing_exr=b"anything",
        )
        (self.folder / "a map.png").write_bytes(png(1, 2, 3))
        os.link(self.folder / "spare.png", self.folder / "hard.png")
        (self.folder / "soft.png").symlink_to("numbers.png")
        (self.folder / "sub").mkdir()
        (self.folder / "here").symlink_to(".")
        before = self.snapshot()
        names = ("numbers.png", "a map.png", "spare.png", "lamp.jpg", "thing.exr", "hard.png", "soft.png",
                 "sub/../spare.png", "here/numbers.png", str(self.folder / "spare.png"), "new/../spare.png",
                 "sub/new/../../numbers.png", "new/../soft.png")  # fmt: skip
        for name in names:
            with self.subTest(name=name):
                self.assert_refused(self.render("a.gltf", "-o", name), before, "is an input")
                self.assert_refused(self.render("a.gltf", "-o", "new.png", "--stats", name), before, "is an input")
        self.assert_refused(self.render("a.gltf", "-o", "new.png", "--stats", "a.gltf"), before, "the scene a.gltf")

    def test_a_file_that_is_named_and_missing_is_not_made(self):
        self.write(a_gltf=gltf("numbers.bin", "map.png", images=[{"uri": "later.png"}]), numbers_bin=positions(),
                   map_png=png(9, 9, 9))  # fmt: skip
        before = self.snapshot()
        for name in ("later.png", "LATER.png"):
            self.assert_refused(self.render("a.gltf", "-o", name), before, "is an input.*/images/1/uri")

    def test_an_environment_stays(self):
        self.write(sky_hdr=hdr(4, 2, lambda x, y: (128, 128, 128, 128)), spheres_png=png(9, 9, 9))
        before = self.snapshot()
        for name in ("sky.hdr", "./sky.hdr"):
            self.assert_refused(self.render("demo:spheres", "--env", "sky.hdr", "-o", name), before, "the environment")

    def test_pictures_of_a_set_stay_off_inputs(self):
        self.write(
            a_gltf=gltf("a-001.png", "a-002.png"), **{"a-001_png": positions(), "a-002_png": png(9, 9, 9)}
        )
        before = self.snapshot()
        for engine in self.ENGINES:
            with self.subTest(engine=engine):
                refused = self.render("a.gltf", "--turntable", "3", "-o", "a-%03d.png", engine=engine)
                self.assert_refused(refused, before, "a-001.png: is an input")
                result = self.render("a.gltf", "--turntable", "3", engine=engine)
                self.assertEqual(result.code, 0, result.err)
                names = [f"a-2-00{i}.png" for i in range(3)]
                self.assert_only_added(before, *names)
                for name in names:
                    (self.folder / name).unlink()

    def test_nothing_is_written_twice(self):
        ball = ("demo:spheres", "--turntable", "12")
        for outputs in (("1%d.png", "%d1.png"), ("f%d.png", "f%02d.png")):
            with self.subTest(outputs=outputs):
                result = self.render(*ball, "-o", outputs[0], "-o", outputs[1])
                self.assert_refused(result, {}, "would be written twice")
        result = self.render(*ball, "-o", "f%d.png", "--stats", "f7.png")
        self.assert_refused(result, {}, "would be written twice")
        self.write(real_png=b"older")
        (self.folder / "link.png").symlink_to("real.png")
        before = self.snapshot()
        self.assert_refused(self.render("demo:spheres", "-o", "real.png", "-o", "link.png"), before, "written twice")

    def test_a_per_cent_sign_of_a_folder_is_one(self):
        for folder in ("100%", "%d", "%03d%"):
            (self.folder / folder).mkdir()
            for engine in self.ENGINES:
                with self.subTest(folder=folder, engine=engine):
                    result = self.render("demo:spheres", "-o", f"{folder}/%d.png", "--turntable", "2", engine=engine)
                    self.assertEqual(result.code, 0, result.err)
                    self.assertEqual(sorted(p.name for p in (self.folder / folder).iterdir()), ["0.png", "1.png"])
            self.assertEqual(self.render("demo:spheres", "-o", f"{folder}/").code, 0)
            self.assertTrue((self.folder / folder / "spheres.png").is_file())
        # In the file's own name there is one number; %% and what is no number are per cent signs.
        result = self.render("demo:spheres", "-o", "50%%-%d%.png", "--turntable", "1")
        self.assertEqual(result.code, 0, result.err)
        self.assertTrue((self.folder / "50%-0%.png").is_file())
        self.assertEqual(self.render("demo:spheres", "-o", "%d-%d.png", "--turntable", "1").code, 2)
        self.assertEqual(self.render("demo:spheres", "-o", "%/%.png", "--turntable", "1").code, 2)
        # A single picture has no pattern, and neither has a scene's name.
        (self.folder / "90%d.glb").write_bytes(triangle_glb())
        for arguments, name in ((("demo:spheres", "-o", "%d.png"), "%d.png"), (("90%d.glb",), "90%d.png"),
                                (("90%d.glb", "-o", "100%/"), "100%/90%d.png"),
                                (("90%d.glb", "--turntable", "1"), "90%d-000.png")):  # fmt: skip
            result = self.render(*arguments)
            self.assertEqual(result.code, 0, result.err)
            self.assertTrue((self.folder / name).is_file(), name)

    def test_braces_of_a_scenes_name_are_braces(self):
        views = ("--views", "front,left")
        for name in ("b{view}", "{{camera}", "{variant}-{view}"):
            (self.folder / f"{name}.glb").write_bytes(triangle_glb())
            for arguments, made in (
                ((), f"{name}.png"),
                (("--views", "front"), f"{name}.png"),
                (views, f"{name}-left.png"),
                ((*views, "-o", "out/"), f"out/{name}-left.png"),
                (("demo:spheres", *views, "-o", "set/", "--dataset", "masks"), f"set/{name}-000001.png"),
                (("--turntable", "2"), f"{name}-001.png"),
            ):
                with self.subTest(name=name, arguments=arguments):
                    result = self.render(f"{name}.glb", *arguments)
                    self.assertEqual(result.code, 0, result.err)
                    self.assertTrue((self.folder / made).is_file(), sorted(self.folder.rglob("*.png")))
                    shutil.rmtree(self.folder / "set", ignore_errors=True)
        # A name that is given says it with two of them.
        result = self.render("demo:spheres", *views, "-o", "a{{view}-{view}.png")
        self.assertEqual(result.code, 0, result.err)
        self.assertTrue((self.folder / "a{view}-left.png").is_file())
        result = self.render("demo:spheres", *views, "-o", "a{{view}.png")
        self.assertEqual(result.code, 2, result.err)

    def test_scenes_of_one_name_have_pictures_of_their_own(self):
        colors = {"a/foo.glb": (1, 0, 0), "b/foo.glb": (0, 1, 0), "foo-2.glb": (0, 0, 1), "c/FOO.glb": (1, 1, 0)}
        for name, color in colors.items():
            (self.folder / name).parent.mkdir(exist_ok=True)
            (self.folder / name).write_bytes(glowing_glb(*color))
        expected = {"a-foo.png": "a/foo.glb", "foo-2.png": "foo-2.glb", "b-foo.png": "b/foo.glb", "c-FOO.png": "c/FOO.glb"}
        for engine in self.ENGINES:
            for again in range(2):  # what is there already does not change the names
                with self.subTest(engine=engine, again=again):
                    result = self.render(*colors, "-o", "out/", "--env", "none", "--exposure", "0", engine=engine)
                    self.assertEqual(result.code, 0, result.err)
                    self.assertEqual({p.name for p in (self.folder / "out").iterdir()}, set(expected))
                    for name, scene in expected.items():
                        _, _, channels, rows = png_pixels(self.folder / "out" / name)
                        middle = rows[4][6 * channels : 6 * channels + 3]
                        strongest = max(middle)
                        seen = tuple(int(v > strongest / 2) for v in middle)
                        self.assertEqual(seen, colors[scene], name)

    def test_the_picture_of_one_scene_is_no_texture_of_the_next(self):
        (self.folder / "a.glb").write_bytes(triangle_glb())
        self.write(b_gltf=gltf("b.bin", "a.png"), b_bin=positions(), a_png=png(9, 9, 9))
        before = self.snapshot()
        result = self.render("a.glb", "b.gltf", "-o", ".")
        self.assertEqual(result.code, 0, result.err)
        self.assert_only_added(before, "a-2.png", "b.png")


class Lists(CliTest):
    """Several commands in one run: what one of them reads or has written is safe from the others."""

    OTHER = " ".join(SMALLEST)

    def setUp(self):
        super().setUp()
        (self.folder / "a.glb").write_bytes(triangle_glb())
        (self.folder / "shoe.gltf").write_text(gltf("shoe.bin", "shoe.png"))
        (self.folder / "shoe.bin").write_bytes(positions())
        (self.folder / "shoe.png").write_bytes(png(200, 60, 20))
        (self.folder / "sky.hdr").write_bytes(hdr(4, 2, lambda x, y: (128, 128, 128, 128)))

    def snapshot(self):
        return {p.relative_to(self.folder): p.read_bytes() for p in self.folder.rglob("*") if p.is_file()}

    def added(self, before):
        after = self.snapshot()
        self.assertEqual({k: after[k] for k in before}, before, "a file changed")
        return {str(k) for k in after.keys() - before.keys()}

    def jobs(self, *lines, is_piped=False):
        text = "".join(f"{line} {self.OTHER}\n" for line in lines)
        if is_piped:
            return subprocess.run([candela.PROGRAM, "render", "--jobs", "-", "-q"], cwd=self.folder, input=text, text=True,
                                  capture_output=True, timeout=120, check=False)  # fmt: skip
        (self.elsewhere() / "jobs.txt").write_text(text)
        return self.run_candela("render", "--jobs", self.elsewhere() / "jobs.txt", "-q")

    def elsewhere(self):
        if not hasattr(self, "other_folder"):
            self.other_folder = pathlib.Path(tempfile.mkdtemp(prefix="candela-cli-"))
            self.addCleanup(shutil.rmtree, self.other_folder)
        return self.other_folder

    def test_no_job_overwrites_what_a_later_one_reads(self):
        os.link(self.folder / "shoe.png", self.folder / "hard.png")
        (self.folder / "cameras.json").write_text("{}")
        for line, later, says in (
            ("a.glb -o shoe.png", "shoe.gltf -o b.png", r"shoe\.png: is an input.*shoe\.gltf#/images/0/uri"),
            ("a.glb -o hard.png", "shoe.gltf -o b.png", "hard.png: is an input"),
            ("a.glb -o sky.hdr", "a.glb --env sky.hdr -o b.png", "sky.hdr: is an input.*the environment"),
            ("a.glb -o c.png --stats shoe.gltf", "shoe.gltf -o b.png", "shoe.gltf: is an input"),
            ("a.glb --views top -o sky.hdr", "shoe.gltf a.glb --env sky.hdr -o b/", "sky.hdr: is an input"),
        ):
            with self.subTest(line=line):
                before = self.snapshot()
                result = self.jobs(line, later)
                self.assertEqual(result.code, 1, result.err)
                self.assertRegex(result.err, "^failed: .*jobs.txt:1: .*" + says)
                self.assertIn("1 of 2 jobs failed", result.err)
                made = self.added(before)
                self.assertEqual(len(made), later.count(".gltf") + later.count(".glb"), made)
                for name in made:
                    (self.folder / name).unlink()

    def test_no_job_overwrites_what_an_earlier_one_read_or_wrote(self):
        for first, second, says in (
            ("shoe.gltf -o b.png", "a.glb -o shoe.png", "shoe.png: is an input"),
            ("a.glb --env sky.hdr -o b.png", "a.glb -o sky.hdr", "sky.hdr: is an input"),
            ("a.glb -o b.png", "shoe.gltf -o ./b.png", "b.png: would be overwritten: written by an earlier job"),
            ("a.glb -o b.png --stats b.json", "a.glb -o c.png --write-cameras b.json", "b.json: would be overwritten"),
            ("a.glb --views front,top -o b-{view}.png", "a.glb -o b-top.png", "b-top.png: would be overwritten"),
            ("a.glb --dataset masks -o b", "shoe.gltf --dataset masks -o b", "000000.png: would be overwritten: written by"),
            ("a.glb -o b/one.png", "shoe.gltf --dataset coco -o b", "one.png: lies in the output folder.*written by an earlier job"),
        ):
            for is_piped in (False, True):
                with self.subTest(second=second, is_piped=is_piped):
                    before = self.snapshot()
                    result = self.jobs(first, second, is_piped=is_piped)
                    code, told = (result.returncode, result.stderr) if is_piped else (result.code, result.err)
                    self.assertEqual(code, 1, told)
                    self.assertRegex(told, ":2: .*" + says)
                    self.assertIn("1 of 2 jobs failed", told)
                    for name in self.added(before):
                        (self.folder / name).unlink()

    def test_names_that_nobody_gave_differ(self):
        before = self.snapshot()
        result = self.jobs("a.glb", "a.glb --views top", "demo:spheres a.glb -o .", "shoe.gltf")
        self.assertEqual(result.code, 0, result.err)
        self.assertEqual(self.added(before), {"a.png", "a-2.png", "spheres.png", "a-3.png", "shoe-2.png"})

    def test_a_job_may_read_what_an_earlier_one_makes(self):
        (self.folder / "late.gltf").write_text(gltf("shoe.bin", "late.png"))
        result = self.jobs("a.glb --views front,top -o p-{view}.png --write-cameras transforms.json",
                           "shoe.gltf --cameras transforms.json -o q-{camera}.png", "a.glb -o late.png", "late.gltf -o r.png")  # fmt: skip
        self.assertEqual((result.code, result.err), (0, ""))
        self.assertTrue((self.folder / "q-p-top.png").is_file())
        self.assertTrue((self.folder / "r.png").is_file())

    def test_a_job_that_failed_may_be_tried_again_and_a_set_be_divided(self):
        result = self.jobs("a.glb -o b.jpg --background transparent --strict", "a.glb -o b.jpg", "a.glb --turntable 4 -o c%d.png --pictures 1-2",
                           "a.glb --turntable 4 -o c%d.png --pictures 3-4")  # fmt: skip
        self.assertIn("1 of 4 jobs failed", result.err)
        self.assertEqual({"b.jpg", *(f"c{i}.png" for i in range(4))} - set(self.files()), set())

    def test_no_command_of_a_plan_writes_what_another_reads_or_writes(self):
        for first, second, says in (
            ("a.glb -o shoe.png", "shoe.gltf -o b.png", "shoe.png: is an input"),
            ("shoe.gltf -o b.png", "a.glb -o shoe.png", "shoe.png: is an input"),
            ("a.glb -o sky.hdr", "a.glb --env sky.hdr -o b.png", "sky.hdr: is an input"),
            ("a.glb -o b.png", "shoe.gltf -o ./b.png", "b.png: would be overwritten: written by another command"),
            ("a.glb demo:spheres -o b/", "shoe.gltf -o b/a.png", "a.png: would be overwritten"),
            ("a.glb -o b.png", "shoe.gltf --spp 64 -o b.exr", r"b-1of\d\.part: would be overwritten"),
        ):
            (self.elsewhere() / "list.txt").write_text(f"{first} --size 8x8 --spp 64\n{second} --size 8x8\n")
            for commands in ((self.elsewhere() / "list.txt",), (first + " --size 8x8 --spp 64", second + " --size 8x8")):
                with self.subTest(second=second, commands=commands):
                    self.fails("plan", "-o", "work.txt", "--picture-time", "1h", "-q", *commands, says=says)


class Bakes(CliTest):
    def names(self, folder="out"):
        return {p.name for p in (self.folder / folder).iterdir()}

    def test_nothing_of_an_earlier_bake_stays_and_nothing_else_goes(self):
        out = self.folder / "out"
        self.succeeds("bake", "sky", "-o", "out", "--extract-sun", "--sheen", *SMALL)
        earlier = self.names()
        (out / "notes.txt").write_text("mine")
        (out / "specular_m9_px.exr").write_text("mine, though it looks like a level")
        (out / "suns.json").write_text("mine since I changed it")
        self.succeeds("bake", "studio", "-o", "out", "--format", "ktx2", *SMALL)
        new = {"specular.ktx2", "irradiance.ktx2", "sh.json", "sh.h", "bake.json"}
        self.assertFalse(new >= earlier)
        self.assertEqual(self.names(), new | {"notes.txt", "specular_m9_px.exr", "suns.json"})
        listed = json.loads((out / "bake.json").read_text())["files"]
        self.assertEqual({file["name"] for file in listed}, new - {"bake.json"})
        self.succeeds("bake", "--tables", "--table-size", "4", "-o", "out")
        self.assertEqual(self.names() & new, {"bake.json"})

    def test_a_list_of_files_reaches_no_other_folder(self):
        self.succeeds("bake", "--tables", "--table-size", "4", "-o", "out")
        manifest = self.folder / "out" / "bake.json"
        data = json.loads(manifest.read_text())
        (self.folder / "victim").write_bytes(b"")
        (self.folder / "out" / "sub").mkdir()
        entry = {"bytes": 0, "fingerprint": "cbf29ce484222325"}  # of nothing
        data["files"] = [{"name": n, **entry} for n in ("../victim", str(self.folder / "victim"), "sub", "..", "", 7)]
        manifest.write_text(json.dumps(data))
        self.succeeds("bake", "--tables", "--table-size", "4", "-o", "out")
        self.assertTrue((self.folder / "victim").is_file())
        self.assertTrue((self.folder / "out" / "sub").is_dir())
        for text in ("[]", "{", '{"files": 3}', '{"environment": "sky"}'):
            manifest.write_text(text)
            done = self.succeeds("bake", "--tables", "--table-size", "4", "-o", "out")
            self.assertIn("does not say which files", done.err)

    def test_what_is_baked_is_not_overwritten(self):
        self.succeeds("bake", "sky", "-o", "out", "--format", "ktx2", *SMALL)
        before = (self.folder / "out/specular.ktx2").read_bytes()
        self.fails("bake", "out/specular.ktx2", "-o", "out", "--format", "ktx2", *SMALL, says="specular.ktx2: is an input")
        self.fails("bake", "out/specular.ktx2", "-o", "b", "--report", "out/specular.ktx2", *SMALL, says="is an input")
        # In another format it is not in the way, but it is read: it stays, and a later bake takes it away.
        done = self.succeeds("bake", "out/specular.ktx2", "-o", "out", *SMALL)
        self.assertIn("this one read it", done.err)
        self.assertEqual((self.folder / "out/specular.ktx2").read_bytes(), before)
        self.succeeds("bake", "studio", "-o", "out", *SMALL)
        self.assertFalse((self.folder / "out/specular.ktx2").exists())
        self.fails("bake", "out/specular_m0_%s.exr", "-o", "out", *SMALL, says="specular_m0_.*is an input")

    def test_the_scene_of_a_bake_and_its_files_stay(self):
        (self.folder / "out").mkdir()
        (self.folder / "out/a.gltf").write_text(gltf("sh.json", "map.png"))
        (self.folder / "out/sh.json").write_bytes(positions())
        (self.folder / "out/map.png").write_bytes(png(9, 9, 9))
        self.fails("bake", "--from-scene", "out/a.gltf", "--at", "0,0,3", "--spp", "1", "-o", "out", *SMALL,
                   says="sh.json: is an input.*/buffers/0/uri")  # fmt: skip

    def test_a_report_is_no_file_of_the_bake(self):
        (self.folder / "out").mkdir()
        self.fails("bake", "sky", "-o", "out", "--report", "out/sh.json", *SMALL, says="another name")

    def test_what_cannot_be_replaced_leaves_the_earlier_bake_whole(self):
        self.succeeds("bake", "sky", "-o", "out", *SMALL)
        before = {p.name: p.read_bytes() for p in (self.folder / "out").iterdir()}
        (self.folder / "out/sheen_m0_px.exr").mkdir()
        self.fails("bake", "studio", "-o", "out", "--sheen", *SMALL, says="is a folder")
        (self.folder / "out/sheen_m0_px.exr").rmdir()
        self.assertEqual({p.name: p.read_bytes() for p in (self.folder / "out").iterdir()}, before)


if __name__ == "__main__":
    candela.main()
