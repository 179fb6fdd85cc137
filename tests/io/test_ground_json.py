"""Every kind of ground goes into a project file and comes back; files that know only a height are still read."""

import json
from pathlib import Path

import numpy as np
import pytest

from studio.core.grounds import Bumps, HeightMap, Slope, Steps, SurfaceMesh
from studio.core.grounds.ground import Ground
from studio.core.stage.project import GROUND_ID, Project
from studio.io.project.entity_json import entity_of, entity_record, project_json, project_of
from studio.io.project.project_file import read_project, write_project

RANDOM = np.random.default_rng(0)
GROUNDS = (
    Ground(0.2),
    Slope(0.1, 0.2, -1.0, (1.0, 2.0)),
    Steps(-0.1, -0.17, 0.31, 7, 0.5, (0.1, 0.2)),
    Bumps(0.0, 0.05, 1.3, 4),
    HeightMap(0.1, RANDOM.normal(size=(30, 20)), 0.2, (-1.0, 1.0)),
    HeightMap(0.1, RANDOM.normal(size=(3, 4))),
    SurfaceMesh(0.0, RANDOM.normal(size=(40, 3)), RANDOM.integers(0, 40, (30, 3))),
)


@pytest.mark.parametrize("ground", GROUNDS, ids=lambda ground: ground.kind)
def test_a_ground_comes_back_as_it_was(ground: Ground, tmp_path: Path) -> None:
    file = tmp_path / "ground.studio"
    write_project(file, Project(grounds={GROUND_ID: ground}), "0123456789ab")
    again = read_project(file).project
    assert type(again.ground) is type(ground)
    assert again.ground == ground
    first: dict = {}
    second: dict = {}
    assert project_json(again, first) == project_json(Project(grounds={GROUND_ID: ground}), second)
    assert first.keys() == second.keys()


def test_a_ground_of_old_that_has_only_a_height_is_flat() -> None:
    record = {"id": GROUND_ID, "height": 0.25, "schema": 1}
    assert entity_of("grounds", record, lambda _: np.zeros(0)) == Ground(0.25)
    assert entity_of("grounds", {"height": 0.0}, lambda _: np.zeros(0)) == Ground()


def test_the_kind_stands_in_the_record() -> None:
    assert entity_record("grounds", GROUND_ID, Steps(), {})["kind"] == "steps"


def test_a_ground_that_makes_no_sense_is_left_out_with_a_sentence() -> None:
    record = {"grounds": [{"id": GROUND_ID, "kind": "steps", "tread": 0.0}]}
    read = project_of(json.loads(json.dumps(record)), lambda _: np.zeros(0))
    assert read.project.ground == Ground()
    assert "treads of at least 0.02 m" in read.losses[0]
