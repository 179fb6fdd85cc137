"""Input of the child process that renders a video: the images to render, and their serialisation."""

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
    """Display settings of the images, without what serves only editing."""

    camera: OrbitCamera
    height: float
    """Height of the 3D view in logical pixels, to which painted line widths are relative."""
    bones: bool = False
    trail: BodyPoint | None = None
    ghost_of: str | None = None
    """Id of the performer whose source is shown as a ghost."""
    followed: str | None = None
    """Id of the performer that the camera follows."""
    time: float = 0.0
    """Stage time in seconds at which the camera is at its placement."""
    turning: float = 0.0
    """Turntable speed in radians per second."""


@dataclass(frozen=True, eq=False)
class Shots:
    """Images of a video."""

    project: Project
    view: View
    times: tuple[float, ...]
    """Stage time in seconds of each image."""
    size: tuple[int, int]
    """Width and height in pixels."""
    stem: Path | None = None
    """Path of the PNG files without number and suffix; None to write raw images to standard output."""


def send_shots(shots: Shots, stream: IO[bytes]) -> None:
    """Write shots to a stream: a line of JSON, the project as in its file, and its arrays."""
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
    """Read shots written by ``send_shots``; nothing in them is executed. Raises StudioError or ValueError for invalid
    input.
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
