#!/usr/bin/env python3
"""`candela render --engine raster`, turntables and several scenes at once."""

import base64
import json
import os
import pathlib
import shutil
import struct
import tempfile

import candela
from candela import ROOT, CliTest, png_pixels, triangle_glb

SPHERES = ("render", "demo:spheres", "--engine", "raster", "--size", "32x24")
TRACED = ("render", "demo:spheres", "--size", "16x12", "--spp", "1")


def environment(folder, **more):
    """Mesa's software driver, and caches that are the test's own."""
    return {**os.environ, "LIBGL_ALWAYS_SOFTWARE": "1", "XDG_CACHE_HOME": str(folder / "cache"), **more}


class RasterTest(CliTest):
    def setUp(self):
        super().setUp()
        self.elsewhere = pathlib.Path(tempfile.mkdtemp(prefix="candela-cli-"))
        self.addCleanup(shutil.rmtree, self.elsewhere)
        self.environment = environment(self.elsewhere)
        self.probe = self.elsewhere / "probe.png"
        probe = self.run_candela(*SPHERES, "-o", self.probe, env=self.environment)
        if "no usable OpenGL" in probe.err:
            self.skipTest(probe.err)
        self.assertEqual(probe.code, 0, probe.err)

    def draws(self, *arguments):
        return self.succeeds(*arguments, env=self.environment)


class Pictures(RasterTest):
    def test_png_and_exr_have_something_to_see(self):
        self.draws(*SPHERES, "-o", "a.png", "-o", "a.exr", "--aov", "normal,depth,id,albedo,position")
        width, height, channels, rows = png_pixels(self.folder / "a.png")
        self.assertEqual((width, height, channels), (32, 24, 3))
        self.assertGreater(len(set(b"".join(rows))), 32)
        self.assertEqual((self.folder / "a.exr").read_bytes()[:4], b"\x76\x2f\x31\x01")

    def test_frames_and_samples_at_edges_are_counted_in_the_statistics(self):
        self.draws(*SPHERES, "-o", "a.png", "--spp", "3", "--msaa", "2", "--stats", "s.json")
        stats = json.loads((self.folder / "s.json").read_text())
        self.assertEqual((stats["engine"], stats["frames"], stats["msaa"]), ("raster", 3, 2))
        self.assertIn("llvmpipe", stats["driver"])

    def test_light_is_baked_once_and_a_damaged_cache_is_no_error(self):
        cache = self.elsewhere / "cache" / "candela"
        shutil.rmtree(cache, ignore_errors=True)
        pictures = []
        for name, is_cached in (("a", False), ("b", True)):
            self.draws(*SPHERES, "-o", name + ".png", "--stats", name + ".json")
            self.assertEqual(json.loads((self.folder / (name + ".json")).read_text())["light_is_cached"], is_cached)
            pictures.append((self.folder / (name + ".png")).read_bytes())
        self.assertEqual(pictures[0], pictures[1])
        for file in cache.iterdir():
            file.write_bytes(file.read_bytes()[:100])
        self.draws(*SPHERES, "-o", "c.png", "--stats", "c.json")
        self.assertFalse(json.loads((self.folder / "c.json").read_text())["light_is_cached"])
        self.draws(*SPHERES, "-o", "d.png", "--no-cache")
        for name in ("c", "d"):
            self.assertEqual((self.folder / (name + ".png")).read_bytes(), pictures[0])

    def test_a_quality_is_a_number_of_frames(self):
        ball = ("render", "demo:spheres", "--engine", "raster", "--size", "32x24", "-o", "a.png", "--stats", "s.json")
        for options, frames in ((("draft",), 1), (("good",), 8), (("final", "--spp", "3"), 3)):
            self.draws(*ball, "--quality", *options)
            self.assertEqual(json.loads((self.folder / "s.json").read_text())["frames"], frames)

    def test_options_of_the_path_tracer_are_refused(self):
        for option in (("--time", "1s"), ("--noise", "0.1"), ("--bounces", "2"), ("--seed", "1"), ("--filter", "box"),
                       ("--integrator", "full")):  # fmt: skip
            self.refuses(*SPHERES, *option, says=option[0])
        self.refuses(*TRACED, "--msaa", "2", says="--msaa")

    def test_a_scene_that_only_glows_is_lit_by_what_glows(self):
        arguments = ("--size", "16x12", "--engine", "raster", "--env", "none", "-o", "a.png")
        # Lamps painted on a bent surface.
        points = struct.pack("<12f6H", 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 2, 0, 3, 1)
        uvs = struct.pack("<8f", 0, 0, 1, 0, 0, 1, 1, 1)
        pixel = ("data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg==")
        data = base64.b64encode(points + uvs).decode()
        (self.folder / "lamps.gltf").write_text(json.dumps({
            "asset": {"version": "2.0"}, "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 2}, "indices": 1, "material": 0}]}],
            "materials": [{"emissiveFactor": [1, 1, 1], "emissiveTexture": {"index": 0}}],
            "textures": [{"source": 0}], "images": [{"uri": pixel}],
            "buffers": [{"byteLength": 92, "uri": "data:application/octet-stream;base64," + data}],
            "bufferViews": [{"buffer": 0, "byteOffset": a, "byteLength": n} for a, n in ((0, 48), (48, 12), (60, 32))],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                          {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
                          {"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2"}]}))  # fmt: skip
        self.assertNotIn("warning", self.draws("render", "lamps.gltf", *arguments).err)
        self.assertNotIn("warning", self.draws("render", "demo:cornell", *arguments).err)
        self.assertNotIn("warning", self.draws(*SPHERES, "-o", "b.png").err)

    def test_every_shading_model_draws_a_picture_of_its_own(self):
        pictures = {"default": self.probe.read_bytes()}
        for model in ("gltf", "ue4", "thesis", "blinn-phong", "candela,multiscatter=off"):
            self.draws(*SPHERES, "-o", "model.png", "--shading", model)
            pictures[model] = (self.folder / "model.png").read_bytes()
        self.assertEqual(len(set(pictures.values())), len(pictures), list(pictures))
        self.draws(*SPHERES, "-o", "model.png", "--shading", "candela")
        self.assertEqual((self.folder / "model.png").read_bytes(), pictures["default"])

    def test_no_opengl_says_what_was_tried_and_what_helps(self):
        nowhere = environment(self.elsewhere, __EGL_VENDOR_LIBRARY_DIRS="/nonexistent", __EGL_VENDOR_LIBRARY_FILENAMES="")
        self.fails(*SPHERES, "-o", "b.png", says="no usable OpenGL.*libegl1", env=nowhere)

    def test_a_shader_that_does_not_compile_is_named_with_its_line(self):
        shaders = self.folder / "shaders"
        shutil.copytree(ROOT / "src/raster/shaders", shaders)
        shutil.copytree(ROOT / "src/shade", shaders / "shade", ignore=shutil.ignore_patterns("*.cpp", "*.txt"))
        self.draws(*SPHERES, "-o", "same.png", "--shaders", "shaders")
        self.assertEqual((self.folder / "same.png").read_bytes(), self.probe.read_bytes())
        frame = shaders / "background.frag.glsl"
        lines = frame.read_text().splitlines()
        lines[20] = "  this is no GLSL;"
        frame.write_text("\n".join(lines))
        result = self.run_candela(*SPHERES, "-o", "b.png", "--shaders", "shaders", env=self.environment)
        self.assertEqual(result.code, 1)
        self.assertIn("background.frag.glsl:21", result.err)
        self.assertNotIn("b.png", self.files())


