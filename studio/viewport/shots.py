"""The pictures of a film of the viewport, asked of another process: what it has to know, and how that gets there."""

import copyreg
import pickle
from collections.abc import Mapping
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from types import MappingProxyType
from typing import IO, Any

from studio.core.constraints.base import BodyPoint
from studio.core.project import Project
from studio.viewport.camera import OrbitCamera


def _read_only(entities: dict[str, Any]) -> Mapping[str, Any]:
    return MappingProxyType(entities)


_REDUCERS = copyreg.dispatch_table | {MappingProxyType: lambda entities: (_read_only, (dict(entities),))}
"""How to send what ``pickle`` cannot."""


@dataclass(frozen=True)
class View:
    """How the viewport shows the stage, but for what serves only to edit it."""

    camera: OrbitCamera
    height: float
    """Of the viewport in logical pixels, by which painted lines get as thick as there."""
    bones: bool = False
    trail: BodyPoint | None = None
    ghost_of: str | None = None
    """The performer whose source is seen as a ghost."""
    followed: str | None = None
    """The performer with whom the camera goes."""
    time: float = 0.0
    """Seconds at which the camera stands as it does."""


@dataclass(frozen=True, eq=False)
class Shots:
    """The pictures of a film."""

    project: Project
    view: View
    times: tuple[float, ...]
    """Seconds, one a picture."""
    size: tuple[int, int]
    """Width and height in pixels."""
    stem: Path | None = None
    """With a number behind it, the PNG file that each becomes; without, they go out one behind the other."""


def send(shots: Shots, stream: IO[bytes]) -> None:
    """Write what ``receive`` reads: arrays as they lie in memory, so that a long capture keeps nobody waiting."""
    head, buffers = BytesIO(), list[pickle.PickleBuffer]()
    pickler = pickle.Pickler(head, protocol=5, buffer_callback=buffers.append)
    pickler.dispatch_table = _REDUCERS
    pickler.dump(shots)
    arrays = [buffer.raw() for buffer in buffers]
    pickle.dump((head.getvalue(), [len(array) for array in arrays]), stream)
    for array in arrays:
        stream.write(array)


def receive(stream: IO[bytes]) -> Shots:
    """The shots that this studio has sent."""
    head, sizes = pickle.load(stream)
    shots: Shots = pickle.loads(head, buffers=[stream.read(size) for size in sizes])
    return shots
