#!/usr/bin/env python3
"""`candela explain`: every term of a pixel."""

import json
import re

import candela
from test_raster import RasterTest

BALLS = ("demo:row-roughness", "--size", "240x48", "--spp", "64", "-q")
MIDDLE = ("--pixel", "120,22")
BEFORE_SKY = ("demo:furnace", "--size", "64x36", "--spp", "64", "-q", "--pixel", "0,0", "--no-frame")


class Explain(RasterTest):
    def pixels(self, *arguments):
        return json.loads(self.draws("explain", *arguments, "--json").out)["pixels"]

    def test_a_pixel_is_told_in_words(self):
        text = self.draws("explain", *BALLS, *MIDDLE).out
        for word in ("pixel", "surface", "material", "albedo", "facets", "frame", "reads", "truth", "sources", "paths"):
            self.assertRegex(text, rf"(?m)^{word} ", text)
        self.assertRegex(text, r"truth +\S+ \S+ \S+ ± \S+ \S+ \S+ with 95 % confidence, of 64 paths")
        self.assertRegex(text, r"level \d\.\d\d of 0 to \d")
        self.assertEqual(len(re.findall(r"(?m)^paths .*|^ +\S+ \S+ \S+: eye", text)), 3)

    def test_json_adds_up(self):
        pixel, = self.pixels("demo:cornell", "--size", "64x64", "--spp", "256", "-q", "--pixel", "12,40")
        truth = pixel["truth"]
        for channel in range(3):
            mean = truth["mean"][channel]
            self.assertAlmostEqual(sum(s["straight"][channel] + s["indirect"][channel] for s in truth["sources"]), mean,
                                   delta=1e-5 + 1e-4 * mean)
            self.assertAlmostEqual(sum(t[channel] for t in truth["turns"]), mean, delta=1e-5 + 1e-4 * mean)
            terms = pixel["frame"]["terms"]
            self.assertAlmostEqual(sum(v[channel] for k, v in terms.items() if not k.startswith("light:")),
                                   pixel["frame"]["radiance"][channel], delta=1e-4 + 1e-3 * mean)
        self.assertEqual({s["kind"] for s in truth["sources"]}, {"surface"}, "the box has one lamp")
        self.assertEqual(len(truth["brightest"]), 3)
        self.assertLessEqual({v["event"] for p in truth["brightest"] for v in p["vertices"]},
                             {"reflected", "ended"})

    def test_the_page_stands_alone(self):
        self.draws("explain", *BALLS, *MIDDLE, "--pixel", "60,22", "-o", "pixels.html")
        page = (self.folder / "pixels.html").read_text()
        self.assertNotRegex(page, "(?i)(src|href)=.?(http|//|[^\"']+\\.(js|css|png))", "nothing from elsewhere")
        self.assertIn("data:image/png;base64,", page)
        self.assertEqual(page.count("<section>"), 2)
        self.assertIn("f cos θ", page)

    def test_the_sky_has_no_surface(self):
        pixel, = self.pixels(*BEFORE_SKY)
        self.assertTrue(pixel["surface"] is None)
        self.assertIsNone(pixel["frame"])
        self.assertEqual([s["kind"] for s in pixel["truth"]["sources"]], ["sky"])
        self.assertIn("sees the environment", self.succeeds("explain", *BEFORE_SKY, "-o", "sky.html").out)
        self.assertIn("The middle of the pixel sees no surface.", (self.folder / "sky.html").read_text())

    def test_bad_input_is_one_line(self):
        self.fails("explain", *BALLS, "--pixel", "240,0", says="pixel 240,0 is outside a picture of 240x48")
        self.fails("explain", *BALLS, "--pixel", "0,48", says="--pixel")
        self.fails("explain", "absent.glb", *MIDDLE, says="absent.glb")
        self.fails("explain", *BALLS, *MIDDLE, "--views", "front,top", says="one picture")
        for wrong in ("1", "a,b", "1,2,3", "-1,2", "1.5,2"):
            self.refuses("explain", *BALLS, "--pixel", wrong, says="--pixel")
        self.refuses("explain", *BALLS, says="--pixel")
        self.refuses("explain", *BALLS, *MIDDLE, "-o", "page.png", says="--output")


if __name__ == "__main__":
    candela.main()
