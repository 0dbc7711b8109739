"""What a picture shows of its objects, as data sets say it."""

from __future__ import annotations

import dataclasses
import typing

from candela import _candela
from candela._candela import Picture

if typing.TYPE_CHECKING:
    import numpy
    import numpy.typing

    Mask = numpy.typing.NDArray[numpy.bool_]

Box = typing.Tuple[int, int, int, int]


@dataclasses.dataclass(frozen=True)
class SeenObject:
    """An object that stands in a picture's frame, hidden or not. A pixel belongs to what is at its centre."""

    number: int  #: what the layer "instance" holds where it is seen: 1 + the node's place in the scene; 1 of a whole scene
    name: str  #: unique in the picture
    category: str  #: its mesh's name, or the scene's
    mask: Mask  #: (h, w): where it is seen
    amodal: Mask  #: (h, w): where it would be, were nothing before it
    box: Box | None  #: of `mask`: x, y, width, height; None where nothing of it is seen
    amodal_box: Box | None
    visible_fraction: float  #: share of `amodal` that is seen


def seen_objects(picture: Picture, *, instances: str = "node", name: str = "") -> list[SeenObject]:
    """The objects in a picture of render(…, objects=True), by ascending number.

    instances: what an object is: every "node" with a mesh, or the whole "scene", which is called `name`, else Scene.name.
    Raises Error.
    """
    return [SeenObject(**fields) for fields in _candela.seen_objects(picture, instances, name)]
