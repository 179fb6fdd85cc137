"""A ground out of a JSON file by hand: every kind, and a sentence for what is none."""

import json

import numpy as np
import pytest

from studio.core.grounds import HeightMap, Slope, Steps, SurfaceMesh
from studio.core.grounds.ground import Ground
from studio.io.project.ground_file import read_ground

BLOCK = "v 0 0 0\nv 0 0 1\nv 1 0 0\nf 1 2 3\n"


@pytest.mark.parametrize(
    ("record", "ground"),
    [
        ({}, Ground()),
        ({"height": 0.2}, Ground(0.2)),
        ({"kind": "slope", "angle": 0.1}, Slope(angle=0.1)),
        ({"kind": "steps", "rise": 0.1, "count": 3}, Steps(rise=0.1, count=3)),
        ({"kind": "height_map", "heights": [[0, 1], [0, 1]]}, HeightMap(heights=np.array([[0.0, 1.0], [0.0, 1.0]]))),
    ],
)
def test_a_record_is_the_ground_that_a_project_has(tmp_path, record, ground):
    (tmp_path / "ground.json").write_text(json.dumps(record))
    assert read_ground(tmp_path / "ground.json") == ground


def test_a_mesh_is_a_file_beside(tmp_path):
    (tmp_path / "block.obj").write_text(BLOCK)
    (tmp_path / "ground.json").write_text('{"kind": "mesh", "mesh": "block.obj"}')
    ground = read_ground(tmp_path / "ground.json")
    assert isinstance(ground, SurfaceMesh)
    assert len(ground.triangles) == 1
