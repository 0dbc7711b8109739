"""What is wrong is refused with one line, whatever happens meanwhile; what comes later works."""

import json
import os
import pathlib
import resource
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy

import candela
from support import FRONT, Case, draw, has_opengl, main, quad, run_python, small_scene

ENGINES = ["path"] + (["raster"] if has_opengl() else [])
NAN = float("nan")
K = [[30, 0, 16], [0, 30, 12], [0, 0, 1]]
TRIANGLE = {"positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "triangles": [[0, 1, 2]]}


def gltf_file(folder):
    """A triangle in a.gltf and a.bin."""
    path = pathlib.Path(folder) / "a.gltf"
    (path.parent / "a.bin").write_bytes(numpy.array(TRIANGLE["positions"], "float32").tobytes())
    path.write_text(json.dumps({
        "asset": {"version": "2.0"}, "buffers": [{"uri": "a.bin", "byteLength": 36}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3, "min": [0, 0, 0], "max": [1, 1, 0]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}],
        "scene": 0}))  # fmt: skip
    return path


class Arrays(Case):
    """Of a wrong shape, of a wrong dtype, with what is not finite."""

    def test_meshes(self):
        scene = small_scene()
        mesh = scene.meshes[0]
        before = draw(scene)
        for says, change in (
            (["normals", "row 2", "not finite"], {"normals": [[0, 0, 1], [0, 0, 1], [0, NAN, 1]]}),
            (["normals", "dtype <U1"], {"normals": [["a", "b", "c"]] * 3}),
            (["uvs", "row 0", "not finite"], {"uvs": [[numpy.inf, 0], [1, 0], [0, 1]]}),
            (["uvs", "dtype complex128"], {"uvs": numpy.zeros((3, 2), complex)}),
            (["colors", "row 1", "not finite"], {"colors": [[1, 1, 1], [1, NAN, 1], [1, 1, 1]]}),
            (["colors", "(4, 3)"], {"colors": numpy.ones((4, 3))}),
            (["triangles", "dtype bool"], {"triangles": numpy.zeros((1, 3), bool)}),
            (["triangles", "(3,)"], {"triangles": [0, 1, 2]}),
            (["triangles", "18446744073709551615"], {"triangles": numpy.array([[0, 1, 2**64 - 1]], "uint64")}),
            (["positions", "dtype object"], {"positions": numpy.array([[None] * 3] * 3)}),
            (["positions", "(0, 2)"], {"positions": numpy.zeros((0, 2))}),
        ):
            with self.subTest(change):
                self.refuses(says, scene.add_mesh, **{**TRIANGLE, **change})
                self.refuses(says, mesh.set, **{**TRIANGLE, **change})
        self.same(draw(scene), before)

    def test_environments(self):
        scene = small_scene()
        for says, source in (
            (["environment", "dtype <U4"], numpy.full((8, 16, 3), "blue")),
            (["environment", "dtype bool"], numpy.ones((8, 16, 3), bool)),
            (["environment", "(8, 16, 4)", "(n, n, 3)"], numpy.ones((8, 16, 4))),
            (["environment", "0x0"], numpy.ones((0, 0, 3))),
            (["environment", "not finite"], numpy.full((8, 16, 3), numpy.inf)),
            (["environment", "no array"], [[1, 2], [3]]),
        ):
            with self.subTest(says):
                self.refuses(says, candela.environment, source)
                self.refuses(says, draw, scene, environment=source)
                self.refuses(says, setattr, scene, "environment", source)
        self.assertEqual(scene.environment, "none")

    def test_textures(self):
        material = small_scene().materials["red"]
        for says, source in (
            (["base_color_texture", "dtype bool"], numpy.ones((4, 4), bool)),
            (["base_color_texture", "dtype <U3"], numpy.full((4, 4), "red")),
            (["base_color_texture", "dtype uint32"], numpy.ones((4, 4), "uint32")),
            (["base_color_texture", "(0, 4)"], numpy.ones((0, 4))),
            (["base_color_texture", "(2, 2, 2, 3)"], numpy.ones((2, 2, 2, 3))),
            (["base_color_texture", "16384"], numpy.ones((1, 20000), "uint8")),
        ):
            with self.subTest(says):
                self.refuses(says, setattr, material, "base_color_texture", source)
        self.assertIsNone(material.base_color_texture)

    def test_cameras(self):
        pose = numpy.eye(4)
        for says, k, where in (
            (["K", "dtype <U1"], numpy.full((3, 3), "k"), pose),
            (["K", "row 1", "not finite"], [[30, 0, 16], [0, NAN, 12], [0, 0, 1]], pose),
            (["K", "(3, 4)"], numpy.zeros((3, 4)), pose),
            (["world_from_camera", "(3, 4)"], K, numpy.eye(4)[:3]),
            (["world_from_camera", "dtype complex128"], K, pose.astype(complex)),
            (["world_from_camera", "row 2", "not finite"], K, [*pose[:2], [0, 0, numpy.inf, 0], pose[3]]),
        ):
            with self.subTest(says):
                self.refuses(says, candela.pinhole, k, where, (32, 24))
        self.refuses(["eye", "nan"], draw, small_scene(), camera=candela.look_at((NAN, 0, 3), (0, 0, 0)))
        self.refuses(["orbit"], draw, small_scene(), camera=candela.orbit(NAN, 0))
        self.refuses(["fov"], draw, small_scene(), camera=candela.fit("front", fov_deg=NAN))
        self.refuses(["fov_deg"], small_scene().add_camera, "bad", fov_deg=NAN)
        self.refuses(["size"], candela.pinhole, K, pose, (0, 24))

    def test_lamps_and_nodes(self):
        scene = small_scene()
        lamp = scene.nodes["lamp"]
        self.refuses(["position", "not finite"], setattr, lamp, "position", (0, NAN, 0))
        self.refuses(["position", "(2,)"], scene.add, scene.meshes[0], position=(0, 0))
        self.refuses(["target", "not finite"], lamp.look_at, (0, 0, numpy.inf))
        self.refuses(["color", "not finite"], setattr, scene.lights[0], "color", (1, NAN, 1))
        self.assertEqual(lamp.position, (1.0, 2.0, 2.0))

    def test_light_to_bake_and_pictures_to_compare(self):
        self.refuses(["position", "(2,)"], candela.bake, small_scene(), size=4, levels=2, position=(0, 0))
        self.refuses(["environment", "not finite"], candela.bake, numpy.full((4, 8, 3), NAN), size=4, levels=2)
        self.refuses(["first", "2 channels"], candela.diff, numpy.zeros((4, 4, 2)), numpy.zeros((4, 4, 2)))
        self.refuses(["first", "dtype <U1"], candela.diff, numpy.full((4, 4, 3), "x"), numpy.zeros((4, 4, 3)))

    def test_masks_and_pictures_of_films(self):
        self.refuses(["mask", "dtype uint8", "bool"], candela.run_lengths, numpy.zeros((4, 4), "uint8"))
        self.refuses(["mask", "(4,)"], candela.run_lengths, numpy.zeros(4, bool))
        with tempfile.TemporaryDirectory() as folder:
            film = candela.Movie(os.path.join(folder, "a.webp"))
            self.refuses(["picture", "uint8"], film.add, numpy.zeros((4, 4, 3)))
            self.refuses(["picture", "(4, 4, 2)"], film.add, numpy.zeros((4, 4, 2), "uint8"))
            film.add(numpy.zeros((4, 4, 3), "uint8"))
            self.refuses("size", film.add, numpy.zeros((4, 5, 3), "uint8"))


