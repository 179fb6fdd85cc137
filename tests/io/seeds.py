"""A small good file of every kind that the studio reads, to be spoilt: by suffix, with what reads it."""

import hashlib
import json
import struct
import zipfile
from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from random import Random

from studio.io.acclaim.skeleton import read_asf
from studio.io.c3d.writer import write_c3d
from studio.io.export import write_capture
from studio.io.importing import GUESS_ALL
from studio.io.meshes.mesh_file import read_mesh
from studio.io.project.character_file import mesh_bytes, write_character
from studio.io.project.character_file import read_mesh as read_skin
from studio.io.project.constraint_file import constraint_record, read_constraints
from studio.io.project.ground_file import read_ground
from studio.io.project.project_file import read_project, write_project
from studio.io.registry import format_of
from tests.builders import make_capture, make_character, make_constraint, make_project
from tests.io.acclaim_text import amc_text, asf_text, motion
from tests.io.character_files import Gltf, vrml, x3d
from tests.io.fbx_skin import skinned_fbx
from tests.io.test_fuzz import bytes_changed, numbers_changed
from tests.io.trc_text import trc_text
from tests.io.trials import make_trial

Write = Callable[[Path], object]


def _text(make: Callable[[], str]) -> Write:
    return lambda path: path.write_text(make(), encoding="utf-8", newline="\n")


def _constraints(path: Path) -> None:
    record = {"constraints": [constraint_record(make_constraint())], "contacts": {"left_heel": [[0, 20]]}}
    path.write_text(json.dumps(record))


def _acclaim(path: Path) -> None:
    """A motion, and the skeleton that belongs to it beside it."""
    path.with_suffix(".asf").write_text(asf_text())
    path.write_text(amc_text(motion(6)))


SEEDS: dict[str, Write] = {
    ".bvh": lambda path: write_capture(make_capture(frames=6), path),
    ".fbx": _text(skinned_fbx),
    **dict.fromkeys((".usda", ".usdc", ".usd", ".usdz"), lambda path: write_capture(make_capture(frames=6), path)),
    ".s4d": lambda path: write_capture(make_capture(), path),
    ".c3d": lambda path: write_c3d(path, make_trial()),
    ".trc": _text(lambda: trc_text(make_trial(("LASI", "RASI", "LKNE")))),
    ".amc": _acclaim,
    ".asf": _text(asf_text),
    ".glb": lambda path: path.write_bytes(Gltf().moving().glb()),
    ".gltf": lambda path: path.write_bytes(Gltf().moving().gltf()),
    ".vrm": lambda path: path.write_bytes(Gltf(vrm=1).glb()),
    ".vrma": lambda path: write_capture(make_capture(frames=6), path),
    ".x3d": _text(x3d),
    ".wrl": _text(vrml),
    ".vrml": _text(vrml),
    ".x3dv": _text(lambda: vrml(header="#X3D V3.0 utf8\nPROFILE Immersive")),
    ".json": lambda path: write_character(make_character(), path),
    ".studio": lambda path: write_project(path, make_project(), "0" * 32),
    ".constraints": _constraints,
    ".ground": _text(lambda: json.dumps({"kind": "height_map", "heights": [[0, 0.1], [0.2, 0]], "cell": 0.5})),
    ".obj": _text(lambda: OBJ),
    ".stl": _text(lambda: STL),
    ".ply": lambda path: path.write_bytes(PLY),
    ".npz": lambda path: path.write_bytes(mesh_bytes(make_character().skin)),
}
"""The suffixes of constraints and grounds are this table's own: their files end with .json too."""
OBJ = "# a roof\nv 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nv 0.5 1 0.5\nf 1 2 3 4\nf 1/1/1 2/2/2 5\nf -4 -3 -1\n"
STL = "".join(
    ["solid a\n"]
    + [
        f"facet normal 0 0 1\nouter loop\nvertex 0 0 {z}\nvertex 1 0 {z}\nvertex 0 1 0\nendloop\nendfacet\n"
        for z in "123"
    ]
    + ["endsolid\n"]
)
PLY = (
    b"ply\nformat binary_little_endian 1.0\ncomment a tent\nelement vertex 4\nproperty float x\nproperty float y\n"
    b"property float z\nproperty uchar red\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
    + b"".join(struct.pack("<3fB", *place, 9) for place in ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 1)))
    + struct.pack("<B4iB3i", 4, 0, 1, 2, 3, 3, 0, 1, 3)
)


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
    members = _sealed(name, members)
    return _packed(random, members)


def _packed(random: Random, members: dict[str, bytes]) -> bytes:
    """Mostly as the studio does it; also as other programs might, and then perhaps damaged."""
    method = random.choice((zipfile.ZIP_STORED,) * 5 + (zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA))
    packed = BytesIO()
    with zipfile.ZipFile(packed, "w", method) as archive:
        for name, member in members.items():
            archive.writestr(zipfile.ZipInfo(name), member, method)
    content = bytearray(packed.getvalue())
    if method != zipfile.ZIP_STORED and random.random() < 0.5:
        for _ in range(random.choice([1, 5, 50])):  # nothing moves, so that what unpacks it comes upon it
            content[random.randrange(len(content))] ^= random.randrange(256)
    return bytes(content)


def _sealed(name: str, members: dict[str, bytes]) -> dict[str, bytes]:
    """With a member of arrays under the name that its new content has: it looks undamaged."""
    if not name.endswith(".npy"):
        return members
    folder, _, _ = name.partition("/")
    new = f"{folder}/{hashlib.sha256(members[name]).hexdigest()}.npy"
    return {
        (new if key == name else key): content.replace(name.encode(), new.encode())
        if key.endswith(".json")
        else content
        for key, content in members.items()
    }


def read(path: Path) -> None:
    """Read the file by whatever reads its kind. Raises StudioError."""
    match path.suffix:
        case ".studio":
            read_project(path)
        case ".constraints":
            read_constraints(path, "motion")
        case ".ground":
            read_ground(path)
        case ".npz":
            read_skin(path.read_bytes(), path.name)
        case ".obj" | ".stl" | ".ply":
            read_mesh(path)
        case ".asf":
            read_asf(path)
        case _:
            found = format_of(path, "capture_reader", "character_reader")
            for reader in ("read_capture", "read_character"):
                if getattr(found, reader.removeprefix("read_") + "_reader"):
                    getattr(found, reader)(path, GUESS_ALL, lambda _share, _text: None)
