"""A ground out of a JSON file by hand: every kind, and a sentence for what is none."""

import json

import numpy as np
import pytest

from studio.core.errors import StudioError
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


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        ("[1]", "expected a record"),
        ("{", "not readable as JSON"),
        ('{"kind": "sea"}', "kind: expected one of flat, slope"),
        ('{"kind": "slope", "steepness": 1}', "'steepness' is not known here"),
        ('{"kind": "slope", "angle": "much"}', "angle: a number expected"),
        ('{"kind": "slope", "height": 1e9}', "height: 1000000000.0 is too large to be true"),
        ('{"kind": "height_map", "heights": [[0, 1], [0]]}', "heights"),
        ('{"kind": "mesh", "mesh": "../block.obj"}', "leads out of its folder"),
        ('{"kind": "mesh", "mesh": "/etc/passwd"}', "is not in its folder"),
        ('{"kind": "mesh", "mesh": "gone.obj"}', "gone.obj could not be read: there is no such file"),
    ],
)
def test_what_is_no_ground_is_refused_in_a_sentence(tmp_path, content, sentence):
    (tmp_path / "ground.json").write_text(content)
    with pytest.raises(StudioError, match=r"ground\.json") as refused:
        read_ground(tmp_path / "ground.json")
    assert sentence in str(refused.value)
