"""Pictures of a film of the viewport, drawn by another process: its input and the transfer of it."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import IO, NoReturn

from studio.core.constraints.base import BodyPoint
from studio.core.stage.project import Project
from studio.io.json_text import json_of
from studio.io.npy import array_of
from studio.io.project.entity_json import Members, npy_parts, parse_member, project_json, project_of
from studio.io.project.value_json import MemberCodec, from_json, to_json
from studio.viewport.camera import OrbitCamera


@dataclass(frozen=True)
class View:
    """Display settings of a picture, without parts that serve only editing."""

    camera: OrbitCamera
    height: float
    """Height of the viewport in logical pixels: painted lines get as thick as there."""
    bones: bool = False
    trail: BodyPoint | None = None
    ghost_of: str | None = None
    """The performer whose source is seen as a ghost."""
    followed: str | None = None
    """The performer with whom the camera goes."""
    time: float = 0.0
    """Seconds at which the camera stands as it does."""
    turning: float = 0.0
    """Radians a second by which the camera goes round its target."""


@dataclass(frozen=True, eq=False)
class Shots:
    """Pictures of a film."""

    project: Project
    view: View
    times: tuple[float, ...]
    """Seconds, one a picture."""
    size: tuple[int, int]
    """Width and height in pixels."""
    stem: Path | None = None
    """With a number behind it, the PNG file that each becomes; without, they go out one behind the other."""


def send_shots(shots: Shots, stream: IO[bytes]) -> None:
    """Write the input of ``receive_shots``: a line of JSON, the project as in its file, and its arrays."""
    members: Members = {}
    project = project_json(shots.project, members)
    arrays = {name: npy_parts(array) for name, array in members.items()}
    head = {
        "view": to_json(shots.view, _NO_ARRAYS),
        "times": shots.times,
        "size": shots.size,
        "stem": str(shots.stem) if shots.stem else None,
        "project": len(project),
        "arrays": {name: sum(map(len, parts)) for name, parts in arrays.items()},
    }
    stream.write(json.dumps(head).encode() + b"\n" + project)
    for parts in arrays.values():
        for part in parts:
            stream.write(part)


def receive_shots(stream: IO[bytes]) -> Shots:
    """Shots written by ``send_shots``, read like any file of ours, without running anything in them.

    Raises StudioError, ValueError.
    """
    head = json_of(stream.readline())
    project = parse_member(stream.read(head["project"]), "project")
    arrays = {name: array_of(stream.read(size)) for name, size in head["arrays"].items()}
    return Shots(
        project_of(project, arrays.__getitem__).project,
        from_json(head["view"], View, _NO_ARRAYS),
        tuple(head["times"]),
        tuple(head["size"]),
        Path(head["stem"]) if head["stem"] else None,
    )


def _none(_array: object) -> NoReturn:
    raise ValueError("A view has no arrays.")


_NO_ARRAYS = MemberCodec(_none, _none)
