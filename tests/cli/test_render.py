#!/usr/bin/env python3
"""`candela render`: pictures, statistics, progress, interruption, and what bad input leaves behind."""

import json
import os
import pathlib
import pty
import re
import resource
import signal
import time

import candela
from candela import CliTest, TINY, png_pixels, triangle_glb, variants_gltf

SPHERES = ("render", "demo:spheres")


class Pictures(CliTest):
    def test_png_has_the_size_and_something_to_see(self):
        self.succeeds(*SPHERES, *TINY, "-o", "a.png")
        width, height, channels, rows = png_pixels(self.folder / "a.png")
        self.assertEqual((width, height, channels), (16, 12, 3))
        self.assertGreater(len(set(b"".join(rows))), 16)
        self.assertEqual(self.files(), ["a.png"])

    def test_every_format_has_its_magic(self):
        magic = {"a.png": b"\x89PNG", "a.jpg": b"\xff\xd8\xff", "a.exr": b"\x76\x2f\x31\x01", "a.hdr": b"#?RADIANCE"}
        self.succeeds(*SPHERES, *TINY, *(word for name in magic for word in ("-o", name)))
        for name, first in magic.items():
            self.assertEqual((self.folder / name).read_bytes()[: len(first)], first)
        self.assertEqual(self.files(), sorted(magic))

    def test_default_name_is_the_scenes(self):
        self.succeeds(*SPHERES, *TINY)
        self.assertEqual(self.files(), ["spheres.png"])

    def test_names_with_blanks_and_other_letters(self):
        (self.folder / "zwei Ordner").mkdir()
        self.succeeds(*SPHERES, *TINY, "-o", "zwei Ordner/Bild ä 画.png")
        png_pixels(self.folder / "zwei Ordner" / "Bild ä 画.png")

    def test_transparent_background_reaches_the_png(self):
        self.succeeds(*SPHERES, *TINY, "-o", "a.png", "--background", "transparent", "--orbit", "0,60,3")
        _, _, channels, rows = png_pixels(self.folder / "a.png")
        self.assertEqual(channels, 4)
        self.assertEqual(rows[0][3], 0)

    def test_background_colour_is_what_was_asked(self):
        # Seen from far away a corner is background alone; linear tone curve and exposure 0 stops keep its value.
        self.succeeds(*SPHERES, *TINY, "-o", "a.png", "--background", "#4080c0", "--orbit", "0,60,3",
                      "--tonemap", "linear", "--exposure", "0")  # fmt: skip
        _, _, _, rows = png_pixels(self.folder / "a.png")
        for found, wanted in zip(rows[0][:3], (0x40, 0x80, 0xC0)):
            self.assertLessEqual(abs(found - wanted), 1)

    def test_glass_shows_the_background_or_the_room(self):
        glass = {
            "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 0, 1], "metallicFactor": 0, "roughnessFactor": 0},
            "doubleSided": True,
            "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}},
        }
        (self.folder / "glass.glb").write_bytes(triangle_glb(material=glass))

        def middle(name, *options):
            self.succeeds("render", "glass.glb", "--size", "16x12", "--spp", "64", "--env", "furnace", "--exposure", "0",
                          "-o", name, *options)  # fmt: skip
            width, height, channels, rows = png_pixels(self.folder / name)
            return rows[height // 2][width // 2 * channels : (width // 2 + 1) * channels]

        for engine in ("path", "raster"):
            with self.subTest(engine=engine):
                engine = ["--engine", engine]
                red, green, blue = middle("a.png", "--background", "#2040c0", *engine)
                self.assertLess(red, 90)
                self.assertLess(blue, 90)  # the filter is yellow
                # A filter that takes all blue keeps 0.07 of the brightness, and glass reflects 0.04 of the rest.
                self.assertLess(abs(middle("b.png", "--background", "transparent", *engine)[3] - 28), 8)
                room = middle("c.png", "--background", "#2040c0", "--glass", "env", *engine)
                self.assertGreater(min(room[0], room[1]), 150)
                self.assertEqual(middle("d.png", "--background", "transparent", "--glass", "env", *engine)[3], 255)
                # Every picture of several has its own.
                self.succeeds("render", "glass.glb", *TINY, "--env", "furnace", "-o", "%d.png", "--turntable", "2",
                              "--background", "transparent", *engine)  # fmt: skip
                for name in ("0.png", "1.png"):
                    width, height, channels, rows = png_pixels(self.folder / name)
                    self.assertLess(rows[height // 2][width // 2 * channels + 3], 128)

    def test_threads_do_not_change_a_bit(self):
        for threads in ("1", "2"):
            self.succeeds(*SPHERES, "--size", "40x30", "--spp", "4", "--threads", threads, "-o", threads + ".exr",
                          "--aov", "albedo,normal,depth,position,id")  # fmt: skip
        self.assertEqual((self.folder / "1.exr").read_bytes(), (self.folder / "2.exr").read_bytes())

    def test_seed_changes_the_noise(self):
        for seed in ("1", "2"):
            self.succeeds(*SPHERES, *TINY, "--seed", seed, "-o", seed + ".png")
        self.assertNotEqual(png_pixels(self.folder / "1.png"), png_pixels(self.folder / "2.png"))

    def test_options_change_the_picture(self):
        def picture(name, *options):
            self.succeeds(*SPHERES, *TINY, "--exposure", "0", "-o", name, *options)
            return png_pixels(self.folder / name)

        plain = picture("plain.png")
        for number, options in enumerate(
            [
                ["--env", "sky"],
                ["--env-rotation", "120"],
                ["--env-intensity", "0.5"],
                ["--env", "sky:5"],
                ["--bounces", "1"],
                ["--orbit", "80,10"],
                ["--eye", "3,3,3"],
                ["--fov", "30deg"],
                ["--tonemap", "agx"],
                ["--background", "white"],
                ["--filter", "gaussian"],
                ["--integrator", "minimal"],
                ["--f-number", "0.1"],
                ["--vignetting", "1"],
            ]
        ):
            with self.subTest(options=options):
                self.assertNotEqual(picture(f"{number}.png", *options), plain)

    def test_light_falloff_is_that_of_every_light(self):
        lamp = {"type": "point", "intensity": 20, "range": 5}

        def picture(name, light, *options):
            (self.folder / "lit.glb").write_bytes(triangle_glb(light))
            self.succeeds("render", "lit.glb", *TINY, "--env", "none", "--exposure", "0", "-o", name, *options)
            return png_pixels(self.folder / name)

        kinds = ["gltf", "inverse-square", "ue4", "polynomial:1,0.5,0.25"]
        pictures = [picture(f"{number}.png", lamp, "--light-falloff", kind) for number, kind in enumerate(kinds)]
        for number, one in enumerate(pictures):
            self.assertTrue(all(one != other for other in pictures[:number]), kinds[number])
        self.assertEqual(picture("plain.png", lamp), pictures[0])
        asked = {"falloff": "polynomial", "polynomial": [1, 0.5, 0.25]}
        self.assertEqual(picture("asked.png", {**lamp, "extras": {"candela": asked}}), pictures[3])
        self.assertEqual(picture("same.png", lamp, "--light-falloff", "polynomial"), pictures[1])

    def test_sun_elevation_is_the_sky_of_that_name(self):
        self.succeeds(*SPHERES, *TINY, "--sun-elevation", "12", "-o", "a.png")
        self.succeeds(*SPHERES, *TINY, "--env", "sky:12", "-o", "b.png")
        self.assertEqual(png_pixels(self.folder / "a.png"), png_pixels(self.folder / "b.png"))

    def test_negative_numbers_are_values_not_options(self):
        self.succeeds(*SPHERES, *TINY, "-o", "a.png", "--eye", "-3,2,-3", "--target", "-0.1,0,0", "--exposure", "-1")
        self.succeeds(*SPHERES, *TINY, "-o", "b.png", "--orbit", "-30,-10")

    def test_exr_says_how_it_was_made(self):
        self.succeeds(*SPHERES, *TINY, "-o", "a.exr", "--seed", "7", "--env", "sky", "--aov", "albedo,depth")
        info = json.loads(self.succeeds("info", "a.exr", "--json").out)
        self.assertEqual((info["width"], info["height"], info["format"]), (16, 12, "OpenEXR"))
        self.assertEqual(info["layers"], ["albedo", "depth"])
        self.assertEqual(info["metadata"]["scene"], "demo:spheres")
        self.assertEqual(info["metadata"]["seed"], "7")
        self.assertEqual(float(info["metadata"]["samples"]), 2.0)
        self.assertEqual(info["metadata"]["integrator"], "full")
        self.assertIn("sky", info["metadata"]["environment"])
        self.assertRegex(info["metadata"]["version"], r"\d+\.\d+\.\d+")
        self.assertIn("camera", info["metadata"])
        self.assertGreater(info["luminance"]["mean"], 0.0)

    def test_furnace_is_one_everywhere(self):
        self.succeeds("render", "demo:furnace", *TINY, "--env", "furnace", "-o", "a.exr")
        light = json.loads(self.succeeds("info", "a.exr", "--json").out)["luminance"]
        self.assertLess(light["max"], 1.01)
        self.assertGreater(light["max"], 0.99)

    def test_file_cameras_by_index_and_name(self):
        (self.folder / "a.glb").write_bytes(triangle_glb())

        def picture(name, *options):
            self.succeeds("render", "a.glb", *TINY, "-o", name, *options)
            return png_pixels(self.folder / name)

        near, far = picture("0.png", "--camera", "0"), picture("1.png", "--camera", "1")
        self.assertNotEqual(near, far)
        self.assertEqual(picture("default.png"), near)
        self.assertEqual(picture("near.png", "--camera", "near"), near)
        self.assertEqual(picture("far.png", "--camera", "far"), far)
        self.assertNotEqual(picture("wide.png", "--camera", "near", "--fov", "90deg"), near)
        self.fails("render", "a.glb", *TINY, "-o", "2.png", "--camera", "nobody", says="nobody")

    def test_variant_changes_the_material(self):
        (self.folder / "a.gltf").write_text(variants_gltf())
        centre = {}
        for name, option in {"": (), "noon": ("--variant", "noon"), "sunset": ("--variant", "sunset")}.items():
            self.succeeds("render", "a.gltf", *TINY, "-o", "a.png", "--env", "none", "--eye", "0,0,4", "--target", "0,0,0",
                          "--exposure", "0", *option)  # fmt: skip
            _, _, channels, rows = png_pixels(self.folder / "a.png")
            centre[name] = rows[6][8 * channels : 8 * channels + 3]
        self.assertGreater(centre[""][1], centre[""][0] + 50)
        self.assertEqual(centre["noon"], centre[""])
        self.assertGreater(centre["sunset"][0], centre["sunset"][1] + 50)

    def test_variants_of_a_real_model_differ(self):
        shoe = self.assets() / "models" / "MaterialsVariantsShoe" / "glTF" / "MaterialsVariantsShoe.gltf"
        if not shoe.exists():
            self.skipTest(f"{shoe.name} is absent")
        seen = set()
        for name in ("midnight", "beach", "street"):
            self.succeeds("render", shoe, *TINY, "-o", "a.png", "--variant", name)
            seen.add((self.folder / "a.png").read_bytes())
        self.assertEqual(len(seen), 3)

    def test_environment_file_lights_the_scene(self):
        red = bytes([128, 0, 0, 129])  # RGBE: 1, 0, 0
        (self.folder / "red.hdr").write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n" + red * 8)
        self.succeeds(*SPHERES, *TINY, "-o", "a.png", "--env", "red.hdr", "--tonemap", "linear")
        _, _, _, rows = png_pixels(self.folder / "a.png")
        pixels = [row[i : i + 3] for row in rows for i in range(0, len(row), 3)]
        self.assertGreater(max(r for r, _, _ in pixels), 32)
        self.assertLess(max(max(g, b) for _, g, b in pixels), 4)


class Statistics(CliTest):
    def check(self, stats):
        for field in ("load_s", "build_s", "render_s", "write_s", "total_s", "cpu_s", "msamples_per_s"):
            self.assertGreaterEqual(stats[field], 0.0, field)
        self.assertGreaterEqual(stats["total_s"], stats["load_s"] + stats["render_s"] + stats["write_s"])
        self.assertEqual((stats["width"], stats["height"], stats["spp"]), (16, 12, 2))
        self.assertEqual(stats["scene"], "demo:spheres")
        self.assertEqual(stats["samples"], 16 * 12 * 2)
        self.assertGreaterEqual(stats["rays"]["camera"], 16 * 12 * 2)  # and some pass through backs of surfaces
        self.assertGreater(stats["rays"]["bounce"] + stats["rays"]["shadow"], 0)
        self.assertEqual(stats["non_finite_samples"], 0)
        self.assertEqual(stats["threads"], 2)
        self.assertGreater(stats["triangles"], 0)
        self.assertGreaterEqual(stats["instances"], 0)
        self.assertGreater(stats["peak_rss_mb"], 1.0)
        self.assertEqual(stats["warnings"], [])
        self.assertRegex(stats["version"], r"\d+\.\d+\.\d+")

    def test_stats_file_has_every_field(self):
        self.succeeds(*SPHERES, *TINY, "-o", "a.png", "--stats", "s.json")
        self.check(json.loads((self.folder / "s.json").read_text()))
        self.assertEqual(self.files(), ["a.png", "s.json"])

    def test_stats_to_standard_output(self):
        self.check(json.loads(self.succeeds(*SPHERES, *TINY, "-o", "a.png", "--stats", "-").out))

    def test_stats_to_a_full_device(self):
        with open("/dev/full", "wb") as full:
            result = self.run_candela(*SPHERES, *TINY, "-o", "a.png", "--stats", "-", "--quiet", stdout=full)
        self.assertEqual(result.code, 1)
        self.assertIn("standard output", result.err)

    def test_denoise_smooths_and_keeps_the_plain_picture(self):
        self.succeeds(*SPHERES, *TINY, "-o", "plain.exr", "--seed", "3")
        self.succeeds(*SPHERES, *TINY, "-o", "a.exr", "--seed", "3", "--denoise", "--stats", "s.json")
        data = (self.folder / "a.exr").read_bytes()
        self.assertIn(b"noisy.G\0", data)
        self.assertIn(b"denoiser\0", data)
        self.assertNotIn(b"noisy.G\0", (self.folder / "plain.exr").read_bytes())
        self.assertGreater(json.loads((self.folder / "s.json").read_text())["denoise_s"], 0.0)

    def test_denoise_gives_the_same_bytes_on_any_number_of_threads(self):
        for threads in ("1", "2"):
            self.succeeds(*SPHERES, "--size", "40x30", "--spp", "4", "-o", f"{threads}.exr", "--denoise",
                          "--threads", threads)  # fmt: skip
        self.assertEqual((self.folder / "1.exr").read_bytes(), (self.folder / "2.exr").read_bytes())

    def test_open_image_denoise_that_is_not_there_is_replaced_with_a_warning(self):
        done = self.succeeds(*SPHERES, *TINY, "-o", "a.png", "--denoise=oidn")
        if "Open Image Denoise" in done.err:
            self.assertIn("the built-in regression denoises", done.err)
            self.fails(*SPHERES, *TINY, "-o", "b.png", "--denoise=oidn", "--strict", says="Open Image Denoise")

    def test_a_library_of_that_name_that_is_another_is_replaced_with_a_warning(self):
        with open("/proc/self/maps", encoding="utf-8") as maps:
            others = [line.split()[-1] for line in maps if re.search(r"/libc\.so|/libc-", line)]
        if not others:
            self.skipTest("no library to take for it")
        (self.folder / "lib").mkdir()
        name = self.folder / "lib/libOpenImageDenoise.so.2"
        name.symlink_to(others[0])
        environment = {**os.environ, "LD_LIBRARY_PATH": str(name.parent)}
        done = self.run_candela(*SPHERES, *TINY, "-o", "a.png", "--denoise=oidn", env=environment)
        self.assertEqual(done.code, 0, done.err)
        self.assertIn("has no function oidnNewDevice; the built-in regression denoises", done.err)
        name.unlink()
        name.write_text("no library\n")
        done = self.run_candela(*SPHERES, *TINY, "-o", "b.png", "--denoise=oidn", env=environment)
        self.assertEqual(done.code, 0, done.err)
        self.assertIn("the built-in regression denoises", done.err)

    def test_one_pixel_and_a_transparent_background_are_denoised(self):
        self.succeeds(*SPHERES, "--size", "1x1", "--spp", "2", "-o", "one.png", "--denoise")
        for name, more in (("a.png", ()), ("b.png", ("--denoise",))):
            self.succeeds(*SPHERES, *TINY, "-o", name, "--background", "transparent", "--orbit", "0,60,3", *more)
        alpha = lambda name: [row[3::4] for row in png_pixels(self.folder / name)[3]]
        self.assertEqual(alpha("a.png"), alpha("b.png"))

    def test_denoise_is_refused_where_it_cannot_act(self):
        for options, why in (
            (("--denoise=median",), 'unknown way to denoise "median"'),
            (("--denoise", "--integrator", "minimal"), "--denoise: only for --integrator full"),
            (("--denoise", "--engine", "raster"), "only for --engine path"),
        ):
            self.refuses(*SPHERES, *TINY, "-o", "a.png", *options, says=why)

    def spp(self, *options):
        self.succeeds(*SPHERES, *TINY[:2], *options, "-o", "a.exr", "--stats", "s.json")
        stats = json.loads((self.folder / "s.json").read_text())
        return stats.get("spp", stats.get("frames")), b"denoiser\0" in (self.folder / "a.exr").read_bytes()

    def test_a_quality_is_samples_noise_and_denoising(self):
        self.assertEqual(TINY[0], "--size")
        self.assertEqual(self.spp("--quality", "draft"), (16, True))
        good, denoised = self.spp("--quality", "good")
        self.assertTrue(16 <= good <= 256 and denoised, good)
        final, denoised = self.spp("--quality", "final", "--time", "20s")
        self.assertTrue(good < final <= 4096 and denoised, (good, final))

    def test_what_is_given_goes_before_the_quality(self):
        self.assertEqual(self.spp("--quality", "final", "--spp", "3"), (3, True))
        self.assertEqual(self.spp("--quality", "draft", "--denoise=none"), (16, False))
        self.assertEqual(self.spp("--quality", "good", "--noise", "0.9")[0], 16)
        self.assertEqual(self.spp("--quality", "draft", "--integrator", "minimal", "--denoise=none"), (16, False))

    def test_a_quality_that_cannot_be_had_is_refused(self):
        self.refuses(*SPHERES, "--quality", "draft", "--integrator", "minimal", says="--quality: .*--integrator full")
        self.refuses(*SPHERES, "--quality", "best", says="--quality: unknown quality.*draft, good, final")

    def test_a_quality_is_of_all_pictures_of_a_set(self):
        self.succeeds(*SPHERES, *TINY[:2], "--quality", "draft", "--turntable", "2", "-o", "%d.exr")
        for name in ("0.exr", "1.exr"):
            self.assertIn(b"denoiser\0", (self.folder / name).read_bytes())
        self.succeeds(*SPHERES, "demo:cornell", *TINY[:2], "--quality", "draft", "-o", "out/")

    def test_clamp_changes_the_picture_only_where_it_is_asked_for(self):
        for name, options in (("plain", ()), ("high", ("--clamp", "1e9")), ("low", ("--clamp", "0.01"))):
            self.succeeds("render", "demo:cornell", *TINY, "-o", f"{name}.exr", *options)
        plain = (self.folder / "plain.exr").read_bytes()
        self.assertEqual(plain, (self.folder / "high.exr").read_bytes())
        self.assertNotEqual(plain, (self.folder / "low.exr").read_bytes())

    def test_clamp_is_refused_where_it_cannot_act(self):
        for options, why in (
            (("--clamp", "0"), "--clamp"),
            (("--clamp", "nan"), "--clamp"),
            (("--clamp", "1", "--integrator", "minimal"), "--clamp: only for --integrator full"),
            (("--clamp", "1", "--engine", "raster"), "--clamp: only for --engine path"),
        ):
            self.refuses("render", "demo:cornell", *TINY, "-o", "a.png", *options, says=why)

    def test_noise_stop_takes_fewer_samples(self):
        self.succeeds(*SPHERES, "--size", "16x12", "--spp", "256", "--noise", "0.5", "-o", "a.png", "--stats", "s.json")
        self.assertLess(json.loads((self.folder / "s.json").read_text())["spp"], 256)

    def test_time_stop_ends_in_time(self):
        start = time.monotonic()
        self.succeeds(*SPHERES, "--size", "64x48", "--time", "500ms", "-o", "a.png", "--stats", "s.json")
        self.assertLess(time.monotonic() - start, 30.0)  # without the stop: 65536 samples, minutes
        self.assertLess(json.loads((self.folder / "s.json").read_text())["spp"], 65536)


class Messages(CliTest):
    def test_quiet_says_nothing(self):
        result = self.succeeds(*SPHERES, *TINY, "-o", "a.png", "-o", "b.exr", "--exposure", "1", "--quiet")
        self.assertEqual((result.out, result.err), ("", ""))

    def test_plain_progress_has_a_final_line_and_no_control_characters(self):
        result = self.succeeds(*SPHERES, *TINY, "-o", "a.png")
        self.assertEqual(result.out, "")
        self.assertNotIn("\r", result.err)
        self.assertNotIn("\x1b", result.err)
        self.assertRegex(result.err.splitlines()[-1], r"a\.png: 16x12, 2 samples per pixel")

    def test_terminal_gets_a_live_bar(self):
        try:
            master, slave = pty.openpty()
        except OSError as error:
            self.skipTest(f"no terminals here: {error}")
        process = candela.subprocess.Popen(
            [candela.PROGRAM, *SPHERES, "--size", "64x48", "--time", "1s", "-o", "a.png"],
            cwd=self.folder, stderr=slave, env={**os.environ, "TERM": "xterm"})  # fmt: skip
        os.close(slave)
        seen = b""
        while True:
            try:
                block = os.read(master, 4096)
            except OSError:  # Linux says so when the other end is closed
                break
            if not block:
                break
            seen += block
        os.close(master)
        self.assertEqual(process.wait(), 0)
        self.assertRegex(seen.decode(), r"\r\[[#.]+\] +\d+ %  \d+ spp  [\d.]+ Msamples/s")
        self.assertRegex(seen.decode().split("\r\x1b[K")[-1], r"^a\.png: 64x48")

    def test_warnings_and_strict(self):
        options = (*SPHERES, *TINY, "-o", "a.exr", "--exposure", "1")
        result = self.succeeds(*options)
        self.assertRegex(result.err, r"(?m)^warning: a\.exr: .*no effect")
        (self.folder / "a.exr").unlink()
        self.fails(*options, "--quiet", "--strict", says="no effect.*--strict")


class Interruption(CliTest):
    LONG = (*SPHERES, "--size", "64x48", "--spp", "1000000", "--threads", "2")

    def wait_for_start(self, process):
        """Until the handler stands, which the program's own signal mask shows."""
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline and process.poll() is None:
            with open(f"/proc/{process.pid}/status", encoding="ascii") as status:
                caught = int(re.search(r"SigCgt:\s*(\w+)", status.read()).group(1), 16)
            if caught & (1 << (signal.SIGINT - 1)):
                time.sleep(1.0)  # and some samples are there
                return
            time.sleep(0.02)
        self.fail("rendering did not start: " + process.communicate()[1].decode())

    def test_first_signal_writes_what_is_done(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            with self.subTest(signal=number):
                process = self.start_candela(*self.LONG, "-o", "a.png", "--stats", "s.json")
                self.wait_for_start(process)
                process.send_signal(number)
                _, err = process.communicate(timeout=60)
                self.assertEqual(process.returncode, 0, err)
                self.assertIn("interrupted", err.decode())
                png_pixels(self.folder / "a.png")
                stats = json.loads((self.folder / "s.json").read_text())
                self.assertTrue(stats["interrupted"])
                self.assertLess(stats["spp"], 1000000)
                self.assertEqual(self.files(), ["a.png", "s.json"])

    def test_long_render_refreshes_its_file(self):
        process = self.start_candela(*self.LONG, "-o", "a.png")
        deadline = time.monotonic() + 60
        while not (self.folder / "a.png").exists() and time.monotonic() < deadline:
            self.assertIsNone(process.poll())
            time.sleep(0.1)
        png_pixels(self.folder / "a.png")  # whole, while the render goes on
        self.assertIsNone(process.poll())


class BadInput(CliTest):
    def test_missing_scene(self):
        self.fails("render", "nowhere.glb", "-o", "a.png", says=r"nowhere\.glb: no such file")

    def test_folder_for_a_scene(self):
        (self.folder / "folder.glb").mkdir()
        self.fails("render", "folder.glb", "-o", "a.png", says="folder.glb")

    def test_unknown_demo(self):
        self.fails("render", "demo:teapot", "-o", "a.png", says="teapot")
        self.fails("render", "demo:", says="built-in scene")

    def test_damaged_scenes(self):
        damaged = {
            "empty.glb": b"",
            "text.gltf": b"this is no JSON",
            "array.gltf": b"[]",
            "version.gltf": b'{"asset":{"version":"1.0"}}',
            "short.glb": b"glTF\x02\x00\x00\x00\xff\xff\xff\x7f",
            "header.glb": b"glTF\x02\x00",
        }
        for name, content in damaged.items():
            with self.subTest(name=name):
                (self.folder / name).write_bytes(content)
                self.fails("render", name, "-o", "a.png", says=re.escape(name))

    def test_truncated_glb_at_many_places(self):
        whole = triangle_glb()
        (self.folder / "whole.glb").write_bytes(whole)
        self.succeeds("render", "whole.glb", *TINY, "-o", "whole.png")
        for count in range(0, len(whole) - 1, max(1, len(whole) // 24)):
            with self.subTest(bytes=count):
                (self.folder / "cut.glb").write_bytes(whole[:count])
                self.fails("render", "cut.glb", "-o", "a.png", says="cut.glb")

    def test_environment_that_is_no_image(self):
        (self.folder / "env.hdr").write_bytes(b"no image at all")
        self.fails(*SPHERES, *TINY, "--env", "env.hdr", "-o", "a.png", says="env.hdr")
        self.fails(*SPHERES, *TINY, "--env", "absent.exr", "-o", "a.png", says="absent.exr")

    def test_planes_of_the_files_camera_and_no_clip(self):
        """The triangle is 3 m before the camera: planes that leave it out show nothing, and that is known."""
        (self.folder / "whole.glb").write_bytes(triangle_glb())
        self.succeeds("render", "whole.glb", *TINY, "-o", "whole.png")
        whole = png_pixels(self.folder / "whole.png")
        for planes in ({"zfar": 2}, {"znear": 4}):
            (self.folder / "a.glb").write_bytes(triangle_glb(planes=planes))
            self.succeeds("render", "a.glb", *TINY, "-o", "all.png", "--no-clip")
            self.assertEqual(png_pixels(self.folder / "all.png"), whole)
            for engine in ("path", "raster"):
                told = self.run_candela("render", "a.glb", *TINY, "-o", "b.png", "--camera", "0", "--engine", engine)
                self.assertEqual(told.code, 0, told.err)
                self.assertRegex(told.err, "camera 0 sees nothing")
                told = self.run_candela("render", "a.glb", *TINY, "-o", "c.png", "--engine", engine)
                self.assertEqual(told.code, 0, told.err)
                self.assertRegex(told.err, "the whole scene is framed instead")

    def test_unknown_camera(self):
        self.fails(*SPHERES, *TINY, "--camera", "nobody", "-o", "a.png", says="nobody|camera")
        self.fails(*SPHERES, *TINY, "--camera", "999", "-o", "a.png", says="999|camera")

    def test_unknown_variant(self):
        (self.folder / "a.gltf").write_text(variants_gltf())
        self.fails("render", "a.gltf", *TINY, "-o", "a.png", "--variant", "dusk", says="'dusk'.*: noon, sunset")
        self.fails(*SPHERES, *TINY, "-o", "a.png", "--variant", "noon", says="demo:spheres: .*no variants")

    def test_camera_inside_its_target(self):
        self.fails(*SPHERES, *TINY, "--eye", "1,2,3", "--target", "1,2,3", "-o", "a.png", says="--eye")

    def test_lens_options_without_an_aperture(self):
        self.fails(*SPHERES, *TINY, "--blades", "6", "-o", "a.png", says="--blades")
        self.fails(*SPHERES, *TINY, "--focus-distance", "2", "-o", "a.png", says="--focus-distance")

    def test_output_is_judged_before_the_work(self):
        """A missing scene would be found first if the output were looked at last."""
        (self.folder / "folder.png").mkdir()
        for output, says in {
            "/proc/nowhere/a.png": "cannot make its folder|absent.glb",
            "/proc/a.png": "cannot write|does not exist|not permitted",
            "folder.png": "folder.png",
        }.items():
            with self.subTest(output=output):
                self.fails("render", "absent.glb", "-o", output, says=says)
                self.fails("render", "absent.glb", "-o", "good.png", "--stats", output.replace(".png", ".json"),
                           says="absent.glb" if output == "folder.png" else says)  # fmt: skip

    def test_picture_beyond_the_memory_is_refused_before_the_work(self):
        def limited():
            resource.setrlimit(resource.RLIMIT_AS, (2 << 30, 2 << 30))

        if self.run_candela("--version", preexec_fn=limited).code != 0:
            self.skipTest("sanitizers need more room than the limit leaves")
        self.succeeds(*SPHERES, *TINY, "-o", "small.png", preexec_fn=limited)
        # A missing scene would be found first if memory were looked at later.
        self.fails("render", "absent.glb", "--size", "16384x16384", "-o", "a.png", preexec_fn=limited,
                   says=r"--size: a picture of 16384x16384 needs about \d+\.\d\d GiB .* 1\.\d\d GiB are available")  # fmt: skip

    def test_devices_are_not_replaced_by_files(self):
        result = self.run_candela(*SPHERES, *TINY, "-o", "a.png", "--stats", "/dev/full", "--quiet")
        self.assertEqual((result.code, result.err.count("\n")), (1, 1), result.err)
        self.assertRegex(result.err, "/dev/full: cannot write")
        self.assertTrue(pathlib.Path("/dev/full").is_char_device())

    def test_picture_into_a_pipe(self):
        os.mkfifo(self.folder / "pipe.png")
        process = self.start_candela(*SPHERES, *TINY, "-o", "pipe.png")
        content = (self.folder / "pipe.png").read_bytes()
        self.assertEqual(process.wait(60), 0)
        (self.folder / "copy.png").write_bytes(content)
        self.assertEqual(png_pixels(self.folder / "copy.png")[:2], (16, 12))
        self.assertTrue((self.folder / "pipe.png").is_fifo())

    def test_name_that_is_too_long(self):
        self.fails(*SPHERES, *TINY, "-o", "a" * 300 + ".png", says="too long")

    def test_link_stays_a_link(self):
        (self.folder / "real.png").write_bytes(b"older")
        (self.folder / "link.png").symlink_to("real.png")
        self.succeeds(*SPHERES, *TINY, "-o", "link.png")
        self.assertTrue((self.folder / "link.png").is_symlink())
        png_pixels(self.folder / "real.png")

    def test_inputs_are_not_overwritten(self):
        self.succeeds(*SPHERES, "--size", "16x8", "--spp", "2", "-o", "env.exr", "--quiet")
        before = (self.folder / "env.exr").read_bytes()
        self.fails(*SPHERES, *TINY, "--env", "env.exr", "-o", "./env.exr", says="input")
        self.assertEqual((self.folder / "env.exr").read_bytes(), before)

    def test_failure_keeps_an_older_picture(self):
        (self.folder / "a.png").write_bytes(b"older")
        self.fails("render", "nowhere.glb", "-o", "a.png", says="no such file")
        self.assertEqual((self.folder / "a.png").read_bytes(), b"older")

    def test_unwritable_folder(self):
        if os.geteuid() == 0:
            self.skipTest("root may write everywhere")
        (self.folder / "locked").mkdir(mode=0o500)
        self.fails(*SPHERES, *TINY, "-o", "locked/a.png", says="cannot write")


if __name__ == "__main__":
    candela.main()
