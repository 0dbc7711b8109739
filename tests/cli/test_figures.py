#!/usr/bin/env python3
"""`candela figures`: pages, pictures and curves that name each other, and how they fail."""

import html.parser
import os
import re
import shlex
import signal
import time
import unittest
import xml.etree.ElementTree as ElementTree

import candela
from candela import CliTest

# Every figure of the documents that the material follows, by the figure that shows it.
DOCUMENTS = {
    "normal-distribution lobes over roughness, GGX": "ndf-ggx",
    "GGX against Beckmann": "ndf-models",
    "geometry term over roughness": "geometry",
    "Fresnel curves of dielectrics": "fresnel-dielectrics",
    "Fresnel curves of metals": "fresnel-metals",
    "sphere row over roughness, dielectric": "roughness-dielectric",
    "sphere row over roughness, metal": "roughness-metal",
    "F0 from 0 to 1": "f0",
    "metallic from 0 to 1": "metallic",
    "gamma correction on and off": "gamma",
    "tone mapping on and off": "tone-mapping",
    "punctual lights only against irradiance map": "irradiance-map",
    "environment mips by roughness": "environment-mips",
    "Blinn-Phong against PBR": "blinn-phong",
    "metallic against specular-glossiness": "workflows",
    "inverse-square fall-off and its windows": "falloff",
    "Riemann sum against Monte Carlo": "riemann-monte-carlo",
    "N samples against the converged answer": "samples",
    "an environment beside its irradiance map": "irradiance-pictures",
    "the prefiltered chain as pictures": "prefiltered-chain",
    "random against low-discrepancy points": "points",
    "the grid of metallic and roughness": "metallic-roughness",
    "D, G and F as shaded spheres": "facet-terms",
    "facets and directions, sketched": "sketch-facets",
    "radiance and the reflectance equation, sketched": "sketch-radiance",
    "area lights": "area-lights",
    "the diffuse models side by side": "diffuse-models",
    "furnaces as pictures": "furnace-pictures",
    "views that add up": "parts-of-a-picture",
}
VOID = {"meta", "img", "br"}


class Page(html.parser.HTMLParser):
    """What a page refers to; raises where an element does not end."""

    def __init__(self, path):
        super().__init__()
        self.open, self.links, self.code, self.elements = [], [], [], set()
        self.text = path.read_text(encoding="utf-8")
        self.feed(self.text)
        self.close()
        assert not self.open, f"{self.open} does not end"

    def handle_starttag(self, tag, attributes):
        self.elements.add(tag)
        if tag == "code":
            self.code.append("")
        self.links += [value for name, value in attributes if name in ("src", "href")]
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open and self.open[-1] == tag, f"</{tag}> within {self.open}"
        self.open.pop()

    def handle_data(self, data):
        if self.open and self.open[-1] == "code":
            self.code[-1] += data

    def files(self):
        return {link for link in self.links if not link.startswith("#")}


