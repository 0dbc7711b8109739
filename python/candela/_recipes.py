"""Checks, bakes, the laws of the materials, and how far pictures are from each other."""

from __future__ import annotations

import dataclasses
import json
import os
import typing
from collections.abc import Callable, Mapping

from candela import _candela
from candela._candela import Environment, Picture, Progress, Scene

if typing.TYPE_CHECKING:
    import numpy
    import numpy.typing

    FloatArray = numpy.typing.NDArray[numpy.float32]

Path = typing.Union[str, "os.PathLike[str]"]
Callback = Callable[[Progress], object]


@dataclasses.dataclass(frozen=True)
class Finding:
    """One thing that check() found; docs/check.md explains every code."""

    severity: str  #: "note", "warning" or "error"
    code: str
    message: str  #: what was measured, against what
    fix: str | None  #: what mends it, where that is mechanical
    material: str | None
    texture: str | None
    subject: str | None  #: what it is about where that is neither
    share: float | None  #: of what `share_of` names that it concerns, 0 to 1
    share_of: str | None
    measured: Mapping[str, float]


@dataclasses.dataclass(frozen=True)
class Verdict:
    """What check() thinks of an asset."""

    name: str
    reason: str | None  #: why it cannot be read; None where it can
    materials: int
    triangles: int
    findings: tuple[Finding, ...]  #: errors first

    def __bool__(self) -> bool:
        """Whether it can be read and nothing worse than a note was found."""
        return self.reason is None and all(finding.severity == "note" for finding in self.findings)


def check(asset: Scene | Path, *, root: Path = "", progress: Callback | None = None) -> Verdict:
    """Judges materials, textures, meshes and lamps as a physicist would.

    asset: a file, "demo:NAME", or a scene; of a file more is known, all its variants among it. A file that cannot be read has
    a verdict, too. root: a folder outside of which nothing is read. Raises Error.
    """
    if isinstance(asset, Scene):
        text = _candela.check_scene(asset, progress)
    else:
        text = _candela.check_file(os.fspath(asset), os.fspath(root), progress)
    verdict = json.loads(text)
    names = [field.name for field in dataclasses.fields(Finding)]
    findings = tuple(Finding(**{name: finding[name] for name in names}) for finding in verdict["findings"])
    return Verdict(verdict["file"], verdict["reason"], verdict["materials"], verdict["triangles"], findings)


@dataclasses.dataclass(frozen=True)
class Proof:
    """How far a level of a bake is from the exact integral, as a share of it: the largest of the directions tried."""

    roughness: float
    error_at_texels: float
    error_between: float  #: of bilinear lookups


@dataclasses.dataclass(frozen=True)
class Bake:
    """Image-based light for real-time engines. Cubes are (6, n, n, 3) float32, linear: faces +x -x +y -y +z -z, row 0 at
    t = -1, as OpenGL has them."""

    levels: list[FloatArray]  #: prefiltered radiance, each half as large as the one before
    proofs: list[Proof]  #: of each
    sheen: list[FloatArray]  #: the same for fabrics, where asked for
    irradiance: FloatArray  #: not divided by pi
    irradiance_proof: Proof
    sh: FloatArray  #: ((order + 1)**2, 3): harmonics of irradiance; degree l, order m at l (l + 1) + m


def bake(
    light: Environment | Scene | Path | numpy.typing.ArrayLike,
    *,
    size: int = 256,
    levels: int = 6,
    sheen: bool = False,
    irradiance_size: int = 32,
    sh_order: int = 2,
    position: numpy.typing.ArrayLike = (0.0, 0.0, 0.0),
    environment: Environment | Path | numpy.typing.ArrayLike | None = None,
    samples: int = 64,
    progress: Callback | None = None,
) -> Bake:
    """Bakes light for engines, with its error measured.

    light: as of environment(); or a scene, of which it is what the point `position` (3,), metres, sees, path traced with
    `samples` per texel under `environment`. size: texels along a face of the first level. Raises Error.
    """
    scene = light if isinstance(light, Scene) else None
    distant: Environment | None = None
    if not isinstance(light, Scene):
        if environment is not None:
            raise _candela.Error("environment: lights a scene, and there is none")
        distant = _candela.environment(light)
    elif environment is not None:
        distant = _candela.environment(environment)
    made = _candela.bake(distant, scene, size, levels, sheen, irradiance_size, sh_order, position, samples, progress)
    made["proofs"] = [Proof(**proof) for proof in made["proofs"]]
    made["irradiance_proof"] = Proof(**made["irradiance_proof"])
    return Bake(**made)


