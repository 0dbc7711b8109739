#!/usr/bin/env python3
"""The ground under a subject, by either engine."""

import candela
from candela import CliTest, png_pixels

BALL = ("render", "demo:product", "--size", "64x48", "--threads", "2", "--orbit", "0,20,2")
ENGINES = (("--engine", "path", "--spp", "8"), ("--engine", "raster"))


class Ground(CliTest):
    def pixels(self, *options):
        self.succeeds(*BALL, "-o", "a.png", *options)
        width, height, channels, rows = png_pixels(self.folder / "a.png")
        return [[row[channels * x : channels * (x + 1)] for x in range(width)] for row in rows]

    def test_white_paper_is_white_but_for_the_shadow(self):
        for engine in ENGINES:
            rows = self.pixels(*engine, "--ground", "white")
            self.assertTrue(all(tuple(pixel[:3]) == (255, 255, 255) for pixel in rows[0]), "above the horizon")
            self.assertGreater(min(rows[-1][0][:3]), 250, "hardly shaded")
            shaded = sum(pixel[:3] != rows[0][0][:3] for row in rows for pixel in row)
            self.assertGreater(shaded, 300)

    def test_a_shadow_alone_is_alpha(self):
        for engine in ENGINES:
            alpha = [[pixel[3] for pixel in row] for row in self.pixels(*engine, "--ground", "shadow", "--background", "transparent")]
            self.assertEqual(set(alpha[0]), {0})
            self.assertLess(alpha[-1][0], 8)
            self.assertGreater(sum(0 < a < 255 for row in alpha for a in row), 200)
            below = self.pixels(*engine, "--ground", "shadow", "--ground-height", "-9", "--background", "transparent")
            self.assertLess(sum(pixel[3] for row in below for pixel in row), sum(a for row in alpha for a in row))

    def test_a_studio_gives_light_and_paper_that_others_replace(self):
        for engine in ENGINES:
            paper = self.pixels(*engine, "--studio", "grey")[0][0]
            self.assertEqual(len(set(paper[:3])), 3, "a cool grey")
            self.assertEqual(tuple(self.pixels(*engine, "--studio", "grey", "--ground", "white")[0][0][:3]), (255, 255, 255))
            self.assertEqual(tuple(self.pixels(*engine, "--studio", "dark", "--background", "#102030")[0][0][:3]), (0x10, 0x20, 0x30))

    def test_wrong_grounds_are_refused(self):
        for options, why in (
            (("--ground", "lawn"), "neither shadow, nor mirror:X; 'lawn' is no colour"),
            (("--ground", "white+mirror:2"), "--ground"),
            (("--ground", "white+shadow"), "mirror:X"),
            (("--ground", "2,2,2"), "no ground reflects more"),
            (("--ground", "white", "--background", "env"), "paper is the background"),
            (("--ground-height", "1"), "only with --ground"),
            (("--ground", "shadow", "--engine", "raster", "--view", "normal"), "--ground: only all light"),
            (("--studio", "beige"), "unknown studio.*white, grey, dark, three-point"),
        ):
            self.refuses(*BALL, "-o", "a.png", *options, says=why)


if __name__ == "__main__":
    candela.main()
