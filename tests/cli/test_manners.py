#!/usr/bin/env python3
"""What people type first, and what they are told: folders that are made, formats, colours, sets of scenes, silence."""

import json
import pathlib
import shutil
import subprocess

import candela
from candela import CliTest, TINY, png_pixels, triangle_glb

SPHERES = ("render", "demo:spheres")


def webp_is_lossless(data):
    """RIFF, WEBP, and a chunk VP8L among its chunks."""
    assert data[:4] == b"RIFF" and data[8:12] == b"WEBP"
    return b"VP8L" in data[12:64]


class Folders(CliTest):
    def test_the_folder_of_a_picture_is_made(self):
        self.succeeds(*SPHERES, *TINY, "-o", "a/b/c.png", "--stats", "d/e.json")
        self.assertTrue((self.folder / "a/b/c.png").is_file())
        self.assertTrue((self.folder / "d/e.json").is_file())
        self.succeeds(*SPHERES, *TINY, "--turntable", "2", "-o", "frames/%03d.png")
        self.assertEqual(sorted(p.name for p in (self.folder / "frames").iterdir()), ["000.png", "001.png"])
        self.succeeds("diff", "frames/000.png", "frames/000.png", "-o", "diff/map.png", "-q")
        self.assertTrue((self.folder / "diff/map.png").is_file())

    def test_a_folder_is_not_left_behind_where_the_picture_fails(self):
        self.fails("render", "absent.glb", "-o", "a/b/c.png", says="absent.glb")
        (self.folder / "file").write_text("no folder")
        self.fails(*SPHERES, *TINY, "-o", "file/a.png", says="is not a folder")
        self.fails(*SPHERES, *TINY, "-o", "file/b/a.png", says="is not a folder")
        self.fails(*SPHERES, *TINY, "-o", "/proc/nowhere/a.png", says="/proc/nowhere/a.png: ")
        self.fails("render", "absent.glb", "-o", "folder/", says="absent.glb")
        self.fails(*SPHERES, *TINY, "-o", "file/b/", says="is not a folder")

    def test_no_folder_is_made_that_no_picture_lies_in(self):
        self.succeeds(*SPHERES, *TINY, "-o", "o{view}/", "--views", "front,left")
        self.assertEqual(self.files(), ["ofront", "oleft"])


class Pictures(CliTest):
    def test_a_webp_has_the_pixels_of_the_png_and_its_alpha(self):
        for more in ((), ("--background", "transparent")):
            self.succeeds(*SPHERES, *TINY, *more, "-o", "a.webp", "-o", "a.png")
            self.assertTrue(webp_is_lossless((self.folder / "a.webp").read_bytes()))
            done = self.succeeds("diff", "a.png", "a.webp", "--json")
            pair = json.loads(done.out)["pairs"][0]
            self.assertEqual(pair["flip"], 0)
            info = json.loads(self.succeeds("info", "a.webp", "--json").out)
            self.assertEqual(info["channels"], 4 if more else 3)
            self.assertNotIn("transparency", self.run_candela(*SPHERES, *TINY, *more, "-o", "a.webp").err)

    def test_a_webp_is_at_most_16383_pixels_wide(self):
        self.fails(*SPHERES, "--size", "16384x1", "--spp", "1", "-o", "a.webp", says="a.webp: a WebP has at most 16383")

    def pixel_of(self, *options):
        self.succeeds(*SPHERES, *TINY, "-o", "a.png", *options)
        _, _, channels, rows = png_pixels(self.folder / "a.png")
        return tuple(rows[0][:channels])

    def background(self, text):
        return self.pixel_of("--background", text)

    def test_colours_as_css_writes_them(self):
        self.assertEqual(self.background("#fff"), (255, 255, 255))
        self.assertEqual(self.background("#1a9"), (0x11, 0xAA, 0x99))
        self.assertEqual(self.background("#11AA99"), (0x11, 0xAA, 0x99))
        self.assertEqual(self.background("#11aa99ff"), (0x11, 0xAA, 0x99))
        self.assertEqual(self.background("#1a9f"), (0x11, 0xAA, 0x99))
        self.assertEqual(self.background("#11aa9980"), (0x11, 0xAA, 0x99, 0x80))
        self.assertEqual(self.background("#1a98"), (0x11, 0xAA, 0x99, 0x88))
        self.assertEqual(self.background("#11aa9900"), (0, 0, 0, 0))

    def test_colours_by_their_names_in_css(self):
        self.assertEqual(self.background("rebeccapurple"), (0x66, 0x33, 0x99))
        self.assertEqual(self.background("RebeccaPurple"), (0x66, 0x33, 0x99))
        self.assertEqual(self.background("grey"), (0x80, 0x80, 0x80))
        ground = self.pixel_of("--ground", "cornflowerblue")
        self.assertEqual(ground, (0x64, 0x95, 0xED))

    def test_a_colour_that_has_no_name_is_refused_with_the_nearest(self):
        self.refuses(*SPHERES, "--background", "rebecapurple", says="--background: 'rebecapurple'.*did you mean rebeccapurple")
        self.refuses(*SPHERES, "--ground", "whit", says="--ground: .*did you mean white")
        self.refuses(*SPHERES, "--background", "colourful", says="a name of CSS")

    def test_what_covers_a_half_transparent_background_is_opaque(self):
        self.succeeds(*SPHERES, *TINY, "-o", "a.png", "--background", "#ff000080")
        self.succeeds(*SPHERES, *TINY, "-o", "b.png", "--background", "#ff0000")
        _, _, channels, rows = png_pixels(self.folder / "a.png")
        _, _, _, opaque = png_pixels(self.folder / "b.png")
        whole = [(x, y) for y in range(12) for x in range(16) if rows[y][channels * x + 3] == 255]
        self.assertGreater(len(whole), 10)
        for x, y in whole:
            self.assertEqual(rows[y][4 * x : 4 * x + 3], opaque[y][3 * x : 3 * x + 3])

    def test_a_picture_goes_to_standard_output_and_nothing_else_does(self):
        self.succeeds(*SPHERES, *TINY, "-o", "a.png", "-o", "a.exr", "-o", "a.webp")
        for name, file in (("-", "a.png"), ("png:-", "a.png"), ("exr:-", "a.exr"), ("webp:-", "a.webp")):
            arguments = [candela.PROGRAM, *SPHERES, *TINY, "-o", name]
            done = subprocess.run(arguments, cwd=self.folder, capture_output=True, check=True)
            self.assertEqual(done.stdout, (self.folder / file).read_bytes(), name)
        self.assertEqual(self.files(), ["a.exr", "a.png", "a.webp"])

    def test_standard_output_holds_one_thing(self):
        self.refuses(*SPHERES, *TINY, "-o", "-", "-o", "a.png", says="there alone: -")
        self.refuses(*SPHERES, *TINY, "-o", "exr:-", "--stats", "-", says="there alone: exr:-")
        self.refuses(*SPHERES, *TINY, "-o", "-", "--turntable", "2", says="no place for the number")
        with open("/dev/full", "wb") as full:
            done = self.run_candela(*SPHERES, *TINY, "-o", "-", stdout=full)
        self.assertEqual(done.code, 1)
        self.assertRegex(done.err.splitlines()[-1], "standard output: cannot write")


