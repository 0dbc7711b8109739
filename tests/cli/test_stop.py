#!/usr/bin/env python3
"""Ctrl-C and SIGTERM: what is there is kept, and the exit code tells whether something is missing."""

import json
import re
import signal
import subprocess
import time

import candela
from candela import PROGRAM, CliTest, png_pixels, triangle_glb
from test_raster import RasterTest

SIGNALS = (signal.SIGINT, signal.SIGTERM)
INTERRUPTED = 130


class StopTest:
    def started(self, *arguments):
        return subprocess.Popen([PROGRAM, *map(str, arguments)], cwd=self.folder, stdin=subprocess.DEVNULL,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                env=getattr(self, "environment", None))  # fmt: skip

    def wait_until(self, process, is_so):
        deadline = time.monotonic() + 120
        while not is_so():
            self.assertIsNone(process.poll(), "ended before it could be stopped")
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.02)

    def catches(self, process):
        with open(f"/proc/{process.pid}/status", encoding="ascii") as status:
            caught = int(re.search(r"SigCgt:\s*(\w+)", status.read()).group(1), 16)
        return bool(caught & (1 << (signal.SIGINT - 1)))

    def stopped(self, *arguments, when=None, number=signal.SIGINT, after=0.5):
        """Starts, waits until `when` (else until signals are caught, and a little), sends one, and has the result."""
        process = self.started(*arguments)
        self.addCleanup(self.end, process)
        self.wait_until(process, when or (lambda: self.catches(process)))
        time.sleep(after)
        process.send_signal(number)
        out, err = process.communicate(timeout=240)
        return candela.Result(process.returncode, out.decode(), err.decode())


class Raster(StopTest, RasterTest):
    LONG = ("render", "demo:spheres", "--engine", "raster", "--size", "32x24")

    def test_a_still_keeps_the_mean_of_its_frames(self):
        self.draws(*self.LONG, "--spp", "1", "--exposure", "0", "-o", "one.png")
        level = lambda name: sum(b"".join(png_pixels(self.folder / name)[3]))
        for number in SIGNALS:
            with self.subTest(signal=number):
                done = self.stopped(*self.LONG, "--spp", "1000000", "--exposure", "0", "-o", "a.png", "--stats", "s.json",
                                    number=number, after=2)  # fmt: skip
                self.assertEqual(done.code, 0, done.err)
                self.assertIn("interrupted, a.png", done.err)
                stats = json.loads((self.folder / "s.json").read_text())
                self.assertTrue(stats["interrupted"])
                self.assertTrue(0 < stats["frames"] < 1000000)
                # As bright as a picture that is whole: the mean of what was drawn, not its share.
                self.assertAlmostEqual(level("a.png") / level("one.png"), 1, delta=0.02)

    def test_a_turntable_says_that_pictures_are_missing(self):
        done = self.stopped(*self.LONG, "--turntable", "500", "--spp", "64", "-o", "%d.png", "--stats", "s.json",
                            when=lambda: (self.folder / "1.png").exists(), after=0)  # fmt: skip
        self.assertEqual(done.code, INTERRUPTED, done.err)
        self.assertRegex(done.err, r"(?m)^candela: interrupted: \d+ of 500 pictures are there")
        self.assertTrue(json.loads((self.folder / "s.json").read_text())["interrupted"])
        for name in self.files():
            if name.endswith(".png"):
                png_pixels(self.folder / name)

    def test_a_batch_says_that_pictures_are_missing(self):
        scenes = [f"{i}.glb" for i in range(300)]
        for name in scenes:
            (self.folder / name).write_bytes(triangle_glb())
        done = self.stopped("render", *scenes, "-o", "out/", "--engine", "raster", "--size", "32x24", "--spp", "64",
                            when=lambda: (self.folder / "out/0.png").exists(), after=0)  # fmt: skip
        self.assertEqual(done.code, INTERRUPTED, done.err)
        self.assertRegex(done.err, r"(?m)^candela: interrupted: \d+ of 300 pictures are there")

    def test_probes_can_be_stopped(self):
        done = self.stopped(*self.LONG, "--probes", "64", "-o", "a.png", after=0.2)
        self.assertIn(done.code, (INTERRUPTED, 0), done.err)
        self.assertEqual((self.folder / "a.png").exists(), done.code == 0)

    def test_frames_are_shown_on_a_terminal(self):
        code, seen = self.on_terminal(*self.LONG, "--turntable", "2", "--spp", "8", "-o", "%d.png", environment=self.environment)
        self.assertEqual(code, 0)
        self.assertRegex(seen, r"\r\[[#.]+\] +\d+ %  picture \d of 2, frame \d of 8")


