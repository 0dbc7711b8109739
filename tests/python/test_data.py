"""Data sets, films and lists of cameras that are written from Python."""

import importlib.util
import json
import os
import pathlib
import tempfile
import threading
import unittest

import numpy

import candela
from support import FRONT, Case, draw, has_opengl, main, quad, run_python, small_scene

ENGINES = ["path"] + (["raster"] if has_opengl() else [])
needs_coco = unittest.skipUnless(importlib.util.find_spec("pycocotools"), "pycocotools is not installed")


def load(*parts):
    return json.loads(pathlib.Path(*parts).read_text())


class Objects(Case):
    def test_masks_are_where_the_layer_says(self):
        for engine in ENGINES:
            picture = draw(small_scene(), engine=engine, objects=True)
            seen = candela.seen_objects(picture)
            self.assertEqual([one.name for one in seen], ["square", "wall"])
            for one in seen:
                numpy.testing.assert_array_equal(one.mask, picture["instance"] == one.number)
                self.assertEqual((one.mask.shape, one.mask.dtype), ((24, 32), numpy.bool_))
                self.assertFalse((one.mask & ~one.amodal).any())
                self.assertAlmostEqual(one.visible_fraction, one.mask.sum() / one.amodal.sum(), 5)
                rows, columns = numpy.nonzero(one.mask)
                self.assertEqual(one.box, (columns.min(), rows.min(), columns.max() - columns.min() + 1,
                                           rows.max() - rows.min() + 1))  # fmt: skip
            square, wall = seen
            self.assertEqual(square.visible_fraction, 1.0)
            self.assertLess(wall.visible_fraction, 1.0)
            self.assertGreater((wall.amodal & square.mask).sum(), 10)  # behind it

    def test_what_is_wholly_hidden_has_no_box(self):
        scene = small_scene()
        scene.add(scene.meshes["square"], transform=numpy.diag([0.2, 0.2, 0.2, 1]), name="hidden").position = (0, 0, -1)
        hidden = candela.seen_objects(draw(scene, objects=True))[-1]
        self.assertEqual((hidden.name, hidden.box, hidden.visible_fraction), ("hidden", None, 0.0))
        self.assertGreater(hidden.amodal.sum(), 0)

    def test_whole_scene_is_one_object(self):
        picture = draw(small_scene(), objects=True)
        (one,) = candela.seen_objects(picture, instances="scene", name="all")
        self.assertEqual((one.name, one.category, one.number), ("all", "all", 1))
        numpy.testing.assert_array_equal(one.mask, picture["instance"] > 0)

    def test_they_are_those_of_the_scene_as_it_was(self):
        scene = small_scene()
        picture = draw(scene, objects=True)
        before = candela.seen_objects(picture)
        scene.nodes["square"].name = "other"
        scene.nodes["wall"].mesh = None
        self.assertEqual([one.name for one in candela.seen_objects(picture)], [one.name for one in before])
        self.assertEqual([one.name for one in candela.seen_objects(draw(scene, objects=True))], ["other"])

    def test_picture_that_does_not_know_them_is_refused(self):
        self.refuses(["picture", "objects=True"], candela.seen_objects, draw(small_scene()))
        self.refuses("unknown", candela.seen_objects, draw(small_scene(), objects=True), instances="mesh")

    @needs_coco
    def test_run_lengths_are_those_of_pycocotools(self):
        from pycocotools import mask as coco

        random = numpy.random.default_rng(3)
        for shape in ((1, 1), (7, 5), (64, 48)):
            for share in (0.0, 0.02, 0.5, 1.0):
                bits = random.random(shape) < share
                ours = candela.run_lengths(bits)
                theirs = coco.encode(numpy.asfortranarray(bits.astype("uint8")))
                self.assertEqual((ours["size"], ours["counts"]), (list(theirs["size"]), theirs["counts"].decode()))
                numpy.testing.assert_array_equal(coco.decode(ours), bits)