class Names(CliTest):
    def test_an_unknown_environment_lists_those_there_are(self):
        says = "studoi: is neither a file nor one of studio, studio:dark, studio:three-point, sky, sky:DEG, furnace, none: did you mean studio"
        self.fails(*SPHERES, *TINY, "--env", "studoi", says=says)
        self.fails("bake", "studoi", "-o", "out", says=says)
        self.fails(*SPHERES, *TINY, "--env", "beach", says="beach: is neither a file nor one of studio.*none$")
        self.fails(*SPHERES, *TINY, "--env", "beach.hdr", says="beach.hdr: no such file")

    def test_a_sequence_of_what_does_not_move_is_refused(self):
        (self.folder / "a.glb").write_bytes(triangle_glb())
        self.fails("render", "a.glb", *TINY, "--sequence", "3", "-o", "a%d.png", says="--sequence: nothing in a.glb is animated")

    def test_json_has_the_digits_of_a_float(self):
        (self.folder / "a.glb").write_bytes(triangle_glb(planes={"zfar": 0.3}))
        text = self.succeeds("info", "a.glb", "--json").out
        self.assertIn('"near_m": 0.1,', text)
        self.assertIn('"far_m": 0.3,', text)
        self.assertNotRegex(text, r"\d\.\d{12}")


class Sets(CliTest):
    def setUp(self):
        super().setUp()
        for name in ("models/a/foo.glb", "models/b/foo.glb", "models/top.glb", "more/foo.glb"):
            (self.folder / name).parent.mkdir(parents=True, exist_ok=True)
            (self.folder / name).write_bytes(triangle_glb())

    def pictures(self, *names):
        shutil.rmtree(self.folder / "out", ignore_errors=True)
        self.succeeds("render", *names, *TINY, "-o", "out/")
        out = self.folder / "out"
        return sorted(str(p.relative_to(out)) for p in out.rglob("*.png"))

    def test_folders_are_rendered_as_they_are_laid_out(self):
        self.assertEqual(self.pictures("models"), ["a/foo.png", "b/foo.png", "top.png"])
        self.assertEqual(self.pictures("models/"), ["a/foo.png", "b/foo.png", "top.png"])
        self.assertEqual(self.pictures("models", "more"),
                         ["models/a/foo.png", "models/b/foo.png", "models/top.png", "more/foo.png"])  # fmt: skip
        self.assertEqual(self.pictures("models", "demo:spheres"), ["a/foo.png", "b/foo.png", "spheres.png", "top.png"])

    def test_scenes_of_one_name_are_told_apart_by_their_folders(self):
        self.assertEqual(self.pictures("models/a/foo.glb", "models/b/foo.glb"), ["a-foo.png", "b-foo.png"])
        self.assertEqual(self.pictures("models/a/foo.glb", "models/top.glb"), ["foo.png", "top.png"])
        (self.folder / "foo.glb").write_bytes(triangle_glb())
        self.assertEqual(self.pictures("foo.glb", "./models/a/foo.glb"), ["a-foo.png", "foo.png"])
        self.assertEqual(self.pictures("./foo.glb", "foo.glb"), ["foo-2.png", "foo.png"])

    def test_folders_need_a_folder(self):
        result = self.run_candela("render", "models", "-o", "a.png")
        self.assertEqual(result.code, 2, result.err)
        self.assertIn("-o DIR/", result.err)
        (self.folder / "empty").mkdir()
        self.fails("render", "empty", "-o", "out/", says="empty: there is no scene in this folder")

    def test_the_quiet_are_told_which_files_failed(self):
        (self.folder / "models/bad.glb").write_bytes(b"no model")
        result = self.run_candela("render", "models", *TINY, "-o", "out/", "-q")
        self.assertEqual(result.code, 1)
        told = result.err.splitlines()
        self.assertEqual(len(told), 2, result.err)
        self.assertRegex(told[0], "^failed: models/bad.glb: ")
        self.assertEqual(told[1], "candela: out/: 1 of 4 scenes have no picture")

    def test_a_terminal_is_told_which_picture_of_how_many(self):
        code, seen = self.on_terminal("render", "demo:spheres", "--size", "64x48", "--spp", "64", "--threads", "2", "--turntable", "3", "-o",
                                      "out/%d.png")  # fmt: skip
        self.assertEqual(code, 0)
        self.assertIn("picture 2 of 3", seen)
        self.assertTrue(pathlib.Path(self.folder / "out/2.png").is_file())