class Path(StopTest, CliTest):
    def test_a_turntable_keeps_the_picture_at_hand_and_says_that_others_are_missing(self):
        for number in SIGNALS:
            with self.subTest(signal=number):
                done = self.stopped("render", "demo:spheres", "--size", "32x24", "--spp", "100000", "--turntable", "3",
                                    "-o", "%d.png", "--stats", "s.json", "--threads", "2", number=number, after=1)  # fmt: skip
                self.assertEqual(done.code, INTERRUPTED, done.err)
                self.assertIn("1 of 3 pictures are there, the last one unfinished", done.err)
                self.assertEqual(self.files(), ["0.png", "s.json"])
                png_pixels(self.folder / "0.png")
                self.assertTrue(json.loads((self.folder / "s.json").read_text())["interrupted"])

    def test_a_film_counts_the_pictures_that_it_holds(self):
        # It is stopped in the middle of the second.
        for outputs, counted in ((("-o", "a.webp"), "interrupted: 1 of 3 pictures are there$"),
                                 (("-o", "a.webp", "-o", "%d.png"), "interrupted: 2 of 3 pictures are there, the last one unfinished")):  # fmt: skip
            with self.subTest(outputs=outputs):
                done = self.stopped("render", "demo:spheres", "--size", "32x24", "--time", "4s", "--turntable", "3", *outputs,
                                    "--threads", "2", after=6)  # fmt: skip
                self.assertEqual(done.code, INTERRUPTED, done.err)
                self.assertRegex(done.err, r"(?m)^a\.webp: 1 picture of 32x24")
                self.assertRegex(done.err, "(?m)" + counted)

    def test_a_batch_is_not_done_when_it_is_stopped(self):
        done = self.stopped("render", "demo:spheres", "demo:cornell", "-o", "out/", "--size", "32x24",
                            "--spp", "100000", "--threads", "2", after=1)  # fmt: skip
        self.assertEqual(done.code, INTERRUPTED, done.err)
        self.assertIn("1 of 2 pictures are there, the last one unfinished", done.err)

    def test_one_scene_into_a_folder_is_one_picture(self):
        done = self.stopped("render", "demo:spheres", "-o", "out/", "--size", "32x24", "--spp", "100000", after=1)
        self.assertEqual(done.code, 0, done.err)
        png_pixels(self.folder / "out/spheres.png")

    def test_a_noise_target_that_was_not_reached_is_said(self):
        balls = ("render", "demo:spheres", "--size", "32x24", "-o", "a.png", "--stats", "s.json", "--noise", "0.0001")
        limits = {"samples": ("--spp", "4"), "time": ("--time", "300ms")}
        for why, limit in limits.items():
            with self.subTest(limit=limit):
                said = self.succeeds(*balls, *limit).err
                self.assertRegex(said, r"warning: .*noise target 0\.0001 was not reached in \d+ % of the pixels, the worst")
                self.assertRegex(said, r"stopped by .*(--spp|--time)")
                noise = json.loads((self.folder / "s.json").read_text())["noise"]
                self.assertEqual((noise["reached"], noise["stopped_by"]), (False, why))
                self.assertGreater(noise["share_above"], 0.5)
                self.assertGreater(noise["worst"], 1e-4)
                self.assertEqual(self.run_candela(*balls, *limit, "--strict").code, 1)
        one = self.succeeds(*balls, "--spp", "1").err
        self.assertIn("not reached in 100 % of the pixels, the worst of which is unknown", one)
        # Reached, it is not mentioned.
        good = self.succeeds(*balls[:-1], "0.9", "--spp", "4096")
        self.assertNotIn("noise", good.err)
        noise = json.loads((self.folder / "s.json").read_text())["noise"]
        self.assertEqual((noise["reached"], noise["share_above"]), (True, 0))
        self.assertLess(noise["worst"], 0.9)
        self.succeeds("render", "demo:spheres", "--size", "8x8", "--spp", "1", "-o", "a.png", "--stats", "s.json")
        self.assertIsNone(json.loads((self.folder / "s.json").read_text())["noise"])


class Others(StopTest, CliTest):
    def test_furnace_tells_what_it_has_measured(self):
        for number in SIGNALS:
            with self.subTest(signal=number):
                done = self.stopped("furnace", "--all", "--json", "-o", "sheet.png", number=number)
                self.assertEqual(done.code, INTERRUPTED, done.err)
                report = json.loads(done.out)
                self.assertTrue(report["interrupted"])
                self.assertTrue(all(row["kept"] for row in report["laws"]))
                self.assertEqual(self.files(), [])

    def test_check_keeps_the_verdicts_so_far(self):
        (self.folder / "many").mkdir()
        for i in range(3000):
            (self.folder / f"many/{i}.glb").write_bytes(triangle_glb())
        done = self.stopped("check", "many", "--json", after=0.1)
        self.assertEqual(done.code, INTERRUPTED, done.err)
        report = json.loads(done.out)
        self.assertLess(len(report["assets"]), 3000)
        self.assertEqual(report["summary"]["files"] + report["summary"]["not_judged"], 3000)
        self.assertRegex(done.err, r"candela: interrupted: \d+ of 3000 files are judged")
        done = self.stopped("check", "many", after=0.1)
        self.assertEqual(done.code, INTERRUPTED, done.err)
        self.assertRegex(done.out, r"(?m)^interrupted: \d+ files?, \d+ clean")

    def test_bake_leaves_all_or_nothing(self):
        self.succeeds("bake", "sky", "-o", "out", "--size", "16", "--levels", "2", "--proof", "0")
        before = {p.name: p.read_bytes() for p in (self.folder / "out").iterdir()}
        slow = ("--method", "montecarlo", "--samples", "1000000", "--size", "256")
        for number, source in ((signal.SIGINT, ("sky", *slow)), (signal.SIGTERM, ("sky", *slow)),
                               (signal.SIGINT, ("--from-scene", "demo:cornell", "--at", "0,0,0", "--spp", "100000")),
                               (signal.SIGINT, ("sky", "--proof", "100000", "--size", "64"))):  # fmt: skip
            with self.subTest(signal=number, source=source):
                done = self.stopped("bake", *source, "-o", "out", "--report", "page.html", number=number)
                self.assertEqual(done.code, INTERRUPTED, done.err)
                self.assertIn("no file of it is written", done.err)
                self.assertEqual(self.files(), ["out"])
                self.assertEqual({p.name: p.read_bytes() for p in (self.folder / "out").iterdir()}, before)

    def test_help_tells_the_exit_codes(self):
        for verb in ((), ("render",)):
            self.assertRegex(self.succeeds(*verb, "--help").out, r"Exit codes: .*130")


if __name__ == "__main__":
    candela.main()
