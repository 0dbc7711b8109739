#!/usr/bin/env python3
"""`candela compare`: how far the real-time frame is from the truth, and why."""

import json
import re
import shutil

import candela
from candela import ROOT
from test_check import png
from test_raster import RasterTest

QUICK = ("--spp", "16", "--frames", "4", "-q")
METALS = ("demo:row-roughness-metal", "--size", "240x48", *QUICK)
BALLS = ("demo:row-roughness", "--size", "240x48", *QUICK)
PLAIN = (*BALLS, "--no-suspects")


class Compare(RasterTest):
    def files_of(self, folder):
        return sorted(path.name for path in (self.folder / folder).iterdir())

    def views(self, *arguments):
        return json.loads(self.draws("compare", *arguments, "--json").out)["views"]

    def test_a_folder_has_the_page_the_numbers_and_both_pictures(self):
        text = self.draws("compare", *PLAIN, "-o", "gap", "--exposure", "0").out
        self.assertRegex(text, r"the view: FLIP 0\.\d{4}")
        self.assertIn("What hides the environment", text)
        self.assertEqual(self.files_of("gap"), ["frame.exr", "gap.json", "index.html", "truth.exr"])
        page = (self.folder / "gap/index.html").read_text()
        self.assertNotRegex(page, "(?i)(src|href)=.?(http|//|[^\"']+\\.(js|css|png))", "nothing from elsewhere")
        self.assertIn("share of the squared error", page)
        view, = json.loads((self.folder / "gap/gap.json").read_text())["views"]
        self.assertAlmostEqual(sum(c["share"] for c in view["causes"]), 1, 4)
        self.assertEqual(view["pixels"], 240 * 48)
        pair, = json.loads(self.succeeds("diff", "gap/truth.exr", "gap/frame.exr", "--exposure", "0", "--json").out)["pairs"]
        self.assertLess(abs(pair["flip"] - view["flip"]), 0.001)

    def test_a_limit_decides_the_exit_code(self):
        self.draws("compare", *PLAIN, "--max-flip", "1")
        result = self.run_candela("compare", *PLAIN, "--max-flip", "0.001", "-o", "gap.html", env=self.environment)
        self.assertEqual(result.code, 1)
        self.assertRegex(result.err, r"^candela: demo:row-roughness: FLIP 0\.\d+ is above 0\.001 \(--max-flip\)\n$")
        self.assertIn('class="beyond"', (self.folder / "gap.html").read_text())

    def test_several_views_are_named_and_each_has_its_pictures(self):
        views = self.views(*PLAIN, "--views", "front,top", "-o", "gap")
        self.assertEqual([v["view"] for v in views], ["front", "top"])
        self.assertEqual(self.files_of("gap"), ["frame-000.exr", "frame-001.exr", "gap.json", "index.html",
                                             "truth-000.exr", "truth-001.exr"])

    def test_bad_input_is_one_line(self):
        self.fails("compare", "absent.glb", says="absent.glb")
        self.fails("compare", *PLAIN, "--env", "absent.hdr", says="absent.hdr")
        self.fails("compare", *PLAIN, "-o", "/proc/absent/x.html", says="/proc/absent")
        (self.folder / "a").mkdir()
        (self.folder / "a/t.glb").write_bytes(candela.triangle_glb())
        self.fails("compare", "a/t.glb", *QUICK, "-o", "a", says="t.glb: lies in the output folder and could")

    def test_wrong_usage(self):
        self.refuses("compare", *PLAIN, "--spp", "1", says="--spp")
        self.refuses("compare", *PLAIN, "--background", "transparent", says="--background")
        self.refuses("compare", *PLAIN, "--orbit", "1,2", "--views", "front", says="--views|--orbit")