@dataclasses.dataclass(frozen=True)
class Law:
    """The worst that was measured of a kind of surface, over all roughnesses."""

    surface: str
    count: int  #: how many surfaces
    reciprocity_error: float  #: relative
    furnace_least: float  #: what comes back of white light from everywhere, at least
    furnace_most: float
    pdf_error: float
    not_finite: int
    kept: bool  #: whether what is promised of it holds


def furnace(*, all: bool = False, progress: Callback | None = None) -> list[Law]:
    """Measures what the materials do with light: reciprocity, energy, sampling. all: every combination of lobes; minutes."""
    return [Law(**row) for row in _candela.furnace(all, progress)]


def furnace_sheet(*, progress: Callback | None = None) -> FloatArray:
    """White spheres in white light, (h, w, 3), sRGB encoded, 0 to 1: what loses or gains light shows as blue or red."""
    return _candela.furnace_sheet(progress)


@dataclasses.dataclass(frozen=True)
class LayerDifference:
    """A picture or a layer beside another, over all their channels."""

    layer: str  #: empty = the picture itself
    mean: float  #: of |second - first|, where both are finite
    max: float
    changed: int  #: pixels that differ by more than the tolerance
    broken: int  #: pixels with a value that is finite in one alone; they have changed too


@dataclasses.dataclass(frozen=True)
class Difference:
    """How far one picture is from another."""

    flip: float  #: mean of `error`
    flip_max: float
    layers: list[LayerDifference]  #: the picture, then the layers that both have
    error: FloatArray  #: (h, w): FLIP, 0 alike to 1


def diff(
    first: Picture | Path | numpy.typing.ArrayLike,
    second: Picture | Path | numpy.typing.ArrayLike,
    *,
    exposure: str | float | None = None,
    tone_curve: str = "pbr-neutral",
    tolerance: float = 0.0,
) -> Difference:
    """How far a picture is from its reference, `first`, as the eye sees it (FLIP) and in numbers.

    Both are files (FILE:LAYER of an OpenEXR file too), or both pictures or arrays of linear radiance (h, w, 3 or 4).
    exposure: of linear pictures for FLIP, as of render(); None: as the first one's meter says. Numbers are of linear radiance,
    or of files of display pictures what is shown, 0 to 1. Raises Error where sizes differ.
    """
    is_file = [isinstance(source, (str, os.PathLike)) for source in (first, second)]
    if is_file[0] != is_file[1]:
        raise _candela.Error("second: either both are files or none is")
    if isinstance(first, (str, os.PathLike)) and isinstance(second, (str, os.PathLike)):
        made = _candela.diff_files(os.fspath(first), os.fspath(second), exposure, tone_curve, tolerance)
    else:
        made = _diff_in_memory({"first": first, "second": second}, exposure, tone_curve, tolerance)
    made["layers"] = [LayerDifference(**layer) for layer in made["layers"]]
    return Difference(**made)


def _diff_in_memory(pictures: Mapping[str, object], exposure: str | float | None, tone_curve: str,
                    tolerance: float) -> dict[str, typing.Any]:  # fmt: skip
    """By way of OpenEXR files, which hold them as they are."""
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        for name, picture in pictures.items():
            if isinstance(picture, Picture):
                picture.save(os.path.join(folder, name + ".exr"))
            else:
                _candela.save_array(os.path.join(folder, name + ".exr"), picture, name)
        try:
            first, second = (os.path.join(folder, name + ".exr") for name in pictures)
            return _candela.diff_files(first, second, exposure, tone_curve, tolerance)
        except _candela.Error as error:
            raise _candela.Error(str(error).replace(folder + os.sep, "").replace(".exr", "")) from None
