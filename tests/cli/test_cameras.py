"""Named views, lists of cameras, and the names of many pictures."""

import base64
import json
import os
import struct

from candela import TINY, CliTest, main, png_pixels, triangle_glb, variants_gltf

SPHERES = ("render", "demo:spheres", *TINY, "-q")
PLAIN = ("--background", "transparent")


def margins(path):
    """Free pixels at the left, right, top and bottom of what is not transparent."""
    width, height, channels, rows = png_pixels(path)
    assert channels == 4
    covered = [[row[4 * x + 3] > 127 for x in range(width)] for row in rows]
    lines = [y for y in range(height) if any(covered[y])]
    columns = [x for x in range(width) if any(line[x] for line in covered)]
    return columns[0], width - 1 - columns[-1], lines[0], height - 1 - lines[-1]


class Views(CliTest):
    def setUp(self):
        super().setUp()
        (self.folder / "a.glb").write_bytes(triangle_glb())

    def test_margins_are_equal_and_eight_per_cent(self):
        for engine in ("path", "raster"):
            for projection in ("perspective", "orthographic"):
                with self.subTest(engine=engine, projection=projection):
                    self.succeeds("render", "demo:spheres", "--views", "front,iso", "--size", "200x150", "--spp", "4",
                                  "--projection", projection, "--engine", engine, *PLAIN, "-q")  # fmt: skip
                    for view in ("front", "iso"):
                        left, right, top, bottom = margins(self.folder / f"spheres-{view}.png")
                        self.assertLessEqual(abs(left - right), 1)
                        self.assertLessEqual(abs(top - bottom), 1)
                        self.assertTrue(abs(left - 16) <= 1 or abs(top - 12) <= 1, (left, top))
                        self.assertGreaterEqual(min(left, right), 15)
                        self.assertGreaterEqual(min(top, bottom), 11)

    def test_a_margin_is_a_share_or_per_cent(self):
        for value in ("0.2", "20%"):
            self.succeeds("render", "a.glb", "--margin", value, "--size", "100x100", "--spp", "4", *PLAIN, "-q")
            left, right, _, _ = margins(self.folder / "a.png")
            self.assertLessEqual(max(abs(left - 20), abs(right - 20)), 1)

    def test_what_does_not_exist_lists_what_does(self):
        (self.folder / "a.glb").unlink()
        self.refuses(*SPHERES, "--views", "front,sideways", says='"sideways" .known: front, back, left, right, top')
        self.refuses(*SPHERES, "--views", "front,front", says="twice")
        self.refuses(*SPHERES, "--views", "front,", says="empty")
        self.refuses(*SPHERES, "--projection", "fisheye", says="none of perspective, orthographic")
        self.refuses(*SPHERES, "--margin", "50%", says="--margin")
        self.refuses(*SPHERES, "--views", "front", "--orbit", "1,2", says="--views|--orbit")
        self.refuses(*SPHERES, "--camera", "0", "--margin", "0.1", says="--margin: not for a camera")

    def test_names_have_places_for_what_distinguishes(self):
        self.succeeds(*SPHERES, "--views", "front,top", "-o", "x-{view}.png")
        self.succeeds(*SPHERES, "--views", "front,top", "-o", "n%02d.png")
        self.succeeds(*SPHERES, "--views", "front", "-o", "one.png")
        self.succeeds(*SPHERES, "--views", "front,top", "--turntable", "2", "-o", "t-{view}-%d.png")
        self.assertEqual(self.files(), ["a.glb", "n00.png", "n01.png", "one.png", "t-front-0.png", "t-front-1.png",
                                        "t-top-0.png", "t-top-1.png", "x-front.png", "x-top.png"])  # fmt: skip

    def test_names_without_them_are_refused(self):
        (self.folder / "a.glb").unlink()
        self.refuses(*SPHERES, "--views", "front,top", "-o", "x.png", says="NAME-{view}.png")
        self.refuses(*SPHERES, "-o", "x-{view}.png", says="only --views fills")
        self.refuses(*SPHERES, "--turntable", "2", "--views", "front,top", "-o", "{view}.png", says="NAME%03d")
        self.refuses(*SPHERES, "--cameras", "sphere:2", "-o", "x.png", says="NAME-{camera}.png")

    def test_several_scenes_have_several_views(self):
        self.succeeds("render", "a.glb", "demo:spheres", "--views", "front,top", *TINY, "-q", "-o", "out/")
        names = sorted(path.name for path in (self.folder / "out").iterdir())
        self.assertEqual(names, ["a-front.png", "a-top.png", "spheres-front.png", "spheres-top.png"])