class Figures(CliTest):
    def listed(self):
        """All names, as the help lists them."""
        text = self.succeeds("figures", "--help").out
        listed = text[text.index("Figures:") : text.index("Examples:")].removeprefix("Figures:").replace(",\n", ",")
        lines = [line for line in listed.splitlines() if line.strip()]
        return [name.strip() for line in lines for name in line.split(": ")[1].split(",")]

    def test_curves_alone_and_the_page_that_shows_them(self):
        self.succeeds("figures", "-o", "out", "--only", "ndf-ggx,fresnel-dielectrics", "-q")
        out = self.folder / "out"
        page = Page(out / "index.html")
        files = {path.name for path in out.iterdir()}
        self.assertEqual(page.files() | {"index.html"}, files, "the page names every file, and no other")
        self.assertIn("ndf-ggx-lobes.svg", files)
        self.assertIn("math", page.elements)
        self.assertIn("candela figures -o DIR --only ndf-ggx", page.code)
        for svg in out.glob("*.svg"):
            root = ElementTree.parse(svg).getroot()
            self.assertEqual(root.tag, "{http://www.w3.org/2000/svg}svg")
            self.assertGreater(len(root.findall("{*}path")) + len(root.findall("{*}line")), 10)

    def test_numbers_do_not_depend_on_what_else_is_made(self):
        numbers = []
        for only in ("geometry", "ndf-ggx,geometry", "sketch-facets,geometry-models,geometry"):
            self.succeeds("figures", "-o", "out", "--only", only, "-q")
            page = (self.folder / "out/index.html").read_text()
            numbers.append(re.search(r'id="geometry">\s*<h3><a href="#geometry"><span>(\d\.\d+)</span>', page)[1])
        self.assertEqual(len(set(numbers)), 1, numbers)
        self.assertIn('href="#contents"', page, "a way back up")
        self.assertIn('id="contents"', page)

    def test_nothing_comes_from_elsewhere(self):
        self.succeeds("figures", "-o", "out", "--only", "geometry,row-specular", "--quality", "draft", "--spp", "1", "-q")
        for path in (self.folder / "out").glob("*.*ml"):
            page = Page(path)
            self.assertNotIn("script", page.elements)
            self.assertNotIn("link", page.elements)
            self.assertNotRegex(page.text, r"https?://|url\(")

    def test_a_parameter_has_a_page_and_its_command_renders_the_same_bytes(self):
        self.succeeds("figures", "-o", "out", "--only", "row-roughness,row-metallic", "--quality", "draft", "--spp", "2", "-q")
        out = self.folder / "out"
        index = Page(out / "index.html")
        self.assertIn("parameter-row-roughness.html", index.files())
        page = Page(out / "parameter-row-roughness.html")
        self.assertIn("parameter-row-metallic.html", page.files(), "its neighbour")
        self.assertIn("row-roughness.png", page.files())
        named = index.files() | page.files() | Page(out / "parameter-row-metallic.html").files()
        self.assertEqual(named, {path.name for path in out.iterdir()})

        commands = [text for text in page.code if text.startswith("candela render")]
        self.assertTrue(commands)
        for command in commands:
            words = shlex.split(command)[1:]
            self.succeeds(*words)
            name = words[words.index("-o") + 1]
            self.assertEqual((self.folder / name).read_bytes(), (out / name).read_bytes(), command)
        width, height, _, _ = candela.png_pixels(out / "row-roughness.png")
        self.assertEqual(width, 6 * height)

    def test_metals_stand_below_their_balls(self):
        self.succeeds("figures", "-o", "out", "--only", "row-conductor", "--quality", "draft", "--spp", "1", "-q")
        text = (self.folder / "out/parameter-row-conductor.html").read_text(encoding="utf-8")
        scale = re.search(r'<div class="scale">(.*?)</div>', text).group(1)
        names = re.findall(r"<span>(.*?)</span>", scale)
        self.assertEqual(names, ["silver", "aluminium", "titanium", "iron", "brass", "copper", "gold"])

    def test_errors_are_printed_below_the_pictures(self):
        self.succeeds("figures", "-o", "out", "--only", "gamma", "--quality", "draft", "--spp", "4", "-q")
        text = (self.folder / "out/index.html").read_text(encoding="utf-8")
        errors = [float(number) for number in re.findall(r"<b>error ([\d.]+) %</b>", text)]
        self.assertEqual(len(errors), 2)
        self.assertGreater(errors[0], 20, "without encoding a picture is far too dark")
        rows = {}
        for name in ("on", "off"):
            _, _, channels, pixels = candela.png_pixels(self.folder / f"out/gamma-{name}.png")
            rows[name] = sum(sum(row[0::channels]) for row in pixels)
        self.assertLess(rows["off"], 0.7 * rows["on"])

    def test_every_figure_of_the_documents_is_there(self):
        names = self.listed()
        self.assertEqual(len(names), len(set(names)))
        for what, name in DOCUMENTS.items():
            self.assertIn(name, names, what)
        for row in ("row-roughness", "row-metallic", "row-sheen-color", "row-iridescence-thickness", "row-subsurface"):
            self.assertIn(row, names)

    def test_every_row_of_balls_has_a_page(self):
        known = self.fails("render", "demo:nonsense", says="there are").err
        rows = set(re.findall(r"row-[a-z-]+", known))
        self.assertGreater(len(rows), 20)
        self.assertEqual(rows - set(self.listed()), set())

    def test_without_opengl_the_page_says_what_is_left_out(self):
        nowhere = dict(os.environ, __EGL_VENDOR_LIBRARY_DIRS="/nonexistent", __EGL_VENDOR_LIBRARY_FILENAMES="")
        result = self.succeeds("figures", "-o", "out", "--only", "row-roughness,row-metallic", "--quality", "draft", "--spp", "1",
                               env=nowhere)
        warnings = [line for line in result.err.splitlines() if line.startswith("warning")]
        self.assertEqual(len(warnings), 1, result.err)
        self.assertIn("OpenGL", warnings[0])
        page = Page(self.folder / "out/parameter-row-roughness.html")
        self.assertIn("Left out: the row in real time, which needs OpenGL", page.text)
        self.assertNotIn("row-roughness-raster.png", page.files())
        self.assertFalse((self.folder / "out/row-roughness-raster.png").exists())

    def test_wrong_usage(self):
        self.refuses("figures", says="--output")
        self.refuses("figures", "-o", "", says="--output")
        self.refuses("figures", "-o", "out", "--only", "ndf-ggx,nonsense", says="--only.*nonsense.*there are.*fresnel-metals")
        self.refuses("figures", "-o", "out", "--only", "", says="--only")
        self.refuses("figures", "-o", "out", "--quality", "best", says="--quality.*draft")
        self.refuses("figures", "-o", "out", "--spp", "0", says="--spp")
        self.refuses("figures", "-o", "out", "--threads", "none", says="--threads")
        self.refuses("figures", "scene.glb", "-o", "out", says="scene.glb")

    def test_a_folder_that_cannot_be(self):
        (self.folder / "file").write_text("no folder")
        self.fails("figures", "-o", "file", "--only", "geometry", says="file")
        self.fails("figures", "-o", "file/below", "--only", "geometry", says="file/below")

    def test_quiet_is_quiet_and_otherwise_a_line_tells_where(self):
        self.assertEqual(self.succeeds("figures", "-o", "out", "--only", "geometry", "-q").err, "")
        told = self.succeeds("figures", "-o", "out", "--only", "geometry").err
        self.assertRegex(told, r"\Aout/index.html: 1 figure, 2 files in ")

    def test_ctrl_c_leaves_pages_of_what_is_done(self):
        process = self.start_candela("figures", "-o", "out", "--spp", "512")
        deadline = time.monotonic() + 60
        while not (self.folder / "out/fresnel-metals-f82.svg").exists():
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, err)
        self.assertIn(b"interrupted", err)
        out = self.folder / "out"
        page = Page(out / "index.html")
        self.assertEqual(page.files() | {"index.html"}, {path.name for path in out.iterdir()})
        self.assertIn("fresnel-metals-f82.svg", page.files())
        self.assertNotIn("riemann-monte-carlo.svg", page.files())

    def test_help_has_an_example(self):
        self.assertIn("candela figures -o figures --only ndf-ggx", self.succeeds("figures", "--help").out)


if __name__ == "__main__":
    candela.main()