class Against(RasterTest):
    """Pictures of other programs."""

    SCENE = ("demo:row-metallic", "-q")

    def judge(self, picture, *arguments, samples=16):
        out = self.draws("compare", *self.SCENE, "--against", picture, "--spp", samples, "--json", *arguments).out
        return json.loads(out)["views"][0]

    def test_the_truth_itself_differs_by_noise_alone(self):
        self.draws("render", "demo:row-metallic", "--size", "240x48", "--spp", "512", "--seed", "9", "-q",
                   "-o", "t.exr", "-o", "t.png")
        for name, values in (("t.exr", "linear"), ("t.png", "display")):
            view = self.judge(name, samples=32)
            self.assertEqual(view["match"]["values"], values)
            self.assertEqual(view["match"]["shift"], [0, 0])
            self.assertLess(view["relative_l2"], 0.06, name)
            self.assertEqual(view["causes"], [])
            self.assertGreater(len(view["materials"]), 3)

    def test_a_moved_and_brighter_picture_is_laid_over_the_truth(self):
        for stops in (0, 1):
            self.draws("render", "demo:row-metallic", "--size", "240x48", "--spp", "64", "--exposure", stops, "-q",
                       "-o", f"t{stops}.png")
        plain = self.judge("t0.png")
        width, height, channels, rows = candela.png_pixels(self.folder / "t1.png")
        inside = lambda i, count: max(0, min(count - 1, i))
        texel = lambda x, y: rows[inside(y + 2, height)][channels * inside(x - 5, width):][:3]
        (self.folder / "m.png").write_bytes(png(width, height, texel))
        view = self.judge("m.png")
        self.assertEqual(view["match"]["shift"], [5, -2])
        self.assertAlmostEqual(view["match"]["exposure"] / plain["match"]["exposure"], 2, delta=0.05)
        self.assertLess(view["flip"], plain["flip"] + 0.03)
        self.assertEqual((view["width"], view["height"]), (235, 46))
        self.assertEqual(self.judge("m.png", "--exposure", "0")["match"]["exposure"], 1)

    def test_what_does_not_fit_is_told(self):
        self.draws("render", "demo:row-metallic", "--size", "24x16", "--spp", "1", "-o", "t.png", "-q")
        self.fails("compare", *self.SCENE, "--against", "t.png", "--size", "16x16",
                   says="t.png: is 24x16 pixels, and the truth 16x16")
        self.fails("compare", *self.SCENE, "--against", "absent.png", says="absent.png")
        self.fails("compare", *self.SCENE, "--against", "t.png", "-o", ".", says="t.png")
        self.fails("compare", *self.SCENE, "--spp", "2", "--against", "t.png", "--views", "front,top", says="one view")


class Mistakes(RasterTest):
    """Wrong approximations, planted in the shaders, are found and named."""

    def suspects(self, arguments, file, pattern, replacement):
        shaders = self.folder / "shaders"
        shutil.rmtree(shaders, ignore_errors=True)
        shutil.copytree(ROOT / "src/raster/shaders", shaders)
        shutil.copytree(ROOT / "src/shade", shaders / "shade", ignore=shutil.ignore_patterns("*.cpp", "*.txt"))
        text = (shaders / file).read_text()
        changed = re.sub(pattern, replacement, text, flags=re.S)
        self.assertNotEqual(changed, text, "the planted mistake is not there")
        (shaders / file).write_text(changed)
        out = self.draws("compare", *arguments, "--shaders", "shaders", "--json").out
        return [s["suspect"] for s in json.loads(out)["views"][0]["suspects"]], out

    def test_what_is_right_has_no_suspects(self):
        out = self.draws("compare", *METALS, "--env", "studio:three-point", "--json").out
        self.assertEqual(json.loads(out)["views"][0]["suspects"], [])

    def test_a_missing_division_by_pi(self):
        suspects, out = self.suspects((*BALLS, "--env", "sky"), "mesh_far_light.glsl",
                                      r"shares\.diffuse \* arriving", "shares.diffuse * arriving * kShadePi")
        self.assertIn("factor-diffuse", suspects)
        self.assertIn("division by π were missing", out)

    def test_a_mirrored_environment(self):
        suspects, _ = self.suspects((*METALS, "--env", "studio:three-point"), "mesh_far_light.glsl",
                                    r"(prefiltered\(vec3 direction, float alpha\) \{\n)",
                                    r"\1  direction.z = -direction.z;\n")
        self.assertEqual(suspects[:1], ["environment-mirrored"])

    def test_roughness_squared_twice(self):
        suspects, _ = self.suspects((*METALS, "--env", "sky:40"), "shade/surface_base.glsl.h",
                                    r"roughness_to_alpha\(p\.roughness\)", "roughness_to_alpha(p.roughness * p.roughness)")
        self.assertEqual(suspects[:1], ["roughness-squared"])

    def test_lamps_twice_as_bright(self):
        suspects, _ = self.suspects(("demo:cornell", "--size", "96x96", *QUICK), "mesh.frag.glsl",
                                    r"part\(kDirectPart\) \* direct_light", "2.0 * part(kDirectPart) * direct_light")
        self.assertIn("factor-lamps", suspects)


if __name__ == "__main__":
    candela.main()
