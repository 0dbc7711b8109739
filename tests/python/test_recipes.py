"""Checks, bakes, laws, differences; the program; types."""

import importlib.util
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy

import candela
from support import Case, draw, main, quad, run_python, small_scene


class Checks(Case):
    def test_black_metal_is_found_and_a_plain_square_is_not(self):
        scene = candela.Scene("judged")
        scene.add(quad(scene, "", scene.add_material("coal", base_color=(0.01, 0.01, 0.01), metallic=1.0)))
        verdict = candela.check(scene)
        self.assertFalse(verdict)
        self.assertEqual([f.code for f in verdict.findings if f.severity != "note"], ["metal-too-dark"])
        self.assertIn("coal", verdict.findings[0].material)
        scene.materials["coal"].set(base_color=(0.5, 0.5, 0.5), metallic=0.0)
        self.assertTrue(candela.check(scene))

    def test_file_that_cannot_be_read_has_a_verdict(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "broken.glb"
            path.write_bytes(b"glTF")
            verdict = candela.check(path)
            self.assertFalse(verdict)
            self.assertIsNotNone(verdict.reason)


class Bakes(Case):
    def test_white_light_is_one_everywhere_and_pi_as_irradiance(self):
        baked = candela.bake("furnace", size=8, levels=3, irradiance_size=4)
        self.assertEqual([level.shape for level in baked.levels], [(6, 8, 8, 3), (6, 4, 4, 3), (6, 2, 2, 3)])
        for level in baked.levels:
            numpy.testing.assert_allclose(level, 1.0, rtol=1e-3)
        numpy.testing.assert_allclose(baked.irradiance, numpy.pi, rtol=1e-3)
        self.assertEqual(baked.sh.shape, (9, 3))
        self.assertLess(max(proof.error_at_texels for proof in baked.proofs), 1e-3)

    def test_scene_is_baked_as_a_point_of_it_sees_it(self):
        scene = small_scene()
        scene.environment = "furnace"
        baked = candela.bake(scene, size=8, levels=2, irradiance_size=4, position=(0, 0, 1), samples=16)
        self.assertLess(baked.levels[0][5].mean(), baked.levels[0][4].mean())  # the square is towards -z
        dark = candela.bake(scene, size=8, levels=2, irradiance_size=4, position=(0, 0, 1), samples=16,
                            environment=numpy.zeros((4, 8, 3)))  # fmt: skip
        self.assertEqual(dark.levels[0][4].max(), 0.0)  # in place of the scene's own, and nothing is towards +z

    def test_orders_are_refused(self):
        self.refuses("texels", candela.bake, "furnace", size=0)
        self.refuses("environment", candela.bake, "furnace", environment="studio")


class Laws(Case):
    def test_measuring_can_be_stopped(self):
        self.refuses("stopped", candela.furnace, progress=lambda p: False)


class Differences(Case):
    def test_equal_pictures_differ_by_nothing(self):
        picture = draw(small_scene(), layers=["depth"])
        same = candela.diff(picture, picture)
        self.assertEqual((same.flip, [layer.changed for layer in same.layers]), (0.0, [0, 0]))

    def test_files_pictures_and_arrays_are_compared_alike(self):
        first, second = draw(small_scene()), draw(small_scene(), seed=7)
        with tempfile.TemporaryDirectory() as folder:
            names = [os.path.join(folder, name) for name in ("a.exr", "b.exr")]
            first.save(names[0])
            second.save(names[1])
            of_files = candela.diff(*names)
        of_pictures = candela.diff(first, second)
        of_arrays = candela.diff(first["beauty"], second["beauty"])
        self.assertGreater(of_files.flip, 0.0)
        self.assertEqual(of_files.error.shape, (24, 32))
        self.assertEqual(of_files.flip, of_pictures.flip)
        self.assertEqual(of_files.flip, of_arrays.flip)
        self.assertEqual(of_files.layers, of_pictures.layers)

    def test_sizes_must_agree(self):
        self.refuses(["second is 5x4 pixels", "first 4x4"], candela.diff, numpy.zeros((4, 4, 3)), numpy.zeros((4, 5, 3)))
        self.refuses(["second", "not finite"], candela.diff, numpy.zeros((4, 4, 3)), numpy.full((4, 4, 3), numpy.nan))


class Program(Case):
    def test_module_is_the_program(self):
        def run(*arguments):
            return subprocess.run([sys.executable, "-m", "candela", *arguments], capture_output=True, text=True,
                                  env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)})  # fmt: skip

        self.assertIn(candela.__version__, run("--version").stdout)
        wrong = run("rendr")
        self.assertEqual(wrong.returncode, 2)
        self.assertIn("did you mean", wrong.stderr)
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(run("render", "no/such.glb", "-o", os.path.join(folder, "a.png")).returncode, 1)

    def test_import_takes_no_more_than_it_needs(self):
        ran = run_python("import sys, candela; print({'numpy', 'typing', 'dataclasses', 'json', 'tempfile'} & set(sys.modules))")
        self.assertEqual(ran.stdout.strip(), "set()", ran.stderr)

    def test_all_names_are_there(self):
        ran = run_python("import candela; print(all(getattr(candela, n) for n in candela.__all__), dir(candela).count('check'))")
        self.assertEqual(ran.stdout.strip(), "True 1", ran.stderr)
        with self.assertRaises(AttributeError):
            candela.nothing


@unittest.skipUnless(importlib.util.find_spec("mypy"), "mypy is not installed")
class Types(unittest.TestCase):
    def test_package_and_examples_are_typed(self):
        root = pathlib.Path(__file__).resolve().parents[2]
        examples = sorted(str(path) for path in (root / "examples/python").glob("*.py"))
        package = os.path.dirname(candela.__file__)
        with tempfile.TemporaryDirectory() as cache:
            ran = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--cache-dir", cache, package, *examples],
                                 capture_output=True, text=True,
                                 env=os.environ | {"MYPYPATH": os.path.dirname(package)})  # fmt: skip
        self.assertEqual(ran.returncode, 0, ran.stdout + ran.stderr)


if __name__ == "__main__":
    main()
