"""Files of every small format that are refused in a sentence; the greater formats have tables beside their readers."""

import struct
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from studio.io.importing import load_capture
from studio.io.markers.maps import read_map
from studio.io.meshes.mesh_file import read_mesh
from studio.io.project.character_file import read_character
from studio.io.project.ground_file import read_ground
from studio.io.project.project_file import read_project
from studio.io.trc.reader import read_trc
from studio.library.saved_poses import read_pose
from tests.io.fbx_text import fbx_text
from tests.io.refused import refused
from tests.io.trc_text import KEYS

THREE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
CORNERS = "0 0 0\n1 0 0\n0 1 0\n"
HEAD = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
FACES = "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
FACELESS = HEAD[:4].encode() + b"format binary_little_endian 1.0\n" + FACES.replace("1", "3000000").encode()
STL = b"\x00" * 80
TRC = f"PathFileType\t4\n{KEYS}\n"
INSTEAD = ".*BVH or GLB"

Case = tuple[str | bytes, str]
"""A content, and the words in its refusal."""

OBJECTS: tuple[Case, ...] = (
    ("nonsense", "no triangle"),
    (f"{THREE}f 1 2 9\n", "not a vertex"),
    (f"{THREE}f 1 2 -4\n", "line 4: '-4' is not the number of a vertex"),
    (f"{THREE}f 1 2 99999999999999999999\n", "line 4: '9999.*is not the number of a vertex"),
    (f"{THREE}f 1 2 " + "9" * 5000, "line 4"),
    ("v 0 0\n", "line 1: 'v 0 0' cannot be read"),
    ("v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "not finite"),
)
SURFACES: tuple[Case, ...] = (
    ("", "no triangle|readable"),
    (FACELESS + bytes(3_000_000), "more than 2000000 of 'face'"),  # three million faces without a corner
    (f"{HEAD}{FACES}{CORNERS}3 0 1 77\n", "not a vertex"),
    (f"{HEAD}{FACES}{CORNERS}3 0 1\n", "cut off"),
    (f"{HEAD}{FACES}{CORNERS}-3 0 1 2\n", "cut off"),
    (HEAD.replace("3", "999999999999") + FACES + "0 0 0\n", "it says that it has 999999999999 of 'vertex'"),
    (HEAD.replace("ascii", "binary_big_endian") + FACES + "0", "cut off"),
    (HEAD.replace("property float x\n", "") + FACES + "0 0 0 0 0 0", "no x, y and z"),
)
PRINTS: tuple[Case, ...] = (
    (STL + struct.pack("<I", 5) + b"\x01" * 20, "no triangle|readable"),
    (STL + b"\xff\xff\xff\xff", "it says that it has 4294967295 triangles and has 0"),
    ("solid a\nvertex 0 0 0\n", "cut off"),
)
GROUNDS: tuple[Case, ...] = (
    ("[1]", "expected a record"),
    ("{", "not readable as JSON"),
    ('{"kind": "sea"}', "kind: expected one of flat, slope"),
    ('{"kind": "slope", "steepness": 1}', "'steepness' is not known here"),
    ('{"kind": "slope", "angle": "much"}', "angle: a number expected"),
    ('{"kind": "slope", "height": 1e9}', r"height: 1000000000\.0 is out of range"),
    ('{"kind": "height_map", "heights": [[0, 1], [0]]}', "heights"),
    ('{"kind": "mesh", "mesh": "../block.obj"}', "leads out of its folder"),
    ('{"kind": "mesh", "mesh": "/etc/passwd"}', "is not in its folder"),
    ('{"kind": "mesh", "mesh": "gone.obj"}', r"gone\.obj could not be read: there is no such file"),
)
MARKER_MAPS: tuple[Case, ...] = (
    ("{", "take.json is not readable as JSON"),
    ("[]", "take.json is not a marker map"),
    ('{"name": "x", "markers": {"left_kneee": ["A"]}}', "'left_kneee' is not a body location"),
    ('{"name": "x", "markers": {"left_knee": "A"}}', "'left_knee' needs a list of labels"),
    ("[" * 100000, "take.json is not readable as JSON"),
)
TABLES: tuple[Case, ...] = (
    ("PathFileType\t4\n", "line 2: the file ends within its header"),
    (f"{TRC}1\t1\nFrame#\tTime\n1\t0\n", "line 4: no marker has a name"),
    (f"{TRC}100\t100\nFrame#\tTime\tA\t\t\n", "there is no row with a frame"),
    (
        f"{TRC}100\t100\nFrame#\tTime\tA\t\t\n\tX1\tY1\tZ1\n1\t0.0\t1\t2\tthree\n",
        "line 6: 'three' is not a number",
    ),
    (
        f"{TRC}100\t100\nFrame#\tTime\tA\t\t\n1\t0.0\t1\t2\t3\t4\n2\t0.01\t1\t2\t3\t4\n",
        "line 5: 6 numbers stand here where 1 markers need 5",
    ),
)
SCENES: tuple[Case, ...] = (
    (b"; FBX 7.4.0 project file\nDear diary", f"(it has no skeleton|could not be read as FBX){INSTEAD}"),
    (fbx_text()[:1500], f"(could not be read as FBX|it has no skeleton){INSTEAD}"),
    (b"Kaydara FBX Binary  \0\x1a\0\xe8\x1c\0\0" + b"\xff" * 40, f"could not be read as FBX{INSTEAD}"),
    (fbx_text().replace('"LimbNode"', '"Camera"'), f"it has no skeleton{INSTEAD}"),
    (
        fbx_text().replace('"LocalStop", "KTime", "Time", "",', '"LocalStop", "KTime", "Time", "",4444444'),
        f"it says that it has [0-9]+ frames{INSTEAD}",
    ),
)
NO_RECORD: tuple[Case, ...] = tuple((text, r"take\.json") for text in ("", "{", "[1]", "[]", "3", "null", "\0\1", "{}"))
PROJECTS: tuple[Case, ...] = (
    (b"", "is empty"),
    (b"HIERARCHY\nROOT Hips\n" * 50, "not a ZIP archive"),
    (b"PK\x03\x04", "not a ZIP archive"),
    (bytes(range(256)) * 20, "not a ZIP archive"),
)
FILES: dict[tuple[str, Callable[[Path], object]], tuple[Case, ...]] = {
    ("take.obj", read_mesh): OBJECTS,
    ("take.ply", read_mesh): SURFACES,
    ("take.stl", read_mesh): PRINTS,
    ("take.fbx", read_mesh): (("", r"not from '\.fbx'"),),
    ("ground.json", read_ground): tuple((text, rf"(?s)(?=.*ground\.json).*{words}") for text, words in GROUNDS),
    ("take.json", read_map): MARKER_MAPS,
    ("take.trc", read_trc): TABLES,
    ("take.fbx", load_capture): SCENES,
    ("take.json", read_character): NO_RECORD,
    ("take.json", read_pose): NO_RECORD,
    ("take.studio", read_project): PROJECTS,
}


@pytest.mark.parametrize(
    ("name", "read", "content", "words"),
    [
        pytest.param(name, read, *case, id=f"{read.__name__} {name} {number}")
        for (name, read), cases in FILES.items()
        for number, case in enumerate(cases)
    ],
)
def test_it_is_refused_in_a_sentence(
    tmp_path: Path, name: str, read: Callable[[Path], Any], content: str | bytes, words: str
) -> None:
    refused(read, tmp_path / name, content, words)


@pytest.mark.parametrize("read", [read_mesh, partial(read_pose)], ids=["a mesh", "a pose"])
def test_a_file_that_is_not_there_is_said_so(tmp_path: Path, read: Callable[[Path], object]) -> None:
    with pytest.raises(Exception, match="no such file"):
        read(tmp_path / "gone.obj")
