"""A turntable with a moving lamp: the model turns once, while a lamp rises over it.

    python turntable.py [SCENE] [-o FILM] [-n PICTURES] [--size PIXELS] [--engine raster|path]

The film is a .webp, a .gif, or where ffmpeg is installed an .mp4. The camera goes around and the lamp moves, so the scene
is prepared once.
"""

from __future__ import annotations

import argparse
import math
import pathlib

import candela


def main() -> None:
    parser = argparse.ArgumentParser(description="A turntable with a moving lamp")
    parser.add_argument("scene", nargs="?", default="demo:spheres")
    parser.add_argument("-o", "--output", type=pathlib.Path, default=pathlib.Path("turntable.webp"))
    parser.add_argument("-n", "--pictures", type=int, default=24)
    parser.add_argument("--engine", choices=["raster", "path"], default="raster")
    parser.add_argument("--size", type=int, default=256)
    arguments = parser.parse_args()

    scene = candela.load(arguments.scene)
    scene.environment = "studio:dark"
    lower, upper = scene.bounds
    center = [(a + b) / 2 for a, b in zip(lower, upper)]
    radius = math.dist(lower, upper) / 2
    lamp = scene.add_light("spot", intensity=60 * radius**2, color=(1.0, 0.85, 0.6), outer_cone_deg=40)

    size = (arguments.size, arguments.size)
    with candela.Movie(arguments.output, fps=12) as film:
        for i in range(arguments.pictures):
            share = i / arguments.pictures
            turn, height = 2 * math.pi * share, math.sin(math.pi * share)
            lamp.position = (center[0] + 2 * radius * math.cos(turn), center[1] + 2 * radius * height + radius,
                             center[2] + 2 * radius * math.sin(turn))  # fmt: skip
            lamp.look_at(center)
            # The camera goes around: nothing of the scene has to be prepared again.
            view = candela.orbit(35.0 + 360.0 * share, 20.0, 1.2)
            film.add(candela.render(scene, camera=view, size=size, spp=16, engine=arguments.engine, exposure=0.0))
    print(f"{arguments.pictures} pictures in {arguments.output}")


if __name__ == "__main__":
    main()
