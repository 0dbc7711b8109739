#!/usr/bin/env python3
"""`candela diff`: how far one picture is from another."""

import json
import unittest

import candela
from candela import TINY, CliTest


class Diff(CliTest):
    def pictures(self, *names):
        for seed, name in enumerate(names, 1):
            (self.folder / name).parent.mkdir(exist_ok=True)
            self.succeeds("render", "demo:spheres", "-o", name, *TINY, "--seed", seed, "-q")

    def test_a_limit_decides_the_exit_code(self):
        self.pictures("a.png", "b.png")
        self.assertIn("FLIP 0.0000", self.succeeds("diff", "a.png", "a.png", "--max-flip", "0").out)
        self.assertIn("pixels changed", self.succeeds("diff", "a.png", "b.png").out)
        self.fails("diff", "a.png", "b.png", "--max-flip", "0.001", says=r"b\.png: FLIP 0\.\d+ is above 0\.001")

    def test_folders_are_compared_by_name_and_a_missing_picture_fails_a_limit(self):
        self.pictures("old/x.png", "new/x.png")
        self.succeeds("diff", "old", "new", "-o", "page.html", "--max-flip", "1")
        page = (self.folder / "page.html").read_text()
        self.assertEqual(page.count("<img alt="), 3)
        (self.folder / "new/x.png").rename(self.folder / "new/y.png")
        self.assertEqual(self.succeeds("diff", "old", "new").out.count("only in"), 2)
        self.fails("diff", "old", "new", "--max-flip", "1", says="only in the first, and 1 more")

    def test_the_map_is_a_picture_of_the_same_size(self):
        self.pictures("a.exr", "b.exr")
        self.succeeds("diff", "a.exr", "b.exr", "-o", "error.png")
        self.assertEqual(candela.png_pixels(self.folder / "error.png")[:2], (16, 12))

    def test_json_has_the_numbers(self):
        self.pictures("a.exr", "b.png")
        pair, = json.loads(self.succeeds("diff", "a.exr", "a.exr", "--json", "--max-flip", "0").out)["pairs"]
        self.assertEqual((pair["flip"], pair["values"], pair["beyond"], pair["width"]), (0, "linear", False, 16))
        self.assertEqual(pair["layers"][0]["changed_pixels"], 0)

    def test_nothing_that_is_compared_is_overwritten(self):
        self.pictures("a.png", "b.png", "dir/c.png")
        for arguments in (("a.png", "b.png", "-o", "a.png"), ("a.png", "b.png", "-o", "b.png")):
            self.fails("diff", *arguments, says="would be overwritten")

    def test_bad_input_is_one_line(self):
        self.pictures("a.png", "dir/c.png")
        self.fails("diff", "a.png", "absent.png", says="absent.png")
        self.fails("diff", "a.png", "dir", says="dir: is a folder")
        self.fails("diff", "dir", "a.png", says="a.png: is no folder")
        self.fails("diff", "dir", "dir", "-o", "map.png", says="map.png: .*page")
        self.fails("diff", "a.png", "a.png", "-o", "/proc/absent/map.png", says="/proc/absent/map.png: cannot")

    def test_wrong_usage(self):
        self.refuses("diff", "a.png", says="SECOND")
        self.refuses("diff", "a.png", "b.png", "-o", "map.jpg", says="--output.*map.jpg")
        self.refuses("diff", "a.png", "b.png", "--max-flip", "2", says="--max-flip")
        self.assertIn("candela diff golden/", self.succeeds("diff", "--help").out)


if __name__ == "__main__":
    candela.main()
