#!/usr/bin/env python3
"""Pictures as other programs write them, as light: what their headers say is followed by every verb alike, and told."""

import json
import math
import struct

import candela
from candela import CliTest, png_pixels

P3 = (0.68, 0.32, 0.265, 0.69, 0.15, 0.06, 0.3127, 0.329)
SPHERES = ("render", "demo:spheres", "--size", "24x24", "--spp", "8", "--threads", "2", "--tonemap", "linear")
ENGINES = ("path", "raster")


def hdr(width, height, texel, lines=("FORMAT=32-bit_rle_rgbe",), size=None):
    """A Radiance file without run lengths; `texel(x, y)` gives four bytes."""
    body = b"".join(bytes(texel(x, y)) for y in range(height) for x in range(width))
    head = "\n".join(("#?RADIANCE", *lines, "", size or f"-Y {height} +X {width}", ""))
    return head.encode() + body


def attribute(name, kind, body):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(body)) + body


def exr(width, height, channels, *attributes):
    """An uncompressed OpenEXR file of 32-bit floats; `channels` are functions of (x, y) by name."""
    names = sorted(channels)
    listed = b"".join(n.encode() + b"\0" + struct.pack("<iB3xii", 2, 0, 1, 1) for n in names) + b"\0"
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    head = b"\x76\x2f\x31\x01\x02\0\0\0" + b"".join(
        (
            attribute("channels", "chlist", listed),
            attribute("compression", "compression", b"\0"),
            attribute("dataWindow", "box2i", window),
            attribute("displayWindow", "box2i", window),
            attribute("lineOrder", "lineOrder", b"\0"),
            attribute("pixelAspectRatio", "float", struct.pack("<f", 1)),
            attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)),
            attribute("screenWindowWidth", "float", struct.pack("<f", 1)),
            *attributes,
            b"\0",
        )
    )
    line = 4 * len(names) * width
    first = len(head) + 8 * height
    offsets = b"".join(struct.pack("<Q", first + y * (8 + line)) for y in range(height))
    rows = (struct.pack(f"<{len(names) * width}f", *(channels[n](x, y) for n in names for x in range(width))) for y in range(height))
    return head + offsets + b"".join(struct.pack("<ii", y, line) + row for y, row in enumerate(rows))


def grey(value, prefix=""):
    return {prefix + name: (lambda x, y: value) for name in "RGB"}


