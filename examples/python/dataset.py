"""A data set of twenty models: pictures of some of them at a time, and COCO's annotations.

    python dataset.py [-o FOLDER] [-n PICTURES] [--size PIXELS] [--engine raster|path] [--preview FILE]

The models are made of formulas; they lie about at random, in random colours and light, before random cameras. Nothing is
loaded or uploaded twice: five places hold now this mesh, now that. --preview saves the first picture with every object
tinted where the data set says that it is.
"""

from __future__ import annotations

import argparse
import math
import pathlib
from collections.abc import Callable

import numpy
import numpy.typing

import candela

Array = numpy.typing.NDArray[numpy.float64]
Shape = Callable[[Array, Array], "tuple[Array, Array, Array]"]
LIGHTS = ["studio", "studio:three-point", "sky:15", "sky:60"]
PLACES = 5


def power(x: Array, exponent: float) -> Array:
    return numpy.copysign(numpy.abs(x) ** exponent, x)


def superellipsoid(north: float, east: float, height: float) -> Shape:
    """A ball, a box or a star, after the exponents (Barr 1981, "Superquadrics and angle-preserving transformations")."""
    return lambda u, v: (power(numpy.sin(v), north) * power(numpy.cos(u), east), -height * power(numpy.cos(v), north),
                         -power(numpy.sin(v), north) * power(numpy.sin(u), east))  # fmt: skip


def vase(belly: float, neck: float, waves: float) -> Shape:
    def radius(v: Array) -> Array:
        return numpy.sin(v) ** 0.4 * (0.5 + belly * numpy.sin(v * waves + neck))

    return lambda u, v: (radius(v) * numpy.cos(u), -1.2 * numpy.cos(v), -radius(v) * numpy.sin(u))


def knot(p: int, q: int, thickness: float) -> Shape:
    """A tube along a curve that goes p times around a ring and q times through it; a ring with q = 0."""

    def tube(u: Array, v: Array) -> tuple[Array, Array, Array]:
        t = u * max(p, 1)
        r = 0.7 + 0.25 * numpy.cos(q * t / max(p, 1)) * (q > 0)
        y = 0.25 * numpy.sin(q * t / max(p, 1)) * (q > 0)
        ring = r + thickness * numpy.cos(2 * v)
        return ring * numpy.cos(t), y + thickness * numpy.sin(2 * v), -ring * numpy.sin(t)

    return tube


def models() -> dict[str, Shape]:
    made: dict[str, Shape] = {}
    for name, (north, east, height) in {"ball": (1.0, 1.0, 1.0), "egg": (1.0, 1.0, 1.3), "box": (0.2, 0.2, 0.8), "can": (0.2, 1.0, 1.1),
                                        "lozenge": (2.0, 2.0, 1.0), "pillow": (1.0, 0.3, 0.5), "star": (1.0, 3.0, 0.4),
                                        "top": (2.0, 1.0, 1.2)}.items():  # fmt: skip
        made[name] = superellipsoid(north, east, height)
    for name, (belly, neck, waves) in {"vase": (0.3, 0.5, 2.0), "bottle": (0.3, 2.4, 1.5), "jar": (0.1, 1.0, 1.0), "pawn": (0.35, 0.0, 3.0),
                                       "bell": (0.35, 1.5, 1.0), "gourd": (0.25, 1.0, 4.0)}.items():  # fmt: skip
        made[name] = vase(belly, neck, waves)
    for name, (p, q, thickness) in {"ring": (1, 0, 0.2), "tyre": (1, 0, 0.3), "wreath": (1, 5, 0.2), "trefoil": (2, 3, 0.12),
                                    "coil": (1, 9, 0.1), "pretzel": (3, 2, 0.1)}.items():  # fmt: skip
        made[name] = knot(p, q, thickness)
    return made


