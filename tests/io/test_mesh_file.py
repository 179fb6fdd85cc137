"""Meshes from files: as they are meant, or refused in a sentence."""

from pathlib import Path

import numpy as np
import pytest
import pyvista

from studio.io.meshes.mesh_file import read_mesh

OBJ = "v 0 0 0\nv 100 0 0\nv 100 0 100\nv 0 0 100\nv 50 80 50\nf 1 2 3 4\nf 1 2 5\n"
STL = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n"
PLY = (
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n2 0 0\n0 0 3\n3 0 1 2\n"
)


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
