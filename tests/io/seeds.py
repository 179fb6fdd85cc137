"""A small good file of every kind that the studio reads, to be spoilt: by suffix, with what reads it."""

import json
import zipfile
from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from random import Random

from studio.io.c3d_writer import write_c3d
from studio.io.character_file import write_character
from studio.io.constraint_file import constraint_record, read_constraints
from studio.io.export import write_capture
from studio.io.importing import GUESS_ALL
from studio.io.project_file import read_project, write_project
from studio.io.registry import format_of
from tests.builders import make_capture, make_character, make_constraint, make_project
from tests.io.character_files import Gltf, vrml, x3d
from tests.io.fbx_text import fbx_text
from tests.io.test_fuzz import bytes_changed, numbers_changed
from tests.io.trials import make_trial

Write = Callable[[Path], object]


def _text(make: Callable[[], str]) -> Write:
    return lambda path: path.write_text(make(), encoding="utf-8", newline="\n")


def _constraints(path: Path) -> None:
    record = {"constraints": [constraint_record(make_constraint())], "contacts": {"left_heel": [[0, 20]]}}
    path.write_text(json.dumps(record))


SEEDS: dict[str, Write] = {
    ".bvh": lambda path: write_capture(make_capture(frames=6), path),
    ".fbx": _text(fbx_text),
    ".s4d": lambda path: write_capture(make_capture(), path),
    ".c3d": lambda path: write_c3d(path, make_trial()),
    ".glb": lambda path: path.write_bytes(Gltf().moving().glb()),
    ".gltf": lambda path: path.write_bytes(Gltf().moving().gltf()),
    ".vrm": lambda path: path.write_bytes(Gltf(vrm=1).glb()),
    ".x3d": _text(x3d),
    ".wrl": _text(vrml),
    ".vrml": _text(vrml),
    ".x3dv": _text(lambda: vrml(header="#X3D V3.0 utf8\nPROFILE Immersive")),
    ".json": lambda path: write_character(make_character(), path),
    ".studio": lambda path: write_project(path, make_project(), "0" * 32),
    ".constraints": _constraints,
}
"""The suffix of constraints is this table's own: their files end with .json too."""


def spoiled(random: Random, content: bytes) -> bytes:
    """Changed in a few places; of an archive mostly one member, in an archive that is whole again."""
    if content.startswith(b"PK") and random.random() < 0.7:
        return _member_spoiled(random, content)
    return (bytes_changed if random.random() < 0.6 else numbers_changed)(random, content)


def _member_spoiled(random: Random, content: bytes) -> bytes:
    with zipfile.ZipFile(BytesIO(content)) as archive:
        members = {entry.filename: archive.read(entry) for entry in archive.infolist()}
    members.pop("manifest.json", None)  # it would only tell that a member is another one
    name = random.choice(sorted(members))
    members[name] = bytes_changed(random, members[name])
    if name.endswith(".json") and random.random() < 0.5:
        members[name] = numbers_changed(random, members[name])
    packed = BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        for each, member in members.items():
            archive.writestr(zipfile.ZipInfo(each), member)
    return packed.getvalue()


def read(path: Path) -> None:
    """Read the file by whatever reads its kind. Raises StudioError."""
    match path.suffix:
        case ".studio":
            read_project(path)
        case ".constraints":
            read_constraints(path, "motion")
        case _:
            found = format_of(path, "capture_reader", "character_reader")
            for reader in ("read_capture", "read_character"):
                if getattr(found, reader.removeprefix("read_") + "_reader"):
                    getattr(found, reader)(path, GUESS_ALL, lambda _share, _text: None)