def add_model(scene: candela.Scene, name: str, shape: Shape, steps: int = 96) -> candela.Mesh:
    """A mesh of the surface over u in 0 to 2 pi and v in 0 to pi, half a metre wide, that stands on y = 0."""
    u, v = numpy.meshgrid(numpy.linspace(0, 2 * math.pi, steps + 1), numpy.linspace(0, math.pi, steps + 1))
    positions = numpy.stack(shape(u, v), axis=-1).reshape(-1, 3)
    corner = (numpy.arange(steps)[:, None] * (steps + 1) + numpy.arange(steps)).reshape(-1, 1)
    triangles = numpy.concatenate([corner + [0, steps + 2, 1], corner + [0, steps + 1, steps + 2]])
    triangles = triangles[:, ::-1]
    positions *= 0.5 / (positions.max(axis=0) - positions.min(axis=0)).max()
    positions[:, 1] -= positions[:, 1].min()
    material = scene.add_material(name, double_sided=True)
    return scene.add_mesh(positions, triangles, normals="smooth", material=material, name=name)


def arrange(scene: candela.Scene, random: numpy.random.Generator) -> None:
    """Other models in the places, turned and coloured at random."""
    chosen = random.choice(len(scene.meshes), PLACES, replace=False)
    for place, number in enumerate(chosen):
        node, mesh = scene.nodes[place], scene.meshes[int(number)]
        node.mesh = mesh
        turn, around = random.uniform(0, 2 * math.pi), 2 * math.pi * place / PLACES
        distance = random.uniform(0.3, 0.5)
        transform = numpy.eye(4)
        transform[0, :3] = math.cos(turn), 0, math.sin(turn)
        transform[2, :3] = -math.sin(turn), 0, math.cos(turn)
        transform[:3, 3] = distance * math.cos(around), 0, distance * math.sin(around)
        node.transform = transform
        mesh.material().set(base_color=random.uniform(0.05, 0.9, 3), roughness=random.uniform(0.1, 0.8),
                            metallic=float(random.random() < 0.3))  # fmt: skip


def tint(picture: candela.Picture) -> None:
    """Colours every object by its number. What is written into the array is in what is saved."""
    beauty = picture["beauty"]
    for seen in candela.seen_objects(picture):
        color = numpy.array([(math.cos(2.4 * seen.number + k) + 1.2) for k in (0.0, 2.1, 4.2)])
        beauty[seen.mask, :3] = 0.3 * beauty[seen.mask, :3] + 0.2 * color


def main() -> None:
    parser = argparse.ArgumentParser(description="A data set of twenty models with COCO's annotations")
    parser.add_argument("-o", "--output", type=pathlib.Path, default=pathlib.Path("dataset"))
    parser.add_argument("-n", "--pictures", type=int, default=40)
    parser.add_argument("--size", type=int, default=256)
    parser.add_argument("--engine", choices=["raster", "path"], default="raster")
    parser.add_argument("--preview", type=pathlib.Path)
    arguments = parser.parse_args()

    random = numpy.random.default_rng(1)
    scene = candela.Scene("models")
    shapes = models()
    meshes = [add_model(scene, name, shape) for name, shape in shapes.items()]
    for mesh in meshes[:PLACES]:
        scene.add(mesh)
    with candela.Dataset("coco", arguments.output) as data:
        for i in range(arguments.pictures):
            arrange(scene, random)
            height, turn = random.uniform(0.4, 1.4), random.uniform(0, 2 * math.pi)
            eye = (1.6 * math.cos(turn), height, 1.6 * math.sin(turn))
            # Pictures in the same light follow each other, so that each light is prepared once.
            light = LIGHTS[i * len(LIGHTS) // arguments.pictures]
            picture = candela.render(scene, camera=candela.look_at(eye, (0, 0.2, 0), fov_deg=40), environment=light,
                                     size=(arguments.size, arguments.size), engine=arguments.engine, spp=4, objects=True,
                                     environment_rotation_deg=random.uniform(0, 360), ground="shadow")  # fmt: skip
            data.add(picture)
            if i == 0 and arguments.preview:
                tint(picture)
                picture.save(arguments.preview)
            del picture  # else its scene is kept as it is, and the next one is a copy
    print(f"{arguments.pictures} pictures of {len(meshes)} models in {arguments.output}")


if __name__ == "__main__":
    main()