class Cameras(CliTest):
    def test_pictures_through_written_cameras_are_the_same(self):
        for engine in ("path", "raster"):
            self.succeeds(*SPHERES, "--engine", engine, "--views", "front,iso", "-o", "a-{view}.png",
                          "--write-cameras", "cameras.gltf")  # fmt: skip
            for file in ("cameras.gltf", "list.json", "transforms.json"):
                with self.subTest(engine=engine, file=file):
                    self.succeeds(*SPHERES, "--engine", engine, "--views", "front,iso", "--write-cameras", file)
                    self.succeeds(*SPHERES, "--engine", engine, "--cameras", file, "-o", "b%d.png")
                    for i, view in enumerate(("front", "iso")):
                        expected = png_pixels(self.folder / f"a-{view}.png")[3]
                        found = png_pixels(self.folder / f"b{i}.png")[3]
                        worst = max(abs(a - b) for x, y in zip(expected, found) for a, b in zip(x, y))
                        self.assertLessEqual(worst, 3)

    def test_a_list_brings_its_size_and_its_names(self):
        entry = {"name": "left/eye", "size": [10, 6], "axes": "opengl", "K": [[20, 0, 5], [0, 20, 3], [0, 0, 1]],
                 "world_from_camera": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 2], [0, 0, 0, 1]]}  # fmt: skip
        (self.folder / "c.json").write_text(json.dumps([entry, {**entry, "name": "right"}]))
        self.succeeds("render", "demo:spheres", "--spp", "1", "-q", "--cameras", "c.json")
        self.assertEqual(self.files(), ["c.json", "spheres-left-eye.png", "spheres-right.png"])
        self.assertEqual(png_pixels(self.folder / "spheres-right.png")[:2], (10, 6))
        self.succeeds("render", "demo:spheres", "--spp", "1", "-q", "--cameras", "c.json", "--size", "20x12")
        self.assertEqual(png_pixels(self.folder / "spheres-right.png")[:2], (20, 12))
        self.fails("render", "demo:spheres", "-q", "--cameras", "c.json", "--size", "16x16", says="not the shape")
        (self.folder / "c.json").write_text(json.dumps([entry, entry]))
        self.fails("render", "demo:spheres", "-q", "--cameras", "c.json", "-o", "n-{camera}.png", says="written twice")
        (self.folder / "c.json").write_text(json.dumps([entry]))
        self.fails("render", "demo:spheres", "-q", "--cameras", "c.json", "--write-cameras", "c.json", says="an input")

    def test_an_axis_beside_the_middle_is_where_both_engines_have_it(self):
        (self.folder / "a.glb").write_bytes(triangle_glb())
        entry = {"size": [64, 48], "axes": "opengl", "K": [[60, 0, 28], [0, 50, 30], [0, 0, 1]],
                 "world_from_camera": [[1, 0, 0, 0], [0, 1, 0, 1], [0, 0, 1, 3], [0, 0, 0, 1]]}  # fmt: skip
        (self.folder / "c.json").write_text(json.dumps([entry]))
        for engine in ("path", "raster"):
            self.succeeds("render", "a.glb", "--cameras", "c.json", "--engine", engine, "--spp", "16", *PLAIN, "-q", "-o", "a.png")
            # The corners are at 28 - 20, 28 + 20 and at 30 - 16.7, 30 + 16.7.
            for found, expected in zip(margins(self.folder / "a.png"), (8, 16, 13.3, 1.3)):
                self.assertLessEqual(abs(found - expected), 1.7)

    def test_damaged_lists_are_one_line(self):
        self.fails(*SPHERES, "--cameras", "none.json", says="none.json")
        (self.folder / "empty.json").write_text("")
        self.fails(*SPHERES, "--cameras", "empty.json", says="is empty")
        frame = {"transform_matrix": [[1, 0, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}
        (self.folder / "t.json").write_text(json.dumps({"camera_angle_x": 1, "frames": [frame]}))
        self.fails(*SPHERES, "--cameras", "t.json", says="t.json#/frames/0/transform_matrix: the matrix is singular")

    def test_places_on_a_sphere_are_numbered_and_depend_on_the_seed(self):
        self.succeeds(*SPHERES, "--cameras", "sphere:3", "--write-cameras", "transforms.json")
        self.assertEqual(self.files(), [*(f"spheres-00{i}.png" for i in range(3)), "transforms.json"])
        poses = []
        for seed in ("", ",1", ",2", ",2"):
            self.succeeds(*SPHERES, "--cameras", "sphere:3" + seed, "--write-cameras", "transforms.json")
            frames = json.loads((self.folder / "transforms.json").read_text())["frames"]
            self.assertEqual(frames[1]["file_path"], "spheres-001.png")
            poses.append([frame["transform_matrix"] for frame in frames])
        (self.folder / "train").mkdir()
        self.succeeds(*SPHERES, "--cameras", "sphere:2", "-o", "train/{camera}.png", "--write-cameras", "train/transforms.json")
        frames = json.loads((self.folder / "train/transforms.json").read_text())["frames"]
        self.assertEqual([frame["file_path"] for frame in frames], ["000.png", "001.png"])
        self.assertNotEqual(poses[0], poses[1])
        self.assertNotEqual(poses[1], poses[2])
        self.assertEqual(poses[2], poses[3])
        self.assertEqual(self.run_candela(*SPHERES, "--cameras", "sphere:0").code, 2)
        self.assertEqual(self.run_candela(*SPHERES, "--write-cameras", "x.png").code, 2)


class Variants(CliTest):
    def setUp(self):
        super().setUp()
        (self.folder / "v.gltf").write_text(variants_gltf())

    def test_each_variant_has_its_look_in_every_view(self):
        for engine in ("path", "raster"):
            with self.subTest(engine=engine):
                self.succeeds("render", "v.gltf", *TINY, "-q", "--engine", engine, "--variants", "all", "--views",
                              "front,three-quarter", "--env", "none", "--exposure", "0")  # fmt: skip
                self.assertEqual(self.files(), ["v-noon-front.png", "v-noon-three-quarter.png", "v-sunset-front.png",
                                                "v-sunset-three-quarter.png", "v.gltf"])  # fmt: skip
                for variant, color in (("noon", 1), ("sunset", 0)):
                    for view in ("front", "three-quarter"):
                        _, _, channels, rows = png_pixels(self.folder / f"v-{variant}-{view}.png")
                        pixel = rows[6][8 * channels : 8 * channels + 3]
                        self.assertEqual(max(range(3), key=lambda c: pixel[c]), color)
                        self.assertGreater(pixel[color], 100)

    def test_a_set_has_the_pictures_that_each_variant_has_alone(self):
        for engine in ("path", "raster"):
            with self.subTest(engine=engine):
                options = ("render", "v.gltf", *TINY, "-q", "--engine", engine, "--views", "front,top", "--env", "sky",
                           "--exposure", "0")  # fmt: skip
                self.succeeds(*options, "--variants", "all", "-o", "set-{variant}-{view}.png")
                for variant in ("noon", "sunset"):
                    self.succeeds(*options, "--variant", variant, "-o", "one-{view}.png")
                    for view in ("front", "top"):
                        alone = (self.folder / f"one-{view}.png").read_bytes()
                        self.assertEqual(alone, (self.folder / f"set-{variant}-{view}.png").read_bytes(), (variant, view))

    def test_what_the_file_has_not_is_told_before_any_picture(self):
        self.fails("render", "v.gltf", *TINY, "--variants", "noon,rain", says="'rain'; the file has: noon, sunset")
        self.fails("render", "demo:spheres", *TINY, "--variants", "all", says="no variants")
        self.fails("render", "v.gltf", *TINY, "--animations", "all", says="no animations")
        self.assertEqual(self.run_candela("render", "v.gltf", "--variants", "all", "--variant", "noon").code, 2)


def moving_gltf():
    """A triangle of 2 m that moves by 10 m to the right within a second."""
    numbers = struct.pack("<9f", -1, 0, 0, 1, 0, 0, 0, 2, 0) + struct.pack("<2f", 0, 1) + struct.pack("<6f", 0, 0, 0, 10, 0, 0)
    uri = "data:application/octet-stream;base64," + base64.b64encode(numbers).decode()

    def accessor(view, count, kind):
        return {"bufferView": view, "componentType": 5126, "count": count, "type": kind}

    channel = {"sampler": 0, "target": {"node": 0, "path": "translation"}}
    return json.dumps({
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "animations": [{"name": name, "channels": [channel], "samplers": [{"input": 1, "output": 2}]}
                       for name in ("go", "walk")],
        "accessors": [accessor(0, 3, "VEC3"), {**accessor(1, 2, "SCALAR"), "min": [0], "max": [1]}, accessor(2, 2, "VEC3")],
        "bufferViews": [{"buffer": 0, "byteOffset": at, "byteLength": size} for at, size in ((0, 36), (36, 8), (44, 24))],
        "buffers": [{"byteLength": len(numbers), "uri": uri}],
    })  # fmt: skip


class Moving(CliTest):
    def setUp(self):
        super().setUp()
        (self.folder / "m.gltf").write_text(moving_gltf())

    def test_what_moves_stays_in_the_pictures_of_a_sequence(self):
        for engine in ("path", "raster"):
            self.succeeds("render", "m.gltf", "--sequence", "4", "--size", "120x60", "--spp", "4", "--engine", engine,
                          *PLAIN, "-q")  # fmt: skip
            found = [margins(self.folder / f"m-00{i}.png") for i in range(4)]
            self.assertGreaterEqual(min(min(sides[:2]) for sides in found), 8)
            self.assertLessEqual(abs(found[0][0] - found[3][1]), 2)
            self.assertTrue(all(a[0] < b[0] for a, b in zip(found, found[1:])))

    def test_several_animations_are_shown_in_one_run(self):
        self.succeeds("render", "m.gltf", "--animations", "all", "--sequence", "2", *TINY, "-q")
        self.succeeds("render", "m.gltf", "--animations", "walk,0", "--views", "front", "--frame-time", "1", *TINY, "-q")
        self.assertEqual(self.files(), ["m-0-front.png", *(f"m-{a}-00{i}.png" for a in ("go",) for i in range(2)), "m-walk-000.png",
                                        "m-walk-001.png", "m-walk-front.png", "m.gltf"])  # fmt: skip
        self.fails("render", "m.gltf", "--animations", "go,fly", *TINY, says="fly")


class Films(CliTest):
    RASTER = ("render", "demo:spheres", "--size", "48x32", "--engine", "raster", "-q")

    def test_a_film_has_all_pictures_and_is_one_file(self):
        self.succeeds(*self.RASTER, "--turntable", "3", "-o", "a.gif", "-o", "a.webp", "-o", "s%d.png")
        self.assertEqual(self.files(), ["a.gif", "a.webp", "s0.png", "s1.png", "s2.png"])
        gif = (self.folder / "a.gif").read_bytes()
        self.assertEqual(gif[:6], b"GIF89a")
        self.assertEqual(struct.unpack("<2H", gif[6:10]), (48, 32))
        self.assertEqual(gif.count(b"!\xf9\x04"), 3)
        webp = (self.folder / "a.webp").read_bytes()
        self.assertEqual(webp[8:16], b"WEBPVP8X")
        self.assertEqual(webp.count(b"ANMF"), 3)

    def test_each_view_has_its_film(self):
        self.succeeds(*self.RASTER, "--turntable", "2", "--views", "front,iso", "-o", "{view}.gif", "--fps", "10")
        self.assertEqual(self.files(), ["front.gif", "iso.gif"])
        for name in self.files():
            self.assertIn(b"!\xf9\x04\x04\x0a\x00", (self.folder / name).read_bytes())

    def test_a_sequence_is_as_fast_as_its_animation(self):
        (self.folder / "m.gltf").write_text(moving_gltf())
        self.succeeds("render", "m.gltf", "--sequence", "5", "--size", "40x20", "--engine", "raster", "-q", *PLAIN,
                      "-o", "m.gif")  # fmt: skip
        self.assertIn(b"!\xf9\x04\x09\x14\x00\xff", (self.folder / "m.gif").read_bytes())

    def test_what_is_no_film_is_refused(self):
        self.refuses(*self.RASTER, "-o", "a.gif", says="give --turntable")
        self.refuses(*self.RASTER, "--turntable", "2", "-o", "a%d.gif", says="no place for a number")
        self.refuses(*self.RASTER, "--turntable", "2", "-o", "a%d.png", "--fps", "9", says="only for a film")
        self.fails(*self.RASTER, "--turntable", "2", "-o", "a.gif", "--fps", "60", says="at most 50")

    def test_ffmpeg_that_is_missing_or_dies_is_one_line(self):
        environment = {**os.environ, "PATH": str(self.folder)}
        film = (*self.RASTER, "--turntable", "2", "-o", "a.mp4")
        self.fails(*film, says="not installed", env=environment)
        program = self.folder / "ffmpeg"
        program.write_text("#!/bin/sh\necho no codec >&2\nexit 1\n")
        program.chmod(0o755)
        self.fails(*film, says=r"a.mp4: ffmpeg has failed .exit code 1.: no codec", env=environment)


if __name__ == "__main__":
    main()
