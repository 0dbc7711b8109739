"""Finds where a picture was taken from, by finite differences: the camera whose picture is most like it.

    python find_camera.py [SCENE]

A real picture would be an array from a file; here it is rendered from a place that the search does not know. The scene
is prepared once for all pictures of the search.
"""

from __future__ import annotations

import argparse

import numpy
import numpy.typing

import candela

Array = numpy.typing.NDArray[numpy.float64]
SIZE = (64, 48)


def smoothed(values: Array, times: int = 24) -> Array:
    """Blurred, so that what is a little off still overlaps and the error has a slope."""
    for _ in range(times):
        for axis in (0, 1):
            values = (numpy.roll(values, 1, axis) + 2 * values + numpy.roll(values, -1, axis)) / 4
    return values


def seen_from(scene: candela.Scene, azimuth_elevation_distance: Array) -> Array:
    azimuth, elevation, distance = (float(x) for x in azimuth_elevation_distance)
    picture = candela.render(scene, camera=candela.orbit(azimuth, elevation, distance), size=SIZE, spp=64, exposure=0.0)
    return smoothed(numpy.log1p(picture["beauty"][..., :3].astype(float)))


def main() -> None:
    parser = argparse.ArgumentParser(description="Finds where a picture was taken from")
    parser.add_argument("scene", nargs="?", default="demo:spheres")
    parser.add_argument("--steps", type=int, default=12)
    arguments = parser.parse_args()

    scene = candela.load(arguments.scene)
    truth = numpy.array([24.0, 18.0, 1.1])
    wanted = seen_from(scene, truth)
    guess = numpy.array([33.0, 26.0, 1.3])
    step = numpy.array([1.0, 1.0, 0.02])
    damping = 1e-3
    here = seen_from(scene, guess)
    for i in range(arguments.steps):
        # Gauss and Newton, damped as Levenberg and Marquardt have it; the slopes by one picture for each number.
        rest = (here - wanted).ravel()
        slopes = numpy.stack([(seen_from(scene, guess + step * unit) - here).ravel() for unit in numpy.eye(3)], axis=1)
        normal = slopes.T @ slopes
        move = numpy.linalg.solve(normal + damping * numpy.diag(numpy.diag(normal)), -slopes.T @ rest)
        candidate = guess + step * move
        there = seen_from(scene, candidate)
        if numpy.sum((there - wanted) ** 2) < numpy.sum(rest**2):
            guess, here, damping = candidate, there, damping / 4
        else:
            damping *= 16
        error = numpy.sqrt(numpy.mean((here - wanted) ** 2))
        print(f"step {i + 1}: azimuth {guess[0]:.2f}, elevation {guess[1]:.2f}, distance {guess[2]:.3f}, error {error:.5f}")
    print("it was: azimuth {:.2f}, elevation {:.2f}, distance {:.3f}".format(*truth))


if __name__ == "__main__":
    main()