class Datasets(Case):
    def write(self, kind, folder, pictures, **options):
        with candela.Dataset(kind, folder, **options) as data:
            return [data.add(picture) for picture in pictures]

    def pictures(self, scene=None):
        scene = scene or small_scene()
        for azimuth in (0, 15):
            yield draw(scene, camera=candela.orbit(azimuth, 10, 1.2), objects=True)

    def test_coco_has_every_object_of_every_picture(self):
        with tempfile.TemporaryDirectory() as folder:
            pictures = list(self.pictures())
            files = self.write("coco", folder, pictures)
            self.assertEqual([os.path.relpath(f, folder) for f in files], ["images/000000.png", "images/000001.png"])
            made = load(folder, "annotations.json")
            self.assertEqual([image["file_name"] for image in made["images"]], ["images/000000.png", "images/000001.png"])
            seen = [one for picture in pictures for one in candela.seen_objects(picture)]
            self.assertEqual([a["name"] for a in made["annotations"]], [one.name for one in seen])
            for annotation, one in zip(made["annotations"], seen):
                self.assertEqual(annotation["segmentation"], candela.run_lengths(one.mask))
                self.assertEqual(tuple(annotation["bbox"]), one.box)
                self.assertEqual(annotation["area"], one.mask.sum())

    @needs_coco
    def test_pycocotools_reads_the_set(self):
        from pycocotools.coco import COCO

        with tempfile.TemporaryDirectory() as folder:
            pictures = list(self.pictures())
            self.write("coco", folder, pictures)
            theirs = COCO(os.path.join(folder, "annotations.json"))
            for image, picture in zip(theirs.getImgIds(), pictures):
                annotations = theirs.loadAnns(theirs.getAnnIds(imgIds=[image]))
                for annotation, one in zip(annotations, candela.seen_objects(picture)):
                    numpy.testing.assert_array_equal(theirs.annToMask(annotation), one.mask)

    def test_set_is_that_of_the_program(self):
        with tempfile.TemporaryDirectory() as folder:
            for kind in ("coco", "masks", "bop", "transforms"):
                ran = run_python(f"""
                    from candela import _candela
                    _candela.run_program(['render', 'demo:spheres', '--dataset', {kind!r}, '-o', {folder!r} + '/program', '-q',
                                          '--size', '48x32', '--spp', '4', '--views', 'front,left', '--exposure=0'])
                    """)
                self.assertEqual(ran.returncode, 0, ran.stderr)
                scene = candela.load("demo:spheres")
                self.write(kind, os.path.join(folder, "python"),
                           [candela.render(scene, size=(48, 32), spp=4, camera=candela.fit(view), objects=True, exposure=0.0)
                            for view in ("front", "left")])  # fmt: skip
                ours, theirs = (self.contents(pathlib.Path(folder, name)) for name in ("python", "program"))
                self.assertEqual(sorted(ours), sorted(theirs))
                for name in ours:
                    with self.subTest(kind=kind, name=name):
                        self.assertEqual(ours[name], theirs[name])

    def contents(self, folder):
        """Of every file of a folder, which is emptied."""
        found = {}
        for path in sorted(folder.rglob("*")):
            if path.is_file():
                found[str(path.relative_to(folder))] = path.read_bytes()
                path.unlink()
        return found

    def test_scenes_of_bop_are_told_apart_and_share_no_models(self):
        one, two = small_scene(), small_scene()
        two.nodes["wall"].mesh = None
        with tempfile.TemporaryDirectory() as folder:
            with candela.Dataset("bop", folder) as data:
                for scene in (one, two, one):
                    data.add(draw(scene, objects=True))
                data.add(draw(two, objects=True), name="another")
            counts = {name: len(load(folder, "train_pbr", name, "scene_gt.json"))
                      for name in sorted(os.listdir(os.path.join(folder, "train_pbr")))}  # fmt: skip
            self.assertEqual(counts, {"000000": 2, "000001": 1, "000002": 1})
            self.assertEqual(sorted(load(folder, "models", "models_info.json")), ["1", "2", "3", "4"])

    def test_poses_of_bop_are_those_of_nodes_and_camera(self):
        scene = small_scene()
        with tempfile.TemporaryDirectory() as folder:
            picture = draw(scene, objects=True)
            self.write("bop", folder, [picture])
            (pose, _) = load(folder, "train_pbr/000000/scene_gt.json")["0"]
            camera_from_world = numpy.linalg.inv(picture.camera.world_from_camera)
            expected = camera_from_world @ scene.nodes["square"].world_from_node
            numpy.testing.assert_allclose(numpy.reshape(pose["cam_R_m2c"], (3, 3)), expected[:3, :3], atol=1e-5)
            numpy.testing.assert_allclose(pose["cam_t_m2c"], 1000 * expected[:3, 3], atol=0.05)

    def test_categories_are_the_scenes_where_that_is_wished(self):
        with tempfile.TemporaryDirectory() as folder:
            with candela.Dataset("coco", folder, instances="scene") as data:
                for name in ("cup", "shoe", "cup"):
                    data.add(draw(small_scene(), objects=True), name=name)
            made = load(folder, "annotations.json")
            self.assertEqual([c["name"] for c in made["categories"]], ["cup", "shoe"])
            self.assertEqual([a["category_id"] for a in made["annotations"]], [1, 2, 1])

    def test_orders_are_refused_and_what_is_there_is_described(self):
        with tempfile.TemporaryDirectory() as folder:
            self.refuses(["unknown data set", "coco"], candela.Dataset, "voc", folder)
            self.refuses(["unknown", "node"], candela.Dataset, "coco", folder, instances="mesh")
            self.refuses(["instances", "no objects"], candela.Dataset, "transforms", folder, instances="scene")
            with self.assertRaises(candela.Error), candela.Dataset("coco", folder) as data:
                data.add(draw(small_scene(), objects=True))
                data.add(draw(small_scene()))
            self.assertEqual(len(load(folder, "annotations.json")["images"]), 1)
            self.refuses("finished", data.add, draw(small_scene(), objects=True))
            for kind in ("bop", "transforms"):
                flat = draw(small_scene(), camera=candela.fit("front", orthographic=True), objects=True)
                self.refuses("orthographic", self.write, kind, os.path.join(folder, kind), [flat])
                self.assertFalse(os.path.exists(os.path.join(folder, kind)))
            taken = os.path.join(folder, "file")
            pathlib.Path(taken).write_text("")
            self.refuses("file", self.write, "coco", taken, self.pictures())

    def test_threads_may_add_to_one_set(self):
        with tempfile.TemporaryDirectory() as folder:
            with candela.Dataset("coco", folder) as data:
                threads = [threading.Thread(target=lambda: [data.add(p) for p in self.pictures()]) for _ in range(3)]
                for thread in threads:
                    thread.start()
                for thread in threads:
                    thread.join()
            made = load(folder, "annotations.json")
            self.assertEqual([image["file_name"] for image in made["images"]], [f"images/{i:06}.png" for i in range(6)])
            self.assertEqual([a["id"] for a in made["annotations"]], list(range(1, 13)))

    def test_far_depths_are_told_once(self):
        scene = candela.Scene("far")
        scene.add(quad(scene), transform=numpy.diag([100, 100, 1, 1]))
        picture = draw(scene, camera=candela.look_at((0, 0, 90), (0, 0, 0)), objects=True, environment="furnace")
        with tempfile.TemporaryDirectory() as folder, self.assertWarnsRegex(candela.Warning, "65.535"):
            self.write("transforms", folder, [picture, picture])