def openexr_cube(size):
    """Faces as ImfEnvmap.h has them, each of one colour: +x -x +y -y +z -z are 1 2 3 4 5 6."""
    return exr(size, 6 * size, {n: (lambda x, y: 1.0 + y // size) for n in "RGB"}, attribute("envmap", "envmap", b"\1"))


def mean_of_hdr(path):
    """Mean red of a picture too narrow for run lengths."""
    data = path.read_bytes()
    body = data[data.index(b"\n", data.index(b"\n\n") + 2) + 1 :]
    values = [body[i] * 2.0 ** (body[i + 3] - 136) for i in range(0, len(body), 4)]
    return sum(values) / len(values)


def rgbe_faces(folder):
    """Mean red of each face of a bake, by name."""
    return {face: mean_of_hdr(folder / f"specular_{face}.hdr") for face in ("px", "nx", "py", "ny", "pz", "nz")}


class Pictures(CliTest):
    def write(self, name, data):
        (self.folder / name).write_bytes(data)

    def pixels(self, *arguments):
        self.succeeds(*SPHERES, "-o", "out.png", *arguments)
        return png_pixels(self.folder / "out.png")[3]

    def faces(self, name, *arguments):
        self.succeeds("bake", name, "-o", "out", "--levels", "1", "--size", "4", "--mapping", "linear", "--format", "hdr", "--proof", "0", *arguments)
        return rgbe_faces(self.folder / "out")

    def attributes(self, name):
        return {a["name"]: a for a in json.loads(self.succeeds("info", name, "--json").out)["attributes"]}

    def test_texels_that_are_no_light_are_put_right_by_every_verb(self):
        self.write("good.exr", exr(16, 8, grey(0.5)))
        for value in (-1e-4, math.nan, math.inf):
            self.write("odd.exr", exr(16, 8, {**grey(0.5), "R": lambda x, y: value if (x, y) == (5, 3) else 0.5}))
            for engine in ENGINES:
                told = self.succeeds(*SPHERES, "--engine", engine, "--env", "odd.exr", "-o", "a.png").err
                self.assertRegex(told, "(?m)^warning: odd.exr: 1 texel is (negative|not finite), at 5,3: ")
                strict = self.run_candela(*SPHERES, "--engine", engine, "--env", "odd.exr", "-o", "b.png", "--strict")
                self.assertEqual(strict.code, 1)
                self.assertRegex(strict.err, r"(?m)^candela: odd.exr: .*\(--strict\)$")
                self.assertNotIn("b.png", self.files())
            self.assertRegex(self.succeeds("bake", "odd.exr", "-o", "out", "--size", "4", "--levels", "1", "--proof", "0").err, "at 5,3: ")
        self.assertNotIn("warning", self.succeeds(*SPHERES, "--env", "good.exr", "-o", "a.png").err)

    def test_each_scene_of_a_batch_hears_of_its_light(self):
        self.write("odd.exr", exr(16, 8, {**grey(0.5), "R": lambda x, y: -1.0}))
        for name in ("a.glb", "b.glb"):
            self.write(name, candela.triangle_glb())
        told = self.succeeds("render", "a.glb", "b.glb", "--size", "8x8", "--spp", "1", "--env", "odd.exr", "-o", "all/")
        self.assertEqual(told.err.count("texels are negative"), 2)

    def test_layers_light_in_both_engines_and_bakes(self):
        self.write("plain.exr", exr(16, 8, grey(0.5)))
        self.write("layers.exr", exr(16, 8, {**grey(3.0, "View.DiffDir."), **grey(0.5, "View.Env.")}))
        for engine in ENGINES:
            plain = self.pixels("--engine", engine, "--env", "plain.exr")
            self.assertEqual(self.pixels("--engine", engine, "--env", "layers.exr:View.Env"), plain)
            self.assertNotEqual(self.pixels("--engine", engine, "--env", "layers.exr:View.DiffDir"), plain)
        self.assertEqual(self.faces("layers.exr:View.Env"), self.faces("plain.exr"))
        self.fails(*SPHERES, "--env", "layers.exr", "-o", "a.png", says="FILE:LAYER, of View.DiffDir, View.Env")
        self.fails(*SPHERES, "--env", "layers.exr:Depth", "-o", "a.png", says='no layer "Depth" among the channels')
        self.fails("bake", "plain.exr:Env", "-o", "b", says='no layer "Env"')

    def test_a_file_whose_layer_lights_is_not_overwritten(self):
        self.write("env.exr", exr(16, 8, grey(0.5, "Env.")))
        before = (self.folder / "env.exr").read_bytes()
        self.fails(*SPHERES, "--env", "env.exr:Env", "-o", "env.exr", says="input")
        self.assertEqual((self.folder / "env.exr").read_bytes(), before)

    def test_openexrs_cube_lights_as_its_bake(self):
        self.write("cube.exr", openexr_cube(8))
        faces = self.faces("cube.exr")
        for number, face in enumerate(("px", "nx", "py", "ny", "pz", "nz")):
            # Pictures as seen from inside in files: px is what is looked up by -x.
            want = {"px": 2, "nx": 1}.get(face, number + 1)
            self.assertAlmostEqual(faces[face], want, delta=0.05, msg=face)
        self.write("a.glb", candela.triangle_glb())
        for number, (x, y, z) in enumerate(((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))):
            # From high above the triangle, a little askew, so that there is an up.
            target = f"{x + 0.2 * y},{50 + y},{z + 0.1}"
            self.succeeds("render", "a.glb", "--size", "4x4", "--spp", "1", "--env", "cube.exr", "-o", "a.hdr",
                "--eye", "0,50,0", "--target", target, "--fov", "4deg")  # fmt: skip
            self.assertAlmostEqual(mean_of_hdr(self.folder / "a.hdr"), number + 1, delta=0.05, msg=f"{x} {y} {z}")

    def test_openexrs_cube_lights_as_the_panorama_of_it(self):
        self.write("cube.exr", openexr_cube(32))
        self.write("same.hdr", hdr(128, 64, lambda x, y: (self.face_at(x, y, 128, 64) * 16,) * 3 + (132,)))
        pictures = []
        for light in ("cube.exr", "same.hdr"):
            self.succeeds("render", "demo:row-roughness-metal", "--size", "84x24", "--engine", "raster", "--spp", "4",
                "--tonemap", "linear", "--exposure", "-3", "--env", light, "-o", "a.png")  # fmt: skip
            pictures.append(png_pixels(self.folder / "a.png")[3])
        off = [abs(p - q) for r, s in zip(*pictures) for p, q in zip(r, s)]
        self.assertLess(sum(off) / len(off), 0.3)  # codes; with +x and -x changed for each other it is 2.8

    @staticmethod
    def face_at(x, y, width, height):
        """The number of the face that texel of a panorama looks at, from 1."""
        azimuth, polar = 2 * math.pi * ((x + 0.5) / width - 0.5), math.pi * (y + 0.5) / height
        d = (math.sin(polar) * math.cos(azimuth), math.cos(polar), math.sin(polar) * math.sin(azimuth))
        axis = max(range(3), key=lambda i: abs(d[i]))
        return 1 + 2 * axis + (d[axis] < 0)

    def test_openexrs_panorama_is_turned_a_quarter(self):
        # Its middle is +z, +x is left of it.
        self.write("latlong.exr", exr(64, 32, {n: (lambda x, y: 1.0 + x // 16) for n in "RGB"}, attribute("envmap", "envmap", b"\0")))
        faces = self.faces("latlong.exr")
        # Each face sees the half of two steps; in files px is what is looked up by -x.
        self.assertAlmostEqual(faces["pz"], 2.5, delta=0.1)
        self.assertAlmostEqual(faces["nx"], 1.5, delta=0.1)
        self.assertAlmostEqual(faces["px"], 3.5, delta=0.1)

    def test_colours_of_any_origin_light_alike(self):
        # A grey is grey in every space; the red of Rec.709 is these numbers in P3.
        red_in_p3 = (0.822462, 0.033194, 0.017083)
        self.write("plain.exr", exr(16, 8, dict(zip("RGB", (lambda x, y: 1.0, lambda x, y: 0.0, lambda x, y: 0.0)))))
        channels = {n: (lambda x, y, v=v: v) for n, v in zip("RGB", red_in_p3)}
        self.write("wide.exr", exr(16, 8, channels, attribute("chromaticities", "chromaticities", struct.pack("<8f", *P3))))
        for engine in ENGINES:
            a, b = (self.pixels("--engine", engine, "--env", e) for e in ("plain.exr", "wide.exr"))
            self.assertLess(max(abs(p - q) for r, s in zip(a, b) for p, q in zip(r, s)), 3, engine)

    def test_info_names_what_a_radiance_header_says_and_what_was_done(self):
        lines = ("FORMAT=32-bit_rle_xyze", "EXPOSURE=2", "COLORCORR=1 1 2", "GAMMA=2.2", "PRIMARIES=0 0 0 0 0 0 0 0", "VIEW= -vta")
        self.write("a.hdr", hdr(8, 4, lambda x, y: (90, 100, 110, 136), lines, "+X 4 -Y 8"))
        said = self.attributes("a.hdr")
        self.assertEqual(set(said), {"FORMAT", "EXPOSURE", "COLORCORR", "GAMMA", "PRIMARIES", "VIEW", "order"})
        self.assertEqual([n for n in said if said[n]["warning"]], ["GAMMA"])
        self.assertEqual(said["COLORCORR"]["value"], "1 1 2")
        text = self.succeeds("info", "a.hdr").out
        for name, a in said.items():
            self.assertIn(f"{a['value']}: {a['done']}", text)
            self.assertRegex(text, f"(?m)^{name} ")
        self.assertRegex(text, "(?m)^size +4 x 8")

    def test_info_names_what_an_openexr_header_says_and_what_was_done(self):
        self.write("a.exr", exr(16, 8, {**grey(0.5, "View.Env."), "View.Z.Z": lambda x, y: 9.0},
            attribute("chromaticities", "chromaticities", struct.pack("<8f", *P3)),
            attribute("adoptedNeutral", "v2f", struct.pack("<2f", 0.3, 0)),
            attribute("envmap", "envmap", b"\0"), attribute("whiteLuminance", "float", struct.pack("<f", 100))))  # fmt: skip
        said = self.attributes("a.exr")
        self.assertEqual(set(said), {"layer", "chromaticities", "adoptedNeutral", "envmap", "whiteLuminance"})
        self.assertEqual([n for n in said if said[n]["warning"]], ["adoptedNeutral"])
        self.assertEqual(said["envmap"]["value"], "latlong")
        info = json.loads(self.succeeds("info", "a.exr:View.Z", "--json").out)
        self.assertEqual(info["luminance"]["max"], 9)
        self.assertEqual(info["layers"], ["View.Env", "View.Z"])
        # What could not be followed is heard where it lights.
        told = self.succeeds(*SPHERES, "--env", "a.exr", "-o", "a.png").err
        self.assertRegex(told, "(?m)^warning: a.exr: adoptedNeutral 0.3 0: no white: not used$")
        self.assertEqual(told.count("warning"), 1)

    def test_colours_beyond_rec709_are_no_warning(self):
        wide = {"R": lambda x, y: 0.0, "G": lambda x, y: 1.0, "B": lambda x, y: 0.0}
        self.write("a.exr", exr(16, 8, wide, attribute("chromaticities", "chromaticities", struct.pack("<8f", *P3))))
        self.assertNotIn("warning", self.succeeds(*SPHERES, "--env", "a.exr", "-o", "a.png").err)
        self.assertEqual(self.attributes("a.exr")["gamut"]["value"], "128 pixels beyond Rec.709")

    def test_headers_that_cannot_be_are_one_line(self):
        texel = lambda x, y: (128, 128, 128, 129)  # noqa: E731
        for line in ("COLORCORR=1 2", "COLORCORR=0 0 0", "EXPOSURE=-1", "FORMAT=Radiance_spectra"):
            self.write("a.hdr", hdr(8, 4, texel, (line,)))
            self.fails(*SPHERES, "--env", "a.hdr", "-o", "a.png", says="a.hdr")
            self.fails("info", "a.hdr", says="a.hdr")
        for line in ("PRIMARIES=1 2 3 4 5 6 7", "PRIMARIES=1 1 1 1 1 1 1 1", "PRIMARIES=nan"):
            self.write("a.hdr", hdr(8, 4, texel, (line,)))
            self.assertRegex(self.succeeds(*SPHERES, "--env", "a.hdr", "-o", "a.png").err, "(?m)^warning: a.hdr: PRIMARIES")


class Baked(CliTest):
    def test_cubes_that_a_bake_wrote_light_a_scene(self):
        self.succeeds("bake", "sky:30", "-o", "out", "--size", "32", "--levels", "1", "--mapping", "linear", "--proof", "0", "--format", "ktx2")
        self.succeeds("bake", "sky:30", "-o", "six", "--size", "32", "--levels", "1", "--mapping", "linear", "--proof", "0", "--format", "exr")
        pictures = []
        for light in ("out/specular.ktx2", "six/specular_%s.exr"):
            self.succeeds(*SPHERES, "--env", light, "--exposure", "0", "-o", "a.png")
            pictures.append(png_pixels(self.folder / "a.png")[3])
        off = [abs(p - q) for r, s in zip(*pictures) for p, q in zip(r, s)]
        self.assertLess(max(off), 4)
        self.assertGreater(max(max(r) for r in pictures[0]), 100)


if __name__ == "__main__":
    candela.main()
