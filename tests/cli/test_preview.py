#!/usr/bin/env python3
"""`candela preview`: the sheet, what it says to programs, thumbnails, and the entry by which desktops ask for them."""

import configparser
import json
import pathlib
import shlex
import subprocess

import candela
from candela import CliTest, png_pixels, triangle_glb

SMALL = ("--size", "48", "--threads", "2")
ENTRY = pathlib.Path(__file__).resolve().parents[2] / "share/candela.thumbnailer"


class Preview(CliTest):
    def setUp(self):
        super().setUp()
        (self.folder / "a.glb").write_bytes(triangle_glb(material={"name": "paint", "emissiveFactor": [1, 0, 0]}))

    def test_the_sheet_has_four_views_and_says_what_there_is(self):
        told = json.loads(self.succeeds("preview", "a.glb", "-o", "sheet.png", "--json", *SMALL).out)
        width, height, channels, rows = png_pixels(self.folder / "sheet.png")
        self.assertEqual(channels, 3)
        self.assertEqual((told["file"], told["sheet"], told["triangles"], told["material_names"]),
                         ("a.glb", "sheet.png", 1, ["paint"]))  # fmt: skip
        self.assertEqual(told["size_m"], [2, 2, 0])
        self.assertEqual([view["name"] for view in told["views"]], ["front", "right", "top", "three-quarter"])
        red = []
        for view in told["views"]:
            self.assertLessEqual(view["x"] + view["width"], width)
            self.assertLessEqual(view["y"] + view["height"], height)
            texels = [
                rows[y][3 * x : 3 * x + 3]
                for y in range(view["y"], view["y"] + view["height"])
                for x in range(view["x"], view["x"] + view["width"])
            ]
            red.append(sum(r > g + 60 for r, g, _ in texels))
        self.assertGreater(red[0], 400)  # the triangle from the front
        self.assertGreater(red[3], 300)
        self.assertLess(red[1], 100)  # on edge
        # Words: dark texels on paper, below the views.
        below = told["views"][0]["y"] + told["views"][0]["height"]
        self.assertGreater(sum(v < 120 for row in rows[below:] for v in row), 500)

    def test_findings_are_those_of_check(self):
        (self.folder / "b.glb").write_bytes(
            triangle_glb(material={"pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 1], "metallicFactor": 0}})
        )
        told = json.loads(self.succeeds("preview", "b.glb", "--json").out)
        judged = json.loads(self.succeeds("check", "b.glb", "--json").out)["assets"][0]
        self.assertEqual(told["findings"], judged["findings"])
        self.assertEqual(told["findings"][0]["code"], "albedo-too-bright")
        self.assertEqual(self.files(), ["a.glb", "b.glb"])  # --json alone makes no sheet

    def test_the_name_is_that_of_the_model_and_never_an_input(self):
        self.succeeds("preview", "a.glb", *SMALL, "-q")
        self.assertEqual(self.files(), ["a-preview.png", "a.glb"])
        self.refuses_usage("preview", "a.glb", "-o", "a.exr", says="--output: is a .png")

    def refuses_usage(self, *arguments, says):
        result = self.run_candela(*arguments)
        self.assertEqual(result.code, 2, result.err)
        self.assertRegex(result.err, says)

    def test_the_same_model_gives_the_same_sheet_on_any_number_of_threads(self):
        self.succeeds("preview", "a.glb", "--size", "32", "--threads", "1", "-o", "1.png", "-q")
        self.succeeds("preview", "a.glb", "--size", "32", "--threads", "3", "-o", "3.png", "-q")
        self.assertEqual((self.folder / "1.png").read_bytes(), (self.folder / "3.png").read_bytes())

    def test_a_sheet_goes_to_standard_output_alone(self):
        self.succeeds("preview", "a.glb", *SMALL, "-o", "a.png", "-q")
        done = subprocess.run([candela.PROGRAM, "preview", "a.glb", *SMALL, "-o", "-"], cwd=self.folder, capture_output=True, check=True)
        self.assertEqual(done.stdout, (self.folder / "a.png").read_bytes())
        self.refuses_usage("preview", "a.glb", "-o", "-", "--json", says="--json: standard output takes the picture")

    def test_what_cannot_be_shown_is_one_line(self):
        (self.folder / "bad.glb").write_bytes(b"no model")
        self.fails("preview", "absent.glb", "-o", "a.png", says="absent.glb")
        self.fails("preview", "bad.glb", "-o", "a.png", says="bad.glb")
        self.fails("preview", "bad.glb", "--json", says="bad.glb")
        self.fails("preview", "a.glb", "--env", "studoi", says="did you mean studio")

    def test_what_holds_nothing_has_a_sheet(self):
        (self.folder / "empty.gltf").write_text('{"asset":{"version":"2.0"},"scenes":[{}]}')
        told = json.loads(self.succeeds("preview", "empty.gltf", *SMALL, "-o", "a.png", "--json").out)
        self.assertIsNone(told["size_m"])
        self.assertEqual(told["triangles"], 0)

    def test_names_of_any_letters_are_shown(self):
        name = "Модель ελ 模型 \x7f.glb"
        (self.folder / name).write_bytes(triangle_glb(material={"name": "Färbung " * 40}))
        self.succeeds("preview", name, *SMALL, "-o", "a.png")


class Thumbnails(CliTest):
    def test_the_thumbnailer_makes_a_picture_of_the_size_that_is_asked_for(self):
        entry = configparser.ConfigParser(interpolation=None)
        entry.read(ENTRY)
        words = shlex.split(entry["Thumbnailer Entry"]["Exec"])
        (self.folder / "a.glb").write_bytes(triangle_glb())
        values = {"%i": "a.glb", "%o": "thumbnail.file", "%s": "64"}
        self.assertEqual(words[0], "candela")
        done = self.succeeds(*(values.get(word, word) for word in words[1:]))
        self.assertEqual((done.out, done.err), ("", ""))
        width, height, channels, rows = png_pixels(self.folder / "thumbnail.file")
        self.assertEqual((width, height, channels), (64, 64, 4))
        self.assertEqual(rows[0][3], 0)
        self.assertEqual(max(row[4 * x + 3] for row in rows for x in range(64)), 255)
        self.assertIn("model/gltf-binary", entry["Thumbnailer Entry"]["MimeType"])


if __name__ == "__main__":
    candela.main()