class Cameras(Case):
    def test_lists_come_back_as_they_were_written(self):
        cameras = [draw(small_scene(), camera=candela.orbit(a, 20, 1.1), spp=1).camera for a in (0, 50, 200)]
        with tempfile.TemporaryDirectory() as folder:
            for name in ("transforms.json", "list.json"):
                path = os.path.join(folder, name)
                candela.write_cameras(path, cameras)
                again = candela.read_cameras(path)
                self.assertEqual(len(again), 3)
                for one, other in zip(cameras, again):
                    self.assertEqual(one.size, other.size)
                    numpy.testing.assert_allclose(one.K, other.K, rtol=1e-5, atol=1e-5)
                    numpy.testing.assert_allclose(one.world_from_camera, other.world_from_camera, atol=1e-5)
            candela.write_cameras(os.path.join(folder, "transforms.json"), cameras, files=["a.png", pathlib.Path("b.png"), "c.png"])
            frames = load(folder, "transforms.json")["frames"]
            self.assertEqual([frame["file_path"] for frame in frames], ["a.png", "b.png", "c.png"])
            numpy.testing.assert_allclose(frames[1]["transform_matrix"], cameras[1].pose("opengl"), atol=1e-5)

    def test_what_is_no_list_is_refused(self):
        cameras = [draw(small_scene(), spp=1, size=size).camera for size in ((32, 24), (16, 16))]
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "transforms.json")
            self.refuses(["number 1", "16x16", "32x24"], candela.write_cameras, path, cameras)
            self.refuses(["cameras", "none"], candela.write_cameras, path, [])
            self.refuses(["files", "2 names for 1"], candela.write_cameras, path, cameras[:1], files=["a", "b"])
            self.refuses("a.txt", candela.write_cameras, os.path.join(folder, "a.txt"), cameras[:1])
            self.assertEqual(os.listdir(folder), [])


