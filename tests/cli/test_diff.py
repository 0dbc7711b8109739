#!/usr/bin/env python3
"""`candela diff`: how far one picture is from another."""

import json
import shutil
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
        self.assertNotRegex(page, "(?i)(src|href)=.?(http|//|[^\"']+\\.(js|css|png))", "nothing from elsewhere")
        (self.folder / "new/x.png").rename(self.folder / "new/y.png")
        self.assertEqual(self.succeeds("diff", "old", "new").out.count("only in"), 2)
        self.fails("diff", "old", "new", "--max-flip", "1", says="only in the first, and 1 more")

    def test_the_map_is_a_picture_of_the_same_size(self):
        self.pictures("a.exr", "b.exr")
        self.succeeds("diff", "a.exr", "b.exr", "-o", "error.png")
        self.assertEqual(candela.png_pixels(self.folder / "error.png")[:2], (16, 12))

    def test_json_has_the_numbers(self):
        self.pictures("a.exr", "b.exr")
        pair, = json.loads(self.succeeds("diff", "a.exr", "a.exr", "--json", "--max-flip", "0").out)["pairs"]
        self.assertEqual((pair["flip"], pair["values"], pair["beyond"], pair["width"]), (0, "linear", False, 16))
        self.assertEqual(pair["layers"][0]["changed_pixels"], 0)
        text = self.succeeds("diff", "a.exr", "b.exr").out
        pair, = json.loads(self.succeeds("diff", "a.exr", "b.exr", "--json").out)["pairs"]
        share = 100 * pair["layers"][0]["changed_pixels"] / (pair["width"] * pair["height"])
        self.assertIn(f"{share:.3g} % of the pixels changed", text)
        done = self.run_candela("diff", "a.exr", "b.exr", "--json", "--max-flip", "0")
        self.assertIs(json.loads(done.out)["pairs"][0]["beyond"], True)

    def test_a_layer_that_one_picture_lacks_is_named(self):
        self.pictures("a.exr")
        self.succeeds("render", "demo:spheres", "-o", "deep.exr", *TINY, "--aov", "depth", "-q")
        self.assertIn("  depth: in one alone\n", self.succeeds("diff", "a.exr", "deep.exr").out)

    def test_nothing_that_is_compared_is_overwritten(self):
        self.pictures("a.png", "b.png", "dir/c.png")
        for arguments in (("a.png", "b.png", "-o", "a.png"), ("a.png", "b.png", "-o", "b.png")):
            self.fails("diff", *arguments, says="would be overwritten")

    def test_bad_input_is_one_line(self):
        self.pictures("a.png", "dir/c.png")
        self.fails("diff", "a.png", "absent.png", says="absent.png")
        self.fails("diff", "a.png", "dir", says="dir: is a folder, but the first is a picture")
        self.fails("diff", "dir", "a.png", says="a.png: is a picture, but the first is a folder")
        self.fails("diff", "demo:spheres", "a.png", says="a.png: is a picture, but the first is a model")
        self.fails("diff", "a.png", "demo:spheres", says="demo:spheres: is a model, but the first is a picture")
        self.fails("diff", "dir", "dir", "-o", "map.png", says="map.png: .*page")
        self.fails("diff", "a.png", "a.png", "-o", "/proc/absent/map.png", says="/proc/absent/map.png: cannot")

    def test_a_pair_that_cannot_be_compared_is_named_and_the_others_are_compared(self):
        self.pictures("old/x.png", "old/y.png", "old/z.png")
        shutil.copytree(self.folder / "old", self.folder / "new")
        (self.folder / "new/x.png").write_bytes(b"no picture")
        self.succeeds("render", "demo:spheres", "-o", "new/y.png", "--size", "20x10", "--spp", "1", "-q")
        done = self.run_candela("diff", "old", "new", "--json")
        self.assertEqual(done.code, 1)
        self.assertRegex(done.err, r"^candela: [xy]\.png: .*, and 1 more\n$")
        x, y, z = json.loads(done.out)["pairs"]
        self.assertIn("x.png", x["error"])
        self.assertIn("20x10", y["error"])
        self.assertEqual(z["flip"], 0)

    def test_wrong_usage(self):
        self.refuses("diff", "a.png", says="SECOND")
        self.refuses("diff", "a.png", "b.png", "-o", "map.jpg", says="--output.*map.jpg")
        self.refuses("diff", "a.png", "b.png", "--max-flip", "2", says="--max-flip")
        self.assertIn("candela diff golden/", self.succeeds("diff", "--help").out)