class Turntables(RasterTest):
    def test_pictures_are_numbered_and_differ(self):
        (self.folder / "t").mkdir()
        self.draws(*SPHERES, "--turntable", "3", "-o", "t/%02d.png")
        names = sorted(path.name for path in (self.folder / "t").iterdir())
        self.assertEqual(names, ["00.png", "01.png", "02.png"])
        self.assertEqual(len({(self.folder / "t" / name).read_bytes() for name in names}), 3)
        self.draws(*SPHERES, "-o", "alone.png")
        self.assertEqual((self.folder / "t" / "00.png").read_bytes(), (self.folder / "alone.png").read_bytes())

    def test_the_path_tracer_turns_too(self):
        self.succeeds(*TRACED, "--turntable", "2")
        self.assertIn("spheres-000.png", self.files())
        self.assertIn("spheres-001.png", self.files())

    def test_a_name_without_a_number_is_refused(self):
        for name in ("a.png", "%s.png", "%d-%d.png", "%3d.png"):
            self.refuses(*SPHERES, "--turntable", "2", "-o", name, says="NAME%03d")


class Batches(RasterTest):
    def test_each_scene_has_its_picture(self):
        (self.folder / "other").mkdir()
        for path in ("one.glb", "two.glb", "other/one.glb"):
            (self.folder / path).write_bytes(triangle_glb())
        self.draws("render", "one.glb", "two.glb", "other/one.glb", "-o", "out/", "--engine", "raster", "--size", "16x16")
        self.assertEqual(sorted(p.name for p in (self.folder / "out").iterdir()), ["one.png", "other-one.png", "two.png"])

    def test_a_broken_scene_does_not_keep_the_others_from_theirs(self):
        (self.folder / "good.glb").write_bytes(triangle_glb())
        (self.folder / "bad.glb").write_bytes(b"glTF?")
        result = self.run_candela("render", "bad.glb", "good.glb", "-o", "out/", "--engine", "raster", "--size", "16x16",
                                  env=self.environment)  # fmt: skip
        self.assertEqual(result.code, 1)
        self.assertIn("1 of 2 scenes", result.err)
        self.assertIn("bad.glb", result.err)
        self.assertEqual([p.name for p in (self.folder / "out").iterdir()], ["good.png"])

    def test_several_scenes_want_a_folder(self):
        self.refuses("render", "demo:spheres", "demo:materials", "-o", "a.png", says="DIR")

    def test_an_animation_makes_a_sequence(self):
        fox = self.assets() / "models/Fox/glTF-Binary/Fox.glb"
        (self.folder / "s").mkdir()
        # The whole of what moves is framed, which a single picture knows nothing of.
        arguments = ("render", fox, "--animation", "Run", "--size", "48x32", "--eye", "200,120,250")
        for engine in ("raster", "path"):
            self.draws(*arguments, "--engine", engine, "--sequence", "3", "-o", f"s/{engine}%d.png", *(["--spp", "1"] if engine == "path" else []))
            names = [self.folder / "s" / f"{engine}{i}.png" for i in range(3)]
            self.assertEqual(len({name.read_bytes() for name in names}), 3)
            self.draws(*arguments, "--engine", engine, "--frame-time", "0s", "-o", "first.png", *(["--spp", "1"] if engine == "path" else []))
            self.assertEqual(names[0].read_bytes(), (self.folder / "first.png").read_bytes())

    def test_the_shutter_blurs_what_moves(self):
        cube = self.assets() / "models/AnimatedCube/glTF/AnimatedCube.gltf"
        arguments = ("render", cube, "--engine", "raster", "--size", "64x48", "--frame-time", "0.3s")
        self.draws(*arguments, "-o", "sharp.png", "--spp", "8")
        self.draws(*arguments, "-o", "blurred.png", "--shutter", "200ms", "--spp", "8")
        self.assertNotEqual((self.folder / "sharp.png").read_bytes(), (self.folder / "blurred.png").read_bytes())

    def test_animations_that_are_not_there_are_told(self):
        self.fails(*SPHERES, "--animation", "walk", says="a built-in scene has no animations", env=self.environment)
        fox = self.assets() / "models/Fox/glTF-Binary/Fox.glb"
        self.fails("render", fox, "--animation", "Fly", says="the file has: Survey, Walk, Run", env=self.environment)
        result = self.draws(*SPHERES, "--frame-time", "1s", "-o", "a.png")
        self.assertIn("nothing in it is animated", result.err)

    def test_what_makes_no_sense_in_time_is_refused(self):
        self.refuses(*SPHERES, "--sequence", "2", "--turntable", "2", "-o", "a%d.png", says="--turntable")
        self.refuses(*SPHERES, "--frame-time", "soon", says="--frame-time")


class Kinds(RasterTest):
    def test_each_option_changes_the_picture(self):
        pictures = set()
        for options in ([], ["--ambient", "harmonics"], ["--ambient", "mips"], ["--ambient", "constant"], ["--ambient", "none"],
                        ["--bloom", "0.3"], ["--ao", "0.6"], ["--probes", "1"]):  # fmt: skip
            self.draws(*SPHERES, *options, "-o", "a.png")
            pictures.add((self.folder / "a.png").read_bytes())
        self.assertEqual(len(pictures), 8)

    def test_lamps_have_soft_shadows_where_asked_for(self):
        (self.folder / "lit.glb").write_bytes(triangle_glb(light={"type": "point", "intensity": 10}))
        self.draws("render", "lit.glb", "--engine", "raster", "--size", "16x16", "--light-radius", "0.1", "-o", "a.png")

    def test_what_is_no_kind_of_light_is_refused(self):
        self.refuses(*SPHERES, "--ambient", "warm", says="--ambient")
        self.refuses(*TRACED, "--probes", "1", says="only for --engine raster")


if __name__ == "__main__":
    candela.main()