class Strangers(Case):
    """What is of another scene."""

    def test_nothing_of_another_scene_gets_in(self):
        scene, other = small_scene(), small_scene()
        other.add_camera("eye", position=(0, 0, 4))
        texture = other.add_texture(numpy.zeros((2, 2), "uint8"))
        before = draw(scene)
        for says, call in (
            ("mesh", lambda: setattr(scene.nodes[0], "mesh", other.meshes[0])),
            ("light", lambda: setattr(scene.nodes[0], "light", other.lights[0])),
            ("camera", lambda: setattr(scene.nodes[0], "camera", other.cameras[0])),
            ("material", lambda: scene.meshes[0].set_material(other.materials[0])),
            ("parent", lambda: scene.add(scene.meshes[0], parent=other.nodes[0])),
            ("parent", lambda: scene.add_node(parent=other.nodes[0])),
            ("base_color_texture", lambda: scene.materials[0].set(base_color_texture=texture)),
            ("material", lambda: quad(scene, "", other.materials[0])),
        ):
            with self.subTest(says):
                self.refuses([says, "another scene"], call)
        self.same(draw(scene), before)

    def test_copy_is_another_scene(self):
        scene = small_scene()
        self.refuses(["material", "another scene"], scene.meshes[0].set_material, scene.copy().materials[0])