SMALL = ("--size", "24x16", "--spp", "2", "--threads", "2", "-q")


class Models(CliTest):
    def model(self, name, red=0.5):
        (self.folder / name).parent.mkdir(exist_ok=True)
        material = {"pbrMetallicRoughness": {"baseColorFactor": [red, 0.5, 0.5, 1], "metallicFactor": 0}}
        (self.folder / name).write_bytes(candela.triangle_glb(material=material))

    def pairs(self, *arguments):
        return json.loads(self.succeeds("diff", *arguments, "--json", *SMALL).out)["pairs"]

    def test_the_same_model_has_no_difference_from_any_side(self):
        self.model("a.glb"), self.model("b.glb")
        pairs = self.pairs("a.glb", "b.glb", "--max-flip", "0")
        self.assertEqual([pair["view"] for pair in pairs], ["front", "right", "back", "left", "top", "bottom"])
        for pair in pairs:
            self.assertEqual((pair["name"], pair["flip"], pair["values"], pair["width"]), ("b.glb", 0, "display", 24))
            self.assertEqual(pair["layers"][0]["changed_pixels"], 0)

    def test_another_colour_shows_where_the_surface_is_seen(self):
        self.model("a.glb"), self.model("b.glb", red=1)
        front, right = self.pairs("a.glb", "b.glb", "--views", "front,right")
        self.assertGreater(front["flip"], 0.01)
        self.assertEqual(right["flip"], 0, "a sheet seen from its edge")
        self.fails("diff", "a.glb", "b.glb", "--max-flip", "0.001", *SMALL,
                   says=r"b\.glb front: FLIP 0\.\d+ is above 0\.001")  # fmt: skip

    def test_the_same_command_gives_the_same_bytes_with_any_number_of_threads(self):
        self.model("a.glb"), self.model("b.glb", red=1)
        done = [self.succeeds("diff", "a.glb", "b.glb", *SMALL[:-3], "--threads", n, "-q", "-o", f"{n}.html").out for n in (1, 3)]
        self.assertEqual(done[0], done[1])
        self.assertEqual((self.folder / "1.html").read_bytes(), (self.folder / "3.html").read_bytes())

    def test_both_are_seen_under_any_list_of_cameras(self):
        self.model("a.glb"), self.model("b.glb", red=1)
        pairs = self.pairs("a.glb", "b.glb", "--cameras", "sphere:3,7")
        self.assertEqual([pair["camera"] for pair in pairs], ["000", "001", "002"])
        self.assertEqual(len(self.pairs("a.glb", "b.glb", "--orbit", "0,0")), 1)
        self.succeeds("render", "a.glb", *SMALL, "--views", "front,iso", "--write-cameras", "transforms.json",
                      "-o", "p-{view}.png")  # fmt: skip
        pairs = self.pairs("a.glb", "b.glb", "--cameras", "transforms.json")
        self.assertEqual([pair["camera"] for pair in pairs], ["p-front", "p-iso"])

    def test_each_view_has_a_map_and_all_have_a_page(self):
        self.model("a.glb"), self.model("b.glb", red=1)
        self.succeeds("diff", "a.glb", "b.glb", *SMALL, "--views", "front,back", "-o", "map-{view}.png")
        self.assertEqual(candela.png_pixels(self.folder / "map-front.png")[:2], (24, 16))
        for side in ("front", "back"):
            self.succeeds("diff", "a.glb", "b.glb", *SMALL, "--views", side, "-o", "alone.png")
            self.assertEqual(candela.png_pixels(self.folder / f"map-{side}.png"),
                             candela.png_pixels(self.folder / "alone.png"))
        self.succeeds("diff", "a.glb", "b.glb", *SMALL, "--views", "front", "-o", "map.png")
        self.succeeds("diff", "a.glb", "b.glb", *SMALL, "--views", "front,back", "-o", "page.html")
        self.assertEqual((self.folder / "page.html").read_text().count("<img alt="), 6)

    def test_folders_of_models_are_compared_by_name(self):
        for name in ("old/a.glb", "new/a.glb", "old/b.glb", "new/c.glb"):
            self.model(name)
        a, b, c = self.pairs("old", "new", "--views", "front")
        self.assertEqual((a["name"], a["view"], a["flip"]), ("a.glb", "front", 0))
        self.assertEqual((b["in_second"], c["in_first"]), (False, False))
        (self.folder / "new/a.glb").write_bytes(b"no model")
        done = self.run_candela("diff", "old", "new", "--views", "front", *SMALL)
        self.assertEqual(done.code, 1)
        self.assertIn("a.glb", done.err)

    def test_the_rasterizer_compares_likewise(self):
        self.model("a.glb"), self.model("b.glb", red=1)
        front, = self.pairs("a.glb", "b.glb", "--engine", "raster", "--views", "front")
        self.assertGreater(front["flip"], 0.01)
        front, = self.pairs("a.glb", "a.glb", "--engine", "raster", "--views", "front", "--max-flip", "0")

    def test_bad_input_is_one_line(self):
        self.model("a.glb"), self.model("b.glb")
        self.fails("diff", "a.glb", "absent.glb", *SMALL, says="absent.glb")
        (self.folder / "broken.glb").write_bytes(b"glTF")
        self.fails("diff", "a.glb", "broken.glb", *SMALL, says="broken.glb")
        self.fails("diff", "a.glb", "b.glb", *SMALL, "-o", "a.html", "--variant", "red", says="a.glb.*no variant 'red'")
        self.fails("diff", "a.glb", "b.glb", "--size", "16384x16384", "--cameras", "sphere:1000", says="1000 pictures of")

    def test_what_is_compared_is_not_overwritten(self):
        scene = json.loads(candela.variants_gltf())
        scene["images"] = [{"uri": "map.png"}]
        (self.folder / "a.gltf").write_text(json.dumps(scene))
        self.fails("diff", "a.gltf", "a.gltf", *SMALL, "--views", "front", "-o", "map.png", says="map.png.*would be overwritten")

    def test_no_map_of_a_set_overwrites_what_is_compared(self):
        scene = json.loads(candela.variants_gltf())
        scene["images"] = [{"uri": "map-back.png"}, {"uri": "map-001.png"}, {"uri": "map-p-front.png"}]
        (self.folder / "a.gltf").write_text(json.dumps(scene))
        self.model("b.glb")
        self.succeeds("render", "b.glb", *SMALL, "--views", "front", "--write-cameras", "transforms.json", "-o", "p-{view}.png")
        for models in (("a.gltf", "b.glb"), ("b.glb", "a.gltf")):
            for views, pattern, says in (
                (("--views", "front,back"), "map-{view}.png", "map-back.png: is an input and would be overwritten: read by a.gltf"),
                (("--views", "back"), "map-{view}.png", "map-back.png: is an input"),
                ((), "map-{view}.png", "map-back.png: is an input"),
                (("--cameras", "sphere:3"), "map-{camera}.png", "map-001.png: is an input"),
                (("--cameras", "transforms.json"), "map-{camera}.png", "map-p-front.png: is an input"),
            ):
                with self.subTest(models=models, views=views):
                    self.fails("diff", *models, *SMALL, *views, "-o", pattern, says=says)

    def test_wrong_usage(self):
        model, picture = ("demo:spheres", "demo:spheres"), ("a.png", "b.png")
        self.refuses("diff", *model, "-o", "map.png", says="map.png has no place.*NAME-{view}.png")
        self.refuses("diff", *model, "--views", "front,inside", says="--views.*inside")
        self.refuses("diff", *model, "--engine", "raster", "--seed", "1", says="--seed: only for --engine path")
        self.refuses("diff", *picture, "--views", "front", says="--views: only for two scenes")
        self.refuses("diff", *picture, "--spp", "4", says="--spp: only for two scenes")


if __name__ == "__main__":
    candela.main()
