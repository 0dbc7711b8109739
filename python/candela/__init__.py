"""Physically based pictures of glTF scenes, as numpy arrays.

    import candela

    scene = candela.load("helmet.glb")
    picture = candela.render(scene, camera=candela.fit("iso"), size=(512, 512), spp=64, layers=["depth", "normal"])
    picture["depth"]  # (512, 512) float32
    picture.to_png("helmet.png")

Metres, radians unless a name ends in _deg, seconds, linear Rec.709 radiance; right-handed, +y up. What goes wrong is a
candela.Error with one line that says what and where; what is odd is a warning of the category candela.Warning.
"""

from __future__ import annotations

import os

from candela._candela import (
    Camera,
    Dataset,
    Environment,
    Error,
    Light,
    Material,
    Mesh,
    Movie,
    Node,
    Picture,
    PosedCamera,
    Progress,
    Scene,
    Texture,
    Warning,
    __version__,
    pinhole,
    run_lengths,
)
from candela import _candela

TYPE_CHECKING = False  # as type checkers know it; typing and dataclasses take longer to import than all the rest
if TYPE_CHECKING:
    import typing
    from collections.abc import Callable, Iterable, Mapping, Sequence

    import numpy.typing

    from candela._data import SeenObject, seen_objects
    from candela._recipes import (
        Bake,
        Difference,
        Finding,
        Law,
        LayerDifference,
        Proof,
        Verdict,
        bake,
        check,
        diff,
        furnace,
        furnace_sheet,
    )

    Path = typing.Union[str, "os.PathLike[str]"]
    Callback = Callable[[Progress], object]

__all__ = [
    "Bake", "Camera", "Dataset", "Difference", "Environment", "Error", "Finding", "Framing", "Law", "LayerDifference",
    "Light", "Material", "Mesh", "Movie", "Node", "Picture", "PosedCamera", "Progress", "Proof", "Scene", "SeenObject",
    "Texture", "Verdict", "Warning", "__version__", "bake", "check", "diff", "environment", "fit", "furnace",
    "furnace_sheet", "layer_names", "load", "look_at", "orbit", "pinhole", "read_cameras", "render", "run_lengths",
    "seen_objects", "write_cameras",
]  # fmt: skip


if not TYPE_CHECKING:

    def __getattr__(name):
        """What is imported when it is first asked for."""
        if name not in __all__:
            raise AttributeError(f"module 'candela' has no attribute '{name}'")
        from candela import _data, _recipes

        value = globals()[name] = getattr(_data if hasattr(_data, name) else _recipes, name)
        return value

    def __dir__():
        return sorted({*globals(), *__all__})


def load(source: Path | bytes | bytearray | memoryview, *, variant: str = "", scene: str = "", animation: str | None = None,
         time: float | None = None, root: Path = "", texture_memory: int = 0) -> Scene:  # fmt: skip
    """The scene of a file, of the bytes of a .glb, .gltf or .zip, or a built-in one, "demo:NAME".

    variant: a look of the file, by name. scene: which of its scenes, by name or number.
    animation, time: the moment of an animation, by name or number, seconds; else as the file stands.
    root: a folder; what lies or leads outside of it is refused. Bytes may name no other files.
    texture_memory: bytes into which all images have to fit; 0 = as they are.

    Raises Error. Oddities of the file are warnings.
    """
    if isinstance(source, os.PathLike):
        source = os.fspath(source)
    return _candela.load(source, variant, scene, animation, time, os.fspath(root), texture_memory)


def environment(source: Environment | Path | numpy.typing.ArrayLike) -> Environment:
    """Light from infinitely far away, read once for many pictures.

    source: "studio", "studio:dark", "studio:three-point", "sky", "sky:DEGREES", "furnace", "none"; a panorama or cube map
    in a file; or a panorama (h, 2 h, 3) of linear radiance, row 0 straight up, the middle column towards +x.
    """
    return _candela.environment(source)


class Framing:
    """How a picture frames its subject; made by fit(), orbit() and look_at()."""

    def __init__(self, options: Mapping[str, object]) -> None:
        self.options = dict(options)

    def __repr__(self) -> str:
        return "Framing(" + ", ".join(f"{name}={value!r}" for name, value in self.options.items()) + ")"


def _given(**options: object) -> dict[str, object]:
    return {name: value for name, value in options.items() if value is not None}


def fit(view: str | None = None, *, margin: float = 0.08, fov_deg: float | None = None, orthographic: bool = False) -> Framing:
    """The camera that shows the whole subject, fitted to its silhouette.

    view: "front", "back", "left", "right", "top", "bottom", "iso", "three-quarter"; None: where it is best seen from.
    margin: what remains free, as a share of the picture, 0 to 0.45.
    fov_deg: full vertical angle; None: 45.
    """
    return Framing(_given(views=view, margin=margin, fov=fov_deg, projection="orthographic" if orthographic else None))


def orbit(azimuth_deg: float, elevation_deg: float, distance: float = 1.0, *, fov_deg: float | None = None) -> Framing:
    """A camera around and above the subject. Azimuth 0 looks along -z; at distance 1 the subject fits."""
    return Framing(_given(orbit=(azimuth_deg, elevation_deg, distance), fov=fov_deg))


def look_at(eye: numpy.typing.ArrayLike, target: numpy.typing.ArrayLike | None = None, *, fov_deg: float | None = None,
            orthographic: bool = False) -> Framing:  # fmt: skip
    """A camera at a point (3,), metres, that looks at another; None: at the subject's centre. +y is up."""
    return Framing(_given(eye=eye, target=target, fov=fov_deg, projection="orthographic" if orthographic else None))


