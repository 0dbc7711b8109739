"""What the tests of the Python package share."""

import os
import subprocess
import sys
import textwrap
import unittest

import numpy

import candela

SKIPPED = 77  # as ctest knows it


def quad(scene, name="", material=None):
    """A square of two metres in the plane z = 0, seen from +z."""
    positions = numpy.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], dtype="float32")
    uvs = numpy.array([[0, 1], [1, 1], [1, 0], [0, 0]], dtype="float32")
    return scene.add_mesh(positions, [[0, 1, 2], [0, 2, 3]], uvs=uvs, material=material, name=name)


def small_scene():
    """A red square before a wall, and a lamp."""
    scene = candela.Scene("small")
    red = scene.add_material("red", base_color=(0.8, 0.1, 0.1), roughness=0.6)
    scene.add(quad(scene, "square", red), name="square")
    scene.add(quad(scene, "wall"), transform=[[4, 0, 0, 0], [0, 4, 0, 0], [0, 0, 1, -2], [0, 0, 0, 1]], name="wall")
    scene.add_light("point", position=(1.0, 2.0, 2.0), intensity=40.0, name="lamp")
    scene.environment = "none"
    return scene


FRONT = candela.look_at((0.0, 0.5, 5.0), (0.0, 0.0, 0.0))


def draw(scene, **options):
    """A small picture; any of its settings may be said otherwise."""
    return candela.render(scene, **{"camera": FRONT, "size": (32, 24), "spp": 16, "exposure": 0.0, **options})


def has_opengl():
    try:
        draw(small_scene(), engine="raster", spp=1)
    except candela.Error as error:
        if "OpenGL" in str(error):
            return False
        raise
    return True


def run_python(code, **options):
    """Another Python; its result as subprocess has it."""
    return subprocess.run([sys.executable, "-c", textwrap.dedent(code)], capture_output=True, text=True, timeout=120,
                          env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}, **options)


class Case(unittest.TestCase):
    def refuses(self, says, call, *arguments, **keywords):
        """The call raises candela.Error with one line in which all of `says` occurs."""
        with self.assertRaises(candela.Error) as caught:
            call(*arguments, **keywords)
        text = str(caught.exception)
        self.assertEqual(len(text.splitlines()), 1, text)
        for part in [says] if isinstance(says, str) else says:
            self.assertIn(part, text)

    def same(self, a, b):
        """Two pictures have the same bits."""
        self.assertEqual(a.names, b.names)
        for name in a.names:
            numpy.testing.assert_array_equal(a[name], b[name])

    def differs(self, a, b):
        self.assertFalse(numpy.array_equal(a["beauty"], b["beauty"]))


def main():
    program = unittest.main(exit=False)
    result = program.result
    if not result.wasSuccessful():
        sys.exit(1)
    sys.exit(SKIPPED if result.skipped and len(result.skipped) == result.testsRun else 0)
