"""Finds where a picture was taken from, by finite differences: the camera whose picture is most like it.

    python find_camera.py [SCENE] [--steps N] [--spp N] [--film FILE]

A real picture would be an array from a file; here it is rendered from a place that the search does not know. The scene
is prepared once for all pictures of the search. --film shows it: on the left the picture, on the right the search.
"""

from __future__ import annotations

import argparse
import contextlib
import pathlib

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


def picture_from(scene: candela.Scene, azimuth_elevation_distance: Array, spp: int) -> candela.Picture:
    azimuth, elevation, distance = (float(x) for x in azimuth_elevation_distance)
    return candela.render(scene, camera=candela.orbit(azimuth, elevation, distance), size=SIZE, spp=spp, exposure=0.0)


def smooth_light(picture: candela.Picture) -> Array:
    return smoothed(numpy.log1p(picture["beauty"][..., :3].astype(float)))


def error_of(here: Array, wanted: Array) -> float:
    return float(numpy.sqrt(numpy.mean((here - wanted) ** 2)))


def search(scene: candela.Scene, wanted_picture: candela.Picture, guess: Array, steps: int, spp: int, film: candela.Movie | None) -> None:
    """Gauss and Newton, damped as Levenberg and Marquardt have it; the slopes by one picture for each number."""
    wanted = smooth_light(wanted_picture)
    step = numpy.array([1.0, 1.0, 0.02])
    damping = 1e-3
    picture = picture_from(scene, guess, spp)
    here = smooth_light(picture)
    print(f"before: azimuth {guess[0]:.2f}, elevation {guess[1]:.2f}, distance {guess[2]:.3f}, error {error_of(here, wanted):.5f}")
    for i in range(steps):
        if film is not None:
            film.add(numpy.hstack([wanted_picture.develop(), picture.develop()]))
        rest = (here - wanted).ravel()
        slopes = numpy.stack([(smooth_light(picture_from(scene, guess + unit * size, spp)) - here).ravel() / size
                              for unit, size in zip(numpy.eye(3), step)], axis=1)  # fmt: skip
        normal = slopes.T @ slopes
        candidate = guess + numpy.linalg.solve(normal + damping * numpy.diag(numpy.diag(normal)), -slopes.T @ rest)
        tried = picture_from(scene, candidate, spp)
        there = smooth_light(tried)
        if numpy.sum((there - wanted) ** 2) < numpy.sum(rest**2):
            guess, picture, here, damping = candidate, tried, there, damping / 4
        else:
            damping *= 16
        print(f"step {i + 1}: azimuth {guess[0]:.2f}, elevation {guess[1]:.2f}, distance {guess[2]:.3f}, error {error_of(here, wanted):.5f}")


def main() -> None:
    parser = argparse.ArgumentParser(description="Finds where a picture was taken from")
    parser.add_argument("scene", nargs="?", default="demo:spheres")
    parser.add_argument("--steps", type=int, default=12)
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--film", type=pathlib.Path)
    arguments = parser.parse_args()

    scene = candela.load(arguments.scene)
    truth = numpy.array([24.0, 18.0, 1.1])
    with contextlib.ExitStack() as stack:
        film = stack.enter_context(candela.Movie(arguments.film, fps=3)) if arguments.film else None
        wanted = picture_from(scene, truth, arguments.spp)
        search(scene, wanted, numpy.array([33.0, 26.0, 1.3]), arguments.steps, arguments.spp, film)
    print("it was: azimuth {:.2f}, elevation {:.2f}, distance {:.3f}".format(*truth))


if __name__ == "__main__":
    main()