class Jobs(CliTest):
    def test_a_job_does_not_overwrite_the_list_that_it_is_of(self):
        for options in ("-o a.png --stats jobs.txt", "-o a.png --write-cameras ./jobs.json"):
            name = options.split("/")[-1].split()[-1]
            result = self.jobs(f"demo:spheres --size 4x4 --spp 1 {options}\n", name=name)
            self.assertEqual(result.code, 1)
            self.assertRegex(result.err, "is an input and would be overwritten")
            self.assertIn("demo:spheres", (self.folder / name).read_text())

    def jobs(self, text, *more, name="jobs.txt"):
        (self.folder / name).write_text(text)
        return self.run_candela("render", "--jobs", name, *more)

    def test_each_line_is_a_command_line(self):
        tiny = " ".join(TINY)
        result = self.jobs(
            f"# a remark\n\ndemo:spheres -o a.png {tiny}\n"
            f"candela render demo:spheres -o 'with blank.png' {tiny} --seed 1 # another\n"
            f'demo:spheres -o "sub/%d.png" --turntable 2 {tiny}\n'
        )
        self.assertEqual(result.code, 0, result.err)
        self.succeeds(*SPHERES, *TINY, "-o", "alone.png")
        self.assertEqual((self.folder / "a.png").read_bytes(), (self.folder / "alone.png").read_bytes())
        self.assertTrue((self.folder / "with blank.png").is_file())
        self.assertTrue((self.folder / "sub/1.png").is_file())

    def test_a_line_that_fails_is_named_and_the_others_go_on(self):
        tiny = " ".join(TINY)
        result = self.jobs(f"absent.glb -o a.png\ndemo:spheres --sizze 3x3 -o b.png\ndemo:spheres -o 'c.png\n"
                           f"demo:spheres -o - {tiny}\ndemo:spheres -o d.png {tiny}\n", "-q")  # fmt: skip
        self.assertEqual(result.code, 1)
        told = result.err.splitlines()
        self.assertRegex(told[0], "^failed: jobs.txt:1: absent.glb")
        self.assertRegex(told[1], "^failed: jobs.txt:2: .*did you mean --size")
        self.assertRegex(told[2], "^failed: jobs.txt:3: a ' is not closed")
        self.assertRegex(told[3], "^failed: jobs.txt:4: --output: a job writes to a file")
        self.assertEqual(told[4], "candela: jobs.txt: 4 of 5 jobs failed")
        self.assertEqual(self.files(), ["d.png", "jobs.txt"])

    def test_standard_input_is_read_as_it_comes(self):
        process = subprocess.Popen([candela.PROGRAM, "render", "--jobs", "-"], cwd=self.folder, stdin=subprocess.PIPE,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)  # fmt: skip
        self.addCleanup(self.end, process)
        process.stdin.write("demo:spheres -o a.png " + " ".join(TINY) + "\n")
        process.stdin.flush()
        self.assertIn("a.png: 16x12", process.stderr.readline())  # while the input is still open
        process.stdin.close()
        process.stdin = None  # for the clean-up
        self.assertEqual(process.wait(timeout=60), 0)

    def test_the_options_of_jobs_stand_in_their_lines(self):
        self.refuses("render", "--jobs", "a.txt", "--size", "3x3", says="--size: --jobs takes it from each line")
        self.refuses("render", "demo:spheres", "--jobs", "a.txt", says="SCENE: --jobs takes it")
        self.fails("render", "--jobs", "absent.txt", says="absent.txt: cannot be read")


if __name__ == "__main__":
    candela.main()