class Vanished(Case):
    def test_files_that_a_scene_names(self):
        with tempfile.TemporaryDirectory() as folder:
            path = gltf_file(folder)
            candela.load(path)
            (path.parent / "a.bin").unlink()
            self.refuses("a.bin", candela.load, path)

    def test_textures_lists_of_cameras_and_pictures(self):
        scene = small_scene()
        picture = draw(scene)
        with tempfile.TemporaryDirectory() as folder:
            name = os.path.join(folder, "a.png")
            picture.save(name)
            scene.add_texture(name)
            os.remove(name)
            self.refuses("a.png", scene.add_texture, name)
            self.refuses("a.png", scene.materials["red"].set, base_color_texture=name)
            self.refuses("a.png", candela.diff, name, name)
            self.refuses("a.json", candela.read_cameras, os.path.join(folder, "a.json"))
        self.refuses(os.path.basename(folder), picture.save, os.path.join(folder, "a.exr"))  # the folder has gone
        self.refuses(os.path.basename(folder), picture.to_png, os.path.join(folder, "a"))
        self.same(draw(scene), picture)

    def test_scene_that_was_loaded_needs_its_file_no_more(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = candela.load(gltf_file(folder))
        for engine in ENGINES:
            self.assertGreater(draw(scene, engine=engine)["beauty"][..., 3].max(), 0.9)


class Callbacks(Case):
    def test_what_one_raises_arrives_and_later_work_is_done(self):
        class Mine(Exception):
            pass

        def fail(progress):
            raise Mine(progress.what)

        scene = small_scene()
        picture = draw(scene)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.png")
            picture.save(path)
            for name, work in (
                ("path", lambda: draw(scene, size=(512, 384), spp=4096, progress=fail)),
                ("denoised", lambda: draw(scene, size=(512, 384), spp=4096, denoise=True, progress=fail)),
                ("bake", lambda: candela.bake("studio", size=512, levels=8, progress=fail)),
                ("bake of a scene", lambda: candela.bake(scene, size=256, samples=4096, progress=fail)),
                ("furnace", lambda: candela.furnace(progress=fail)),
            ):
                with self.subTest(name), self.assertRaises(Mine):
                    work()
            self.same(draw(scene), picture)

    def test_even_what_is_no_exception(self):
        def leave(progress):
            sys.exit(3)

        scene = small_scene()
        with self.assertRaises(SystemExit) as caught:
            draw(scene, size=(512, 384), spp=4096, progress=leave)
        self.assertEqual(caught.exception.code, 3)
        self.assertTrue(draw(scene).is_complete)

    def test_one_may_render_itself(self):
        scene, pictures = small_scene(), []

        def nested(progress):
            if not pictures:
                pictures.append(draw(small_scene()))

        draw(scene, size=(256, 192), spp=128, progress=nested)
        self.same(pictures[0], draw(small_scene()))

    def test_one_may_change_the_scene(self):
        scene = small_scene()
        options = {"size": (256, 192), "spp": 64}
        before = draw(scene, **options)

        def change(progress):
            scene.materials["red"].roughness = 0.9
            scene.nodes["lamp"].position = (0, 1, 1)

        self.same(draw(scene, progress=change, **options), before)
        self.differs(draw(scene, **options), before)

    def test_what_is_no_callback_is_refused(self):
        with self.assertRaises(TypeError):
            draw(small_scene(), size=(256, 192), spp=4096, progress=3)


class Ends(Case):
    """Python ends while work is done: no crash, no hang, whatever the thread is at."""

    def ends(self, code, returncode=0, out="ends"):
        ran = run_python(code)
        self.assertEqual((ran.returncode, ran.stdout.strip(), ran.stderr), (returncode, out, ""))

    def test_threads_that_render_again_and_again(self):
        for engine in ENGINES:
            self.ends(f"""
                import threading, time, candela
                def work(scene):
                    while True:
                        candela.render(scene, size=(24, 24), spp=2, engine={engine!r})
                for _ in range(4):
                    threading.Thread(target=work, args=(candela.load("demo:spheres"),), daemon=True).start()
                time.sleep(1.0)
                print("ends", flush=True)
                """)

    def test_threads_that_load_save_bake_and_write(self):
        with tempfile.TemporaryDirectory() as folder:
            self.ends(f"""
                import threading, time, numpy, candela
                scene = candela.load("demo:spheres")
                picture = candela.render(scene, size=(600, 400), spp=1, objects=True)
                film = candela.Movie({folder!r} + "/a.webp")
                data = candela.Dataset("masks", {folder!r})
                def again(work):
                    def loop():
                        while True:
                            work()
                    threading.Thread(target=loop, daemon=True).start()
                again(lambda: candela.load("demo:spheres"))
                again(lambda: picture.save({folder!r} + "/a.exr"))
                again(lambda: picture.to_png({folder!r} + "/a.png"))
                again(lambda: picture.develop())
                again(lambda: candela.bake("sky", size=16, levels=2))
                again(lambda: candela.diff(picture, picture))
                again(lambda: film.add(picture))
                again(lambda: data.add(picture))
                time.sleep(1.5)
                print("ends", flush=True)
                """)
            self.assertEqual([name for name in os.listdir(folder) if name.startswith("a.") and "webp" in name], [])

    def test_main_thread_is_told_of_its_own_error(self):
        self.ends("""
            import threading, time, candela
            scene = candela.load("demo:spheres")
            threading.Thread(target=candela.render, args=(scene,), kwargs=dict(spp=60000), daemon=True).start()
            time.sleep(0.3)
            print("ends", flush=True)
            raise SystemExit(5)
            """, 5)

    def test_what_begins_after_the_end_is_refused(self):
        self.ends("""
            import atexit
            def late():
                import candela
                for work in (lambda: candela.load("demo:spheres"), lambda: candela.render(scene, spp=1, size=(8, 8)),
                             lambda: picture.to_png("/nowhere/a.png"), lambda: candela.Scene()):
                    try:
                        work()
                    except candela.Error as error:
                        print(error)
            atexit.register(late)  # before candela's own, and so called after it
            import candela
            scene = candela.load("demo:spheres")
            picture = candela.render(scene, size=(8, 8), spp=1)
            """, out="\n".join(["Python is ending"] * 4))

    def test_thread_that_is_no_daemon_finishes_its_picture(self):
        self.ends("""
            import threading, candela
            scene = candela.load("demo:spheres")
            def work():
                picture = candela.render(scene, size=(64, 48), spp=64)
                print("ends" if picture.is_complete else "cut short", flush=True)
            threading.Thread(target=work).start()
            """)


class CtrlC(Case):
    """By the signal itself."""

    def interrupted(self, code, then=signal.SIGINT, after=1.0):
        process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)})  # fmt: skip
        try:
            self.assertEqual(process.stdout.readline().strip(), "begins")
            time.sleep(after)
            sent = time.monotonic()
            process.send_signal(then)
            out, errors = process.communicate(timeout=60)
        finally:
            process.kill()
            process.wait()
        return out, errors, process.returncode, time.monotonic() - sent

    def test_ends_a_picture_and_the_next_one_is_made(self):
        for engine, options in (("path", "spp=65536"), ("raster", "spp=100000")):
            if engine not in ENGINES:
                continue
            out, errors, code, seconds = self.interrupted(
                f"import candela; scene = candela.load('demo:spheres'); print('begins', flush=True)\n"
                f"try:\n    candela.render(scene, engine={engine!r}, {options})\n"
                f"except KeyboardInterrupt:\n    pass\n"
                f"print(candela.render(scene, engine={engine!r}, size=(16, 16), spp=1).is_complete)")
            self.assertEqual((out.strip(), code), ("True", 0), errors)
            self.assertLess(seconds, 20.0)

    def test_ends_a_bake_and_the_program_of_who_does_not_catch_it(self):
        _, errors, code, seconds = self.interrupted(
            "import candela; print('begins', flush=True); candela.bake('sky', size=1024, levels=10)")
        self.assertEqual(code, -signal.SIGINT)
        self.assertIn("KeyboardInterrupt", errors)
        self.assertLess(seconds, 20.0)

    def test_module_as_program_keeps_the_picture_so_far(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.png")
            _, errors, code, _ = self.interrupted(
                f"import sys; from candela import _candela; print('begins', flush=True)\n"
                f"sys.exit(_candela.run_program(['render', 'demo:spheres', '-o', {path!r}, '--spp', '65536', "
                f"'--size', '64x48', '--bounces', '200']))", after=3.0)
            self.assertIn("a.png", errors)
            self.assertTrue(os.path.exists(path), (errors, code))


class FullDisk(Case):
    def test_device_that_is_full(self):
        picture = draw(small_scene(), layers=["depth"])
        self.refuses(["/dev/full", "disk full"], picture.to_png, "/dev/full")
        with tempfile.TemporaryDirectory() as folder:
            for ending in ("png", "jpg", "webp", "exr", "hdr"):
                path = os.path.join(folder, "a." + ending)
                os.symlink("/dev/full", path)
                with self.subTest(ending):
                    self.refuses(path, picture.save, path)
            for ending in ("webp", "gif"):
                path = os.path.join(folder, "film." + ending)
                os.symlink("/dev/full", path)
                film = candela.Movie(path)
                with self.subTest(ending):
                    self.refuses(path, lambda: (film.add(picture), film.add(picture), film.finish()))
        self.assertTrue(draw(small_scene()).is_complete)

    def test_files_that_may_not_grow_leave_nothing(self):
        """As on a disk that fills up in the middle."""
        picture = draw(small_scene(), size=(256, 192), spp=1, objects=True)
        with tempfile.TemporaryDirectory() as folder:
            soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
            for ending in ("png", "jpg", "webp", "exr", "hdr", "film.webp", "film.gif", "set"):
                path = os.path.join(folder, "a." + ending)

                def write():
                    if ending.startswith("film"):
                        with candela.Movie(path) as film:
                            film.add(picture)
                    elif ending == "set":
                        with candela.Dataset("coco", path) as data:
                            data.add(picture)
                    else:
                        picture.save(path, exposure=0.0)

                resource.setrlimit(resource.RLIMIT_FSIZE, (700, hard))
                try:
                    with self.subTest(ending):
                        self.refuses(path, write)
                finally:
                    resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
            left = [os.path.join(where, name) for where, _, names in os.walk(folder) for name in names]
            self.assertEqual(left, [])


if __name__ == "__main__":
    main()
