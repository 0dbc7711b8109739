#!/usr/bin/env python3
"""`candela view`, without a display and, where Xvfb is installed, with one."""

import json
import os
import pathlib
import re
import shutil
import subprocess
import time
import unittest

import candela
from candela import CliTest, triangle_glb

WITHOUT = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}


class NoDisplay(CliTest):
    def test_it_is_told_with_what_needs_none(self):
        self.fails("view", "demo:spheres", says="no display.*render --engine raster needs no display", env=WITHOUT)

    def test_a_scene_that_cannot_be_read_is_told_first(self):
        self.fails("view", "nothing.glb", says="nothing.glb", env=WITHOUT)

    def test_wrong_usage(self):
        self.refuses("view", "demo:spheres", "--shaders", "nowhere", says="--shaders: is no folder")
        self.refuses("view", "demo:spheres", "--frames", "0", says="--frames")
        self.refuses("view", says="SCENE")

    def test_help_has_an_example(self):
        self.assertIn("candela view helmet.glb", self.succeeds("view", "--help").out)


@unittest.skipUnless(shutil.which("Xvfb"), "Xvfb is not installed")
class Display(CliTest):
    def setUp(self):
        super().setUp()
        # A display of its own: the first number that is free.
        read, write = os.pipe()
        self.server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "640x480x24"], pass_fds=[write],
                                       stderr=subprocess.DEVNULL)  # fmt: skip
        os.close(write)
        self.addCleanup(self.server.wait)
        self.addCleanup(self.server.terminate)
        with os.fdopen(read) as numbers:
            self.display = numbers.readline().strip()
        self.environment = {**WITHOUT, "DISPLAY": f":{self.display}", "LIBGL_ALWAYS_SOFTWARE": "1",
                            "XDG_CACHE_HOME": str(self.folder / "cache")}  # fmt: skip

    def play(self, *steps, scene="triangle.glb", options=(), size="320x240", code=0):
        """What `candela view` prints while it plays these steps: the states, and standard error."""
        if not (self.folder / "triangle.glb").exists():
            (self.folder / "triangle.glb").write_bytes(triangle_glb())
        (self.folder / "steps").write_text("\n".join(steps) + "\n")
        result = self.run_candela("view", scene, "--size", size, "--script", "steps", "--env", "furnace", *options,
                                  env=self.environment, timeout=600)  # fmt: skip
        self.assertEqual(result.code, code, result.err)
        return [json.loads(line) for line in result.out.splitlines()], result.err

    def test_frames_are_drawn_and_counted(self):
        result = self.succeeds("view", "demo:spheres", "--size", "64x48", "--frames", "3", env=self.environment)
        self.assertRegex(result.err, r"3 frames, [0-9.]+ ms each")

    def test_changed_shaders_are_read_again_and_mistakes_told_once(self):
        shaders = self.folder / "shaders"
        shutil.copytree(candela.ROOT / "src/raster/shaders", shaders)
        shutil.copytree(candela.ROOT / "src/shade", shaders / "shade", ignore=shutil.ignore_patterns("*.cpp", "*.txt"))
        log = open(self.folder / "log", "w+")
        self.addCleanup(log.close)
        viewer = subprocess.Popen([candela.PROGRAM, "view", "demo:spheres", "--size", "64x48", "--shaders", shaders],
                                  stderr=log, env=self.environment)  # fmt: skip
        self.addCleanup(viewer.wait)
        self.addCleanup(viewer.kill)

        def wait_for(text, times=1):
            for _ in range(300):
                log.seek(0)
                if log.read().count(text) >= times:
                    return
                self.assertIsNone(viewer.poll())
                time.sleep(0.1)
            self.fail(f"not told: {text}")

        wait_for("first picture")
        present = shaders / "present.frag.glsl"
        good = present.read_text()
        present.write_text(good + "mistake\n")
        wait_for("present.frag.glsl:")
        present.write_text(good)
        wait_for("shaders reloaded", 2)
        log.seek(0)
        self.assertEqual(log.read().count("the driver refuses"), 1)
        self.assertIsNone(viewer.poll())

    def test_the_window_is_there_before_the_model(self):
        (self.folder / "triangle.glb").write_bytes(triangle_glb())
        result = self.succeeds("view", "triangle.glb", "--size", "64x48", "--frames", "1", env=self.environment)
        times = [float(t) for t in re.findall(r"after ([0-9.]+) s", result.err)]
        self.assertRegex(result.err, r"(?s)window after.*first picture after.*in full light after")
        self.assertEqual(times, sorted(times))

    def test_closing_while_it_loads_ends_cleanly(self):
        for steps in (["close"], ["sleep 50ms", "close"], ["wait sketched", "close"], ["wait loaded", "close"]):
            self.play(*steps, scene="demo:spheres")

    def test_the_camera_turns_moves_comes_nearer_fits_and_goes_back(self):
        states, _ = self.play(
            "key tab", "wait drawn", "state",
            "drag 100,100 160,100", "state",
            "key R", "state",
            "drag 100,100 160,120 shift", "state",
            "key F", "state",
            "scroll 3 100,100", "state",
            "key R", "state", "close",
        )  # fmt: skip
        start, turned, back, moved, fitted, near, end = (
            (state["eye"], state["pivot"], sum((a - b) ** 2 for a, b in zip(state["eye"], state["pivot"])) ** 0.5)
            for state in states
        )
        self.assertNear(turned[1], start[1])
        self.assertAlmostEqual(turned[2], start[2], 4)
        self.assertLess(turned[0][0], start[0][0] - 0.1)  # to the right of the pointer is to the left of the eye
        self.assertEqual(back, start)
        self.assertAlmostEqual(moved[2], start[2], 4)
        self.assertGreater(abs(moved[1][0] - start[1][0]), 0.1)
        self.assertNear(fitted[1], [0, 1, 0])
        self.assertAlmostEqual(near[2], fitted[2] * 2 ** (-3 / 5), 4)
        self.assertEqual(end, start)

    def assertNear(self, got, wanted):
        for a, b in zip(got, wanted):
            self.assertAlmostEqual(a, b, 3)

    def test_control_and_drag_turns_the_environment_and_not_the_camera(self):
        (before, after), _ = self.play("wait drawn", "state", "drag 40,100 90,100 ctrl", "wait drawn", "state", "close",
                                       size="640x480")  # fmt: skip
        self.assertAlmostEqual(after["turned"], 0.4, 5)
        self.assertEqual(after["eye"], before["eye"])

    def test_a_saved_picture_has_the_size_that_was_asked_for_and_overwrites_nothing(self):
        (self.folder / "shot.png").write_text("mine")
        _, err = self.play("wait drawn", "save shot.png 50x30", "wait saved 1", "save shot.png 60x20", "wait saved 2",
                           "key S", "wait saved 3", "close")  # fmt: skip
        self.assertEqual((self.folder / "shot.png").read_text(), "mine")
        self.assertEqual(candela.png_pixels(self.folder / "shot-2.png")[:2], (50, 30))
        self.assertEqual(candela.png_pixels(self.folder / "shot-3.png")[:2], (60, 20))
        self.assertEqual(candela.png_pixels(self.folder / "triangle.png")[:2], (320, 240))

    def test_a_saved_picture_is_that_of_render(self):
        self.play("wait drawn", "save seen.png 160x120", "wait saved", "close", options=["--exposure", "0"])
        self.succeeds("render", "triangle.glb", "-o", "drawn.png", "--engine", "raster", "--size", "160x120", "--env", "furnace",
                      "--exposure", "0", "-q", env=self.environment)  # fmt: skip
        seen, drawn = (candela.png_pixels(self.folder / name) for name in ("seen.png", "drawn.png"))
        self.assertEqual(seen, drawn)

    def test_what_is_dropped_is_shown(self):
        (self.folder / "other.glb").write_bytes(triangle_glb(material={"emissiveFactor": [1, 0, 0]}))
        states, _ = self.play("wait drawn", "drop other.glb", "wait loaded 2", "wait drawn", "state", "close")
        self.assertEqual(states[0]["model"], "other.glb")

    def test_what_cannot_be_read_is_told_and_the_scene_stays(self):
        (self.folder / "broken.hdr").write_text("no picture")
        (self.folder / "broken.glb").write_text("no model")
        states, err = self.play(
            "wait drawn", "state",
            "drop broken.hdr", "wait failed 1", "sleep 300ms", "wait drawn", "state",
            "drop broken.glb", "wait failed 2", "sleep 300ms", "wait drawn", "state", "close",
        )  # fmt: skip
        before, light, model = states
        self.assertIn("broken.hdr", light["message"])
        self.assertIn("broken.glb", model["message"])
        for state in (light, model):
            self.assertEqual((state["model"], state["environment"]), (before["model"], before["environment"]))

    def test_a_model_that_is_written_again_is_read_again_and_a_broken_one_is_not_taken(self):
        path = self.folder / "watched.glb"
        path.write_bytes(triangle_glb())
        viewer = self.start_view("watched.glb", "--watch", "--script", "steps", steps=[
            "wait drawn", "state", "wait loaded 2", "wait drawn", "state", "wait failed 1", "wait drawn", "state", "close"])  # fmt: skip
        first = json.loads(viewer.stdout.readline())
        path.write_bytes(triangle_glb(material={"emissiveFactor": [1, 0, 0]}))
        second = json.loads(viewer.stdout.readline())
        path.write_text("half a fi")
        third = json.loads(viewer.stdout.readline())
        self.assertEqual((first["loads"], second["loads"], third["loads"]), (1, 2, 2))
        self.assertIn("watched.glb", third["message"])
        self.assertEqual(viewer.wait(60), 0)

    def start_view(self, *arguments, steps):
        (self.folder / "steps").write_text("\n".join(steps) + "\n")
        viewer = subprocess.Popen([candela.PROGRAM, "view", *arguments, "--size", "160x120"], cwd=self.folder, env=self.environment,
                                  stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)  # fmt: skip
        self.addCleanup(viewer.stdout.close)
        self.addCleanup(viewer.wait)
        self.addCleanup(viewer.kill)
        return viewer

    def test_variants_animations_quantities_and_help_by_keys(self):
        (self.folder / "variants.gltf").write_text(candela.variants_gltf())
        states, _ = self.play("wait drawn", "key V", "wait drawn", "state", "key shift+V", "key H", "state", "key escape", "state",
                              "key escape", scene="variants.gltf")  # fmt: skip
        self.assertEqual([state["quantity"] for state in states], ["albedo", "light", "light"])
        self.assertEqual([state["help"] for state in states], [False, True, False])

    def test_a_click_says_what_is_there(self):
        states, _ = self.play("key tab", "wait drawn", "click 160,120", "wait picked", "state", "click 2,2", "wait picked 2", "state",
                              "close")  # fmt: skip
        self.assertEqual([state["picked"]["node"] for state in states], [0, -1])
        self.assertEqual(states[0]["picked"]["pixel"], [160, 120])

    def test_a_click_explains_the_pixel(self):
        states, _ = self.play("key tab", "wait drawn", "click 160,120", "wait explained", "state", "click 2,2", "wait explained 2",
                              "state", "close")  # fmt: skip
        ball, sky = (state["explained"] for state in states)
        self.assertRegex(ball, r"(?m)^pixel +160,120 of 320x240$")
        for word in ("surface", "material", "albedo", "truth", "sources", "paths"):
            self.assertRegex(ball, rf"(?m)^{word} ")
        self.assertIn("sees the environment", sky)

    def test_the_traced_picture_converges_and_input_is_answered_meanwhile(self):
        states, _ = self.play("key tab", "wait drawn", "key T", "wait traced 4", "state", "drag 60,100 90,100", "state", "wait traced 2",
                              "state", "close", scene="demo:spheres", size="200x150")  # fmt: skip
        self.assertGreaterEqual(states[0]["samples"], 4)
        self.assertTrue(states[0]["split"])
        self.assertNotEqual(states[1]["eye"], states[0]["eye"])
        self.assertLess(states[1]["slowest_ms"], 1000)

    def test_findings_are_counted_and_marked(self):
        (self.folder / "dark.glb").write_bytes(triangle_glb(material={
            "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 1}}))  # fmt: skip
        states, _ = self.play("wait drawn", "key C", "wait judged", "state", "close", scene="dark.glb")
        self.assertGreater(states[0]["findings"], 0)
        self.assertGreater(states[0]["markers"], 0)

    def test_memory_stays_flat_over_repeated_loading(self):
        for name in ("a.glb", "b.glb"):
            (self.folder / name).write_bytes(triangle_glb())
        steps = []
        for i in range(60):
            steps += [f"drop {'ab'[i % 2]}.glb", f"wait loaded {i + 2}", f"size {200 + i % 3 * 20}x150", "wait drawn", "state"]
        viewer = self.start_view("a.glb", "--env", "furnace", "--script", "steps", steps=["wait drawn", *steps, "close"])
        sizes = []
        for _ in range(60):
            self.assertTrue(viewer.stdout.readline())
            status = pathlib.Path(f"/proc/{viewer.pid}/status").read_text()
            sizes.append(int(re.search(r"VmRSS:\s+([0-9]+)", status)[1]) / 1024)
        self.assertEqual(viewer.wait(60), 0)
        # The first loads fill caches and arenas.
        self.assertLess(max(sizes[40:]) - max(sizes[10:30]), 12.0, sizes)

    def test_a_script_that_cannot_be_played_is_told_with_its_line(self):
        (self.folder / "steps").write_text("# a remark\nkey F\ndance 3\n")
        self.fails("view", "demo:spheres", "--script", "steps", says="steps:3: unknown: dance", env=self.environment)
        self.fails("view", "demo:spheres", "--script", "nothing", says="nothing: cannot be read", env=self.environment)


if __name__ == "__main__":
    candela.main()
