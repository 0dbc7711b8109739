#!/usr/bin/env python3
"""`candela view`, without a display and, where Xvfb is installed, with one."""

import os
import shutil
import subprocess
import time
import unittest

import candela
from candela import CliTest

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
        self.server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "160x120x24"], pass_fds=[write],
                                       stderr=subprocess.DEVNULL)  # fmt: skip
        os.close(write)
        self.addCleanup(self.server.wait)
        self.addCleanup(self.server.terminate)
        with os.fdopen(read) as numbers:
            self.display = numbers.readline().strip()
        self.environment = {**WITHOUT, "DISPLAY": f":{self.display}", "LIBGL_ALWAYS_SOFTWARE": "1",
                            "XDG_CACHE_HOME": str(self.folder / "cache")}  # fmt: skip

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


if __name__ == "__main__":
    candela.main()
