#!/usr/bin/env python3
"""`candela furnace`: the matrix of laws and the sheet."""

import json
import unittest

import candela
from candela import CliTest


class Furnace(CliTest):
    def test_matrix_keeps_its_promises_and_the_sheet_is_a_picture(self):
        result = self.succeeds("furnace", "--json", "-o", "sheet.png", timeout=600)
        rows = {row["surface"]: row for row in json.loads(result.out)["laws"]}
        for name in ("plain white, metallic 1", "glass from inside of index 1.5", "sheen of roughness 0.5 on metal"):
            self.assertTrue(rows[name]["kept"])
            self.assertLess(abs(rows[name]["furnace"]["least"] - 1), 0.01)
        self.assertEqual([name for name, row in rows.items() if not row["kept"]], [])
        self.assertEqual(sum(row["not_finite"] for row in rows.values()), 0)
        # A specification's literal formulas are measured too, and are seen to lose and gain.
        self.assertLess(rows["model gltf, metallic 1"]["furnace"]["least"], 0.5)
        self.assertGreater(rows["model gltf + coat, metallic 0"]["reciprocity_error"], 0.01)

        width, height, _, pixels = candela.png_pixels(self.folder / "sheet.png")
        self.assertEqual((width % 96, (height - 24) % 96), (0, 0))
        middle = 3 * 48
        self.assertTrue(all(abs(v - 128) < 12 for v in pixels[48][middle : middle + 3]), "white plastic is grey")
        blue = pixels[height - 24 - 48][-middle:-middle + 3]
        self.assertGreater(blue[2], 200, "single scattering alone loses more than a tenth")

    def test_help_has_an_example(self):
        text = self.succeeds("furnace", "--help").out
        self.assertIn("candela furnace -o sheet.png", text)
        self.assertIn("--all", text)

    def test_wrong_usage(self):
        self.refuses("furnace", "-o", "sheet.exr", says="--output.*sheet.exr")
        self.refuses("furnace", "--threads", "0", says="0")
        self.refuses("furnace", "helmet.glb", says="helmet.glb")

    def test_a_folder_that_cannot_be_made_is_told_before_the_work(self):
        (self.folder / "file").write_text("")
        self.fails("furnace", "-o", "file/sheet.png", says="file")


if __name__ == "__main__":
    candela.main()