def read_cameras(path: Path, size: tuple[int, int] = (1280, 720)) -> list[PosedCamera]:
    """The cameras of a file: NeRF's transforms.json, a JSON list of K and world_from_camera, or a scene.

    size: (width, height) of their pictures where the file does not say. Raises Error.
    """
    return _candela.read_cameras(os.fspath(path), size)


def write_cameras(path: Path, cameras: Sequence[PosedCamera], *, files: Sequence[Path] | None = None) -> None:
    """Writes cameras, all of one size, as other programs read them.

    path: a name that begins with "transforms" and ends in .json is written as NeRFs have it, any other .json as a list of K
    and world_from_camera, .gltf as a scene. files: the picture of each, `file_path` of a transforms.json. Raises Error.
    """
    _candela.write_cameras(os.fspath(path), list(cameras), None if files is None else [os.fspath(name) for name in files])


def _text(value: object) -> str:
    if isinstance(value, str):
        return value
    if hasattr(value, "__iter__"):
        items: Iterable[object] = value
        return ",".join(_text(item) for item in items)
    if hasattr(value, "item"):
        value = value.item()
    return repr(value)


def _arguments(options: Mapping[str, object]) -> list[str]:
    """The options as `candela render` takes them."""
    arguments = []
    for name, value in options.items():
        option = "--" + _candela.spellings.get(name, name).replace("_", "-")
        if value is True:
            arguments.append(option)
        elif value is not False and value is not None:
            arguments.append(option + "=" + _text(value))
    return arguments


def render(
    scene: Scene,
    *,
    camera: Framing | PosedCamera | str | int | None = None,
    size: tuple[int, int] = (1280, 720),
    spp: int | None = None,
    seconds: float | None = None,
    noise: float | None = None,
    engine: str = "path",
    layers: Sequence[str] = (),
    objects: bool = False,
    denoise: bool | str | None = None,
    quality: str | None = None,
    environment: Environment | Path | numpy.typing.ArrayLike | None = None,
    environment_rotation_deg: float = 0.0,
    environment_intensity: float = 1.0,
    background: str | Sequence[float] | None = None,
    exposure: str | float | None = None,
    tone_curve: str | None = None,
    seed: int | None = None,
    threads: int = 0,
    progress: Callback | None = None,
    **options: object,
) -> Picture:
    """One picture of a scene. Other Python threads run meanwhile.

    camera: fit(…), orbit(…), look_at(…), pinhole(…), another picture's camera, or a camera of the scene by name or number;
        None: the scene's first camera, else the whole subject.
    size: (width, height), pixels.
    spp: samples per pixel [128]; for engine="raster" frames to average [1].
    seconds: stops after about so long. noise: stops a pixel when the error of what is shown of it, from 0 (black) to 1
        (white), is estimated below this.
    engine: "path", the path tracer; "raster", OpenGL, a frame in a moment.
    layers: some of layer_names(), beside "beauty".
    objects: whether it shall know where its objects are, for Dataset and seen_objects(); it has "instance" and "depth" then.
    denoise: True, "regression" or "oidn"; False also where quality would. quality: "draft", "good" or "final" in place of spp, noise and denoise.
    environment: as of environment(); None: Scene.environment, else what the file asks for, else a studio.
    background: "env", "transparent", or a colour: "#rrggbb" (sRGB) or three linear numbers.
    exposure: "auto" (metered), stops, or "f/8,1/125,100"; tone_curve: "pbr-neutral", "agx", "aces"…: for Picture.save()
        and its like; the arrays are neither exposed nor developed.
    threads: 0 = all; the picture does not depend on it.
    progress: called with a Progress a few times per second, on this thread. Where it returns False the picture is what is
        there by then (Picture.is_complete); what it raises ends the work and arrives here, as Ctrl-C does.
    options: every other option of `candela render --help` that is of one picture, with _ for -: bounces, clamp, filter,
        shading, f_number, focus_distance, blades, ground, studio, glass, and for engine="raster" msaa,
        texture_anisotropy, view, ao, soft_shadows, light_radius, ambient, probes.

    Raises Error.
    """
    given: dict[str, object] = dict(options)
    posed: PosedCamera | None = None
    if isinstance(camera, Framing):
        given.update(camera.options)
    elif isinstance(camera, PosedCamera):
        posed = camera
    elif camera is not None:
        given["camera"] = str(camera)
    light: Environment | None = None
    if isinstance(environment, (str, os.PathLike)):
        given["environment"] = os.fspath(environment)
    elif environment is not None:
        light = _candela.environment(environment)
    width, height = size
    given.update(size=f"{width}x{height}", engine=engine, spp=spp, seconds=seconds, noise=noise, quality=quality,
                 background=background, exposure=exposure, tone_curve=tone_curve, seed=seed)  # fmt: skip
    if layers:
        given["layers"] = list(layers)
    if denoise is not None:
        given["denoise"] = "regression" if denoise is True else denoise or "none"
    if environment_rotation_deg != 0.0:
        given["environment_rotation_deg"] = environment_rotation_deg
    if environment_intensity != 1.0:
        given["environment_intensity"] = environment_intensity
    if threads:
        given["threads"] = threads
    return _candela.render(scene, _arguments(given), posed, light, objects, progress)


def layer_names() -> list[str]:
    """The layers that render() knows."""
    return _candela.layer_names()