class Films(Case):
    def test_film_has_the_pictures_and_their_pace(self):
        colors = [(255, 0, 0), (0, 255, 0), (0, 0, 255)]
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.webp")
            with candela.Movie(path, fps=10) as film:
                for color in colors:
                    film.add(numpy.full((24, 32, 3), color, "uint8"))
                self.assertEqual(len(film), 3)
                self.assertFalse(os.path.exists(path))
            data = pathlib.Path(path).read_bytes()
            self.assertEqual((data[:4], data[8:12]), (b"RIFF", b"WEBP"))
            self.assertEqual(data.count(b"ANMF"), 3)
            at = data.index(b"ANMF") + 8
            self.assertEqual(int.from_bytes(data[at + 12 : at + 15], "little"), 100)  # milliseconds
            gif = os.path.join(folder, "a.gif")
            with candela.Movie(pathlib.Path(gif), fps=10) as film:
                film.add(draw(small_scene()))
            self.assertTrue(pathlib.Path(gif).read_bytes().startswith(b"GIF89a"))

    def test_picture_is_shown_as_its_file_would(self):
        picture = draw(small_scene())
        with tempfile.TemporaryDirectory() as folder:
            names = [os.path.join(folder, name) for name in ("a.gif", "b.gif", "c.gif")]
            for name, add in zip(names, (lambda f: f.add(picture), lambda f: f.add(picture.develop()),
                                         lambda f: f.add(picture, exposure=2.0))):  # fmt: skip
                with candela.Movie(name) as film:
                    add(film)
            first, second, third = (pathlib.Path(name).read_bytes() for name in names)
            self.assertEqual(first, second)
            self.assertNotEqual(first, third)

    def test_nothing_is_left_of_a_film_that_failed(self):
        with tempfile.TemporaryDirectory() as folder:
            with self.assertRaises(ZeroDivisionError), candela.Movie(os.path.join(folder, "a.webp")) as film:
                film.add(draw(small_scene()))
                1 / 0
            self.refuses("finished", film.add, draw(small_scene()))
            self.refuses("no picture", lambda: candela.Movie(os.path.join(folder, "b.gif")).finish())
            self.refuses("a film is", candela.Movie, os.path.join(folder, "a.png"))
            self.refuses("per second", candela.Movie, os.path.join(folder, "a.gif"), fps=0)
            self.refuses("array of bytes", candela.Movie(os.path.join(folder, "a.gif")).add,
                         numpy.zeros((4, 4), "uint8"), exposure=1.0)  # fmt: skip
            self.assertEqual(os.listdir(folder), [])


if __name__ == "__main__":
    main()
