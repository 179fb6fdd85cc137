"""Meshes from files: as they are meant, or refused in a sentence."""

import struct
from pathlib import Path

import numpy as np
import pytest
import pyvista

from studio.core.errors import StudioError
from studio.io.meshes.mesh_file import read_mesh

OBJ = "v 0 0 0\nv 100 0 0\nv 100 0 100\nv 0 0 100\nv 50 80 50\nf 1 2 3 4\nf 1 2 5\n"
STL = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n"
PLY = (
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n2 0 0\n0 0 3\n3 0 1 2\n"
)
FACELESS = (
    b"ply\nformat binary_little_endian 1.0\nelement face 3000000\nproperty list uchar int vertex_indices\nend_header\n"
    + bytes(3_000_000)
)
"""Three million faces without a corner."""


def written(folder: Path, name: str, content: str | bytes) -> Path:
    path = folder / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


def test_an_obj_of_centimetres_with_y_up_stands_upright_in_metres(tmp_path: Path) -> None:
    read = read_mesh(written(tmp_path, "stool.obj", OBJ))
    assert read.mesh.vertices.max(axis=0) == pytest.approx([1.0, 1.0, 0.8])
    assert len(read.mesh.triangles) == 3
    assert "centimetres, Y up" in read.guesses


@pytest.mark.parametrize(("name", "content", "size"), [("a.stl", STL, [1, 1, 0]), ("a.PLY", PLY, [2, 0, 3])])
def test_stl_and_ply_are_read_as_they_are(tmp_path: Path, name: str, content: str, size: list[float]) -> None:
    assert np.ptp(read_mesh(written(tmp_path, name, content)).mesh.vertices, axis=0) == pytest.approx(size)


@pytest.mark.parametrize(
    ("name", "content", "sentence"),
    [
        ("a.obj", "nonsense", "no triangle"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "not a vertex"),
        ("a.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "not finite"),
        ("a.stl", b"\x00" * 80 + struct.pack("<I", 5) + b"\x01" * 20, "no triangle|readable"),
        ("a.ply", "", "no triangle|readable"),
        ("a.ply", FACELESS, "more than 2000000 of 'face'"),
        ("a.fbx", "", "not from '.fbx'"),
    ],
)
def test_what_is_no_mesh_is_refused_by_name(tmp_path: Path, name: str, content: str | bytes, sentence: str) -> None:
    path = written(tmp_path, name, content)
    with pytest.raises(StudioError, match=sentence) as caught:
        read_mesh(path)
    assert name in str(caught.value)


@pytest.mark.parametrize(
    ("name", "binary"), [("a.obj", False), ("a.stl", True), ("a.stl", False), ("a.ply", True), ("a.ply", False)]
)
def test_what_another_program_has_written_is_read_as_it_is(tmp_path: Path, name: str, binary: bool) -> None:
    ball = pyvista.Sphere(theta_resolution=9, phi_resolution=7)
    ball.save(tmp_path / name, **({} if name == "a.obj" else {"binary": binary}))
    read = read_mesh(tmp_path / name).mesh
    corners = ball.points[ball.faces.reshape(-1, 4)[:, 1:]].astype(float)
    if name == "a.obj":
        corners = corners @ np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
    assert np.abs(np.sort(read.vertices[read.triangles], axis=None) - np.sort(corners, axis=None)).max() < 1e-5
    assert np.abs(read.vertices[read.triangles].mean(axis=1) - corners.mean(axis=1)).max() < 1e-5


HEAD = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
FACES = "element face 1\nproperty list uchar int vertex_indices\nend_header\n"


@pytest.mark.parametrize(
    ("name", "content", "sentence"),
    [
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4\n", "line 4: '-4' is not the number of a vertex"),
        (
            "a.obj",
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999999999999\n",
            "line 4: '9999.*is not the number of a vertex",
        ),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 " + "9" * 5000, "line 4"),
        ("a.obj", "v 0 0\n", "line 1: 'v 0 0' cannot be read"),
        ("a.ply", HEAD + FACES + "0 0 0\n1 0 0\n0 1 0\n3 0 1 77\n", "not a vertex"),
        ("a.ply", HEAD + FACES + "0 0 0\n1 0 0\n0 1 0\n3 0 1\n", "cut off"),
        ("a.ply", HEAD + FACES + "0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n", "cut off"),
        (
            "a.ply",
            HEAD.replace("3", "999999999999") + FACES + "0 0 0\n",
            "it says that it has 999999999999 of 'vertex'",
        ),
        ("a.ply", HEAD.replace("ascii", "binary_big_endian") + FACES + "0", "cut off"),
        ("a.ply", HEAD.replace("property float x\n", "") + FACES + "0 0 0 0 0 0", "no x, y and z"),
        ("a.stl", b"\x00" * 80 + b"\xff\xff\xff\xff", "it says that it has 4294967295 triangles and has 0"),
        ("a.stl", "solid a\nvertex 0 0 0\n", "cut off"),
    ],
)
def test_no_size_and_no_index_of_a_file_is_believed(
    tmp_path: Path, name: str, content: str | bytes, sentence: str
) -> None:
    with pytest.raises(StudioError, match=sentence):
        read_mesh(written(tmp_path, name, content))


def test_a_file_that_is_not_there_is_said_so(tmp_path: Path) -> None:
    with pytest.raises(StudioError, match="no such file"):
        read_mesh(tmp_path / "a.obj")
