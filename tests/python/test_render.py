"""Pictures as arrays: what they hold, who owns them, and what happens while they are made."""

import gc
import os
import pathlib
import tempfile
import threading
import time
import unittest
import warnings

import numpy

import candela
from support import FRONT, Case, draw, has_opengl, main, run_python, small_scene


class Pictures(Case):
    def test_six_lines_give_arrays_of_the_promised_shapes(self):
        scene = candela.load("demo:spheres")
        picture = candela.render(scene, camera=candela.fit("iso"), size=(48, 32), spp=2, layers=["depth", "normal", "id"],
                                 denoise=True)
        self.assertEqual(picture.size, (48, 32))
        self.assertEqual(set(picture.names), {"beauty", "depth", "normal", "id", "noisy"})
        self.assertEqual(picture.names[0], "beauty")
        for name, shape in {"beauty": (32, 48, 4), "depth": (32, 48), "normal": (32, 48, 3), "id": (32, 48)}.items():
            self.assertEqual(picture[name].shape, shape, name)
            self.assertEqual(picture[name].dtype, numpy.float32, name)
        self.assertTrue(picture.is_denoised and picture.is_complete)

    def test_position_is_where_k_and_pose_project_it_to_the_pixel(self):
        for camera in (candela.fit("iso"), candela.look_at((0.3, 0.5, 4.0), (0.2, 0, 0), fov_deg=30)):
            picture = draw(small_scene(), camera=camera, spp=1, layers=["position", "depth", "distance"])
            k, pose = picture.camera.K, picture.camera.world_from_camera
            world = picture["position"].reshape(-1, 3)
            seen = (world - pose[:3, 3]) @ pose[:3, :3]
            pixels = seen @ k.T
            pixels = pixels[:, :2] / pixels[:, 2:]
            y, x = numpy.mgrid[0:24, 0:32]
            hit = numpy.isfinite(picture["depth"]).ravel()
            self.assertGreater(hit.sum(), 100)
            expected = numpy.stack([x.ravel() + 0.5, y.ravel() + 0.5], axis=1)
            numpy.testing.assert_allclose(pixels[hit], expected[hit], atol=2e-3)
            numpy.testing.assert_allclose(seen[hit, 2], picture["depth"].ravel()[hit], rtol=1e-4)
            far = picture["distance"].ravel()[hit]
            numpy.testing.assert_allclose(numpy.linalg.norm(seen[hit], axis=1), far, rtol=1e-4)

    def test_framings_look_from_where_they_say(self):
        for camera, eye, forwards in (
            (candela.look_at((0.3, 0.5, 4.0), (0.3, 0.5, 0)), (0.3, 0.5, 4.0), (0, 0, -1)),
            (candela.fit("left"), None, (1, 0, 0)),
            (candela.fit("top"), None, (0, -1, 0)),
            (candela.orbit(90, 0), None, (-1, 0, 0)),
        ):
            pose = draw(small_scene(), camera=camera, spp=1).camera.world_from_camera
            numpy.testing.assert_allclose(pose[:3, 2], forwards, atol=1e-5)
            if eye:
                numpy.testing.assert_allclose(pose[:3, 3], eye, atol=1e-5)

    def test_camera_of_a_picture_takes_the_same_picture(self):
        scene = small_scene()
        picture = draw(scene, camera=candela.fit("front"), layers=["depth"])
        self.same(draw(scene, camera=picture.camera, layers=["depth"]), picture)
        at = picture.camera
        again = candela.pinhole(at.K, at.world_from_camera, at.size)
        numpy.testing.assert_allclose(draw(scene, camera=again, layers=["depth"])["depth"], picture["depth"], rtol=1e-4)
        opengl = candela.pinhole(at.K, at.pose("opengl"), at.size, axes="opengl")
        numpy.testing.assert_allclose(opengl.world_from_camera, again.world_from_camera, atol=1e-6)

    def test_arrays_share_the_picture_and_outlive_it(self):
        picture = draw(small_scene())
        beauty = picture["beauty"]
        self.assertTrue(numpy.shares_memory(beauty, picture["beauty"]))
        kept = beauty.copy()
        del picture
        gc.collect()
        numpy.testing.assert_array_equal(beauty, kept)

    def test_arrays_go_through_dlpack_without_a_copy(self):
        beauty = draw(small_scene())["beauty"]
        self.assertTrue(numpy.shares_memory(numpy.from_dlpack(beauty), beauty))

    def test_what_is_written_into_an_array_is_in_the_file(self):
        picture = draw(small_scene())
        picture["beauty"][:] = (1.0, 0.0, 0.0, 1.0)
        shown = picture.develop(exposure=0.0, tone_curve="linear")
        self.assertEqual(shown.shape, (24, 32, 4))
        self.assertEqual(shown.dtype, numpy.uint8)
        self.assertEqual(tuple(shown[5, 5]), (255, 0, 0, 255))

    def test_same_arguments_give_the_same_bits_whatever_the_threads(self):
        self.same(draw(small_scene(), threads=1), draw(small_scene(), threads=2))

    def test_picture_is_that_of_the_program(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.exr")
            ran = run_python(f"""
                import sys
                sys.argv[1:] = ['render', 'demo:spheres', '-o', {path!r}, '--size', '32x24', '--spp', '4', '--aov', 'depth', '-q']
                import runpy
                runpy.run_module('candela', run_name='__main__')
                """)
            self.assertEqual(ran.returncode, 0, ran.stderr)
            candela.render(candela.load("demo:spheres"), size=(32, 24), spp=4, layers=["depth"]).save(path + ".exr")
            for layer in candela.diff(path, path + ".exr").layers:
                self.assertEqual((layer.max, layer.changed), (0.0, 0), layer.layer)

    def test_files_are_what_their_names_say(self):
        picture = draw(small_scene(), layers=["depth"])
        heads = {"a.png": b"\x89PNG", "a.jpg": b"\xff\xd8", "a.exr": b"\x76\x2f\x31\x01", "a.hdr": b"#?RADIANCE"}
        with tempfile.TemporaryDirectory() as folder:
            for name, head in heads.items():
                path = pathlib.Path(folder) / name
                picture.save(path, tone_curve="agx")
                self.assertTrue(path.read_bytes().startswith(head), name)
            picture.to_png(os.path.join(folder, "b"))
            self.assertTrue((pathlib.Path(folder) / "b").read_bytes().startswith(b"\x89PNG"))
            self.refuses("unknown", picture.save, os.path.join(folder, "a.tga"))
            self.refuses("no/such", picture.to_png, os.path.join(folder, "no/such/a.png"))
        self.assertTrue(picture._repr_png_().startswith(b"\x89PNG"))

    def test_noise_and_seconds_end_a_picture(self):
        scene = small_scene()
        by_noise = draw(scene, spp=None, noise=0.05)
        self.assertLess(by_noise.statistics["samples_per_pixel"], 4096)
        began = time.monotonic()
        draw(scene, spp=None, seconds=0.3)
        self.assertLess(time.monotonic() - began, 30.0)

    def test_denoised_picture_keeps_the_noisy_one(self):
        picture = draw(small_scene(), denoise=True, spp=4)
        self.differs(picture, draw(small_scene(), spp=4))
        numpy.testing.assert_array_equal(picture["noisy"], draw(small_scene(), spp=4)["beauty"])

    @unittest.skipUnless(has_opengl(), "no usable OpenGL")
    def test_rasterizer_draws_the_same_scene(self):
        picture = draw(small_scene(), engine="raster", spp=4, layers=["depth", "id"])
        self.assertEqual(picture["beauty"].shape, (24, 32, 4))
        traced = draw(small_scene(), layers=["depth", "id"])
        self.assertGreater((picture["id"] == traced["id"]).mean(), 0.95)
        self.assertLess(abs(float(picture["beauty"].mean() / traced["beauty"].mean()) - 1.0), 0.1)


class Progress(Case):
    def test_progress_is_told_on_the_callers_thread_and_grows(self):
        told = []
        draw(small_scene(), size=(256, 192), spp=64,
             progress=lambda p: told.append((threading.get_ident(), p.fraction, p.what)))  # fmt: skip
        self.assertTrue(told)
        self.assertEqual({ident for ident, _, _ in told}, {threading.get_ident()})
        self.assertEqual([fraction for _, fraction, _ in told], sorted(fraction for _, fraction, _ in told))

    def test_what_a_callback_raises_arrives(self):
        class Mine(Exception):
            pass

        def fail(progress):
            raise Mine("here")

        with self.assertRaisesRegex(Mine, "here"):
            draw(small_scene(), size=(512, 384), spp=4096, progress=fail)

    def test_false_stops_and_leaves_the_picture_so_far(self):
        picture = draw(small_scene(), size=(256, 192), spp=65536, progress=lambda p: p.samples_per_pixel < 16)
        self.assertFalse(picture.is_complete)
        self.assertGreaterEqual(picture.statistics["samples_per_pixel"], 16)
        self.assertTrue(numpy.isfinite(picture["beauty"]).all())

    def test_ctrl_c_ends_a_render(self):
        ran = run_python("""
            import _thread, threading, time, candela
            scene = candela.load("demo:spheres")
            threading.Timer(0.5, _thread.interrupt_main).start()
            began = time.monotonic()
            try:
                candela.render(scene, spp=65536)
            except KeyboardInterrupt:
                print("interrupted", time.monotonic() - began < 20)
            """)
        self.assertEqual(ran.stdout.strip(), "interrupted True", ran.stderr)

    def test_other_threads_run_meanwhile(self):
        counted, running = [0], threading.Event()

        def count():
            while not running.is_set():
                counted[0] += 1
                time.sleep(0.001)

        thread = threading.Thread(target=count)
        thread.start()
        draw(small_scene(), size=(256, 192), spp=256)
        running.set()
        thread.join()
        self.assertGreater(counted[0], 10)

    def test_scenes_in_threads_give_what_they_give_alone(self):
        engines = ["path"] + (["raster"] if has_opengl() else [])
        alone = {(engine, seed): draw(small_scene(), engine=engine, **({"seed": seed} if engine == "path" else {}))
                 for engine in engines for seed in range(3)}  # fmt: skip
        shared = small_scene()
        results = {}

        def work(engine, seed):
            scene = shared if seed else small_scene()
            results[engine, seed] = draw(scene, engine=engine, **({"seed": seed} if engine == "path" else {}))

        threads = [threading.Thread(target=work, args=key) for key in alone]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for key, picture in alone.items():
            self.same(results[key], picture)

    def test_python_ends_while_a_thread_renders(self):
        for engine in ["path"] + (["raster"] if has_opengl() else []):
            ran = run_python(f"""
                import threading, time, candela
                scene = candela.load("demo:spheres")
                candela.render(scene, size=(16, 16), spp=1, engine={engine!r})
                threading.Thread(target=candela.render, args=(scene,),
                                 kwargs=dict(spp=60000, size=(512, 512), engine={engine!r}), daemon=True).start()
                time.sleep(0.3)
                print("ends", flush=True)
                """)
            self.assertEqual((ran.returncode, ran.stdout.strip()), (0, "ends"), ran.stderr)

    def test_forked_process_is_refused_rather_than_stuck(self):
        ran = run_python("""
            import os, candela
            candela.load("demo:spheres")
            child = os.fork()
            if child == 0:
                try:
                    candela.load("demo:spheres")
                except candela.Error as error:
                    os._exit(42 if "spawn" in str(error) else 1)
            print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
            """)
        self.assertEqual(ran.stdout.strip(), "42", ran.stderr)


class Refusals(Case):
    def test_options_are_refused_by_their_own_names(self):
        scene = small_scene()
        self.refuses(["spp", "0"], draw, scene, spp=0)
        self.refuses("layers", draw, scene, layers=["depht"])
        self.refuses(["bouncs", "did you mean bounces"], draw, scene, bouncs=3)
        self.refuses(["msaa", "raster"], draw, scene, msaa=4)
        self.refuses("engine", draw, scene, engine="fast")
        self.refuses("turntable", draw, scene, turntable=4)
        self.refuses("output", draw, scene, output="x.png")
        self.refuses("no camera", draw, scene, camera="left eye")
        self.refuses("size", draw, scene, size=(0, 4))
        self.refuses("size", draw, scene, camera=draw(scene).camera, size=(64, 64))
        self.refuses("neither a file nor", draw, scene, environment="studo")
        self.refuses("exposure", draw, scene, exposure="bright")
        with self.assertRaises(KeyError):
            draw(scene)["depth"]

    def test_files_are_refused_with_one_line(self):
        self.refuses("no/such.glb", candela.load, "no/such.glb")
        self.refuses("glTF in memory", candela.load, b"glTF but not really")
        self.refuses(["source", "neither a path nor bytes"], candela.load, 3)
        self.refuses("nothing", candela.load, "demo:nothing")
        self.refuses("variant", candela.load, "demo:spheres", variant="blue")

    def test_file_that_vanishes_is_an_error_and_its_scene_stays(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "sky.hdr")
            panorama = candela.render(candela.Scene(), camera=FRONT, environment="furnace", size=(64, 32), spp=1)
            panorama.save(path)
            scene = small_scene()
            before = draw(scene, environment=path)
            os.remove(path)
            self.refuses("sky.hdr", draw, scene, environment=path)
            self.refuses("sky.hdr", candela.load, path)
            scene.environment = candela.environment(numpy.ones((8, 16, 3)))
            self.assertTrue(numpy.isfinite(draw(scene)["beauty"]).all())
            self.assertTrue(before.is_complete)

    def test_cameras_are_refused_where_they_are_none(self):
        pose = numpy.eye(4)
        k = [[30, 0, 16], [0, 30, 12], [0, 0, 1]]
        self.refuses(["K", "(2, 2)", "(3, 3)"], candela.pinhole, numpy.eye(2), pose, (32, 24))
        self.refuses(["K", "singular"], candela.pinhole, [[0, 0, 16], [0, 30, 12], [0, 0, 1]], pose, (32, 24))
        self.refuses(["world_from_camera", "not finite"], candela.pinhole, k, pose * numpy.nan, (32, 24))
        self.refuses(["world_from_camera", "0 0 0 1"], candela.pinhole, k, numpy.ones((4, 4)), (32, 24))
        self.refuses("axes", candela.pinhole, k, pose, (32, 24), axes="blender")
        self.refuses("orthographic", lambda: draw(small_scene(), camera=candela.fit(orthographic=True)).camera.K)

    def test_oddities_are_warnings(self):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            scene = candela.Scene("empty")
            candela.render(scene, size=(8, 8), spp=1)
        self.assertTrue([w for w in caught if issubclass(w.category, candela.Warning) and w.filename == __file__])


if __name__ == "__main__":
    main()
