"""Saved poses are files that come back as they were, and say what is wrong in them."""

import json
import math

import numpy as np
import pytest

from studio.core.body.canonical import BodyLayout, BodyPart
from studio.core.rotations import from_matrix, from_rotation_vector, to_matrix, to_rotation_vector
from studio.core.stage.local_pose import LocalPose, local_pose, offsets_towards
from studio.library.saved_poses import (
    HIPS_HEIGHT_KEY,
    POSE_NAME_KEY,
    POSE_ROTATIONS_KEY,
    delete_pose,
    read_poses,
    rename_pose,
    write_pose,
)

TINY_TURN = math.radians(1e-4)


def some_pose(seed=1):
    numbers = np.random.default_rng(seed).uniform(-1.0, 1.0, (len(BodyPart), 3))
    return LocalPose(dict(zip(BodyPart, map(tuple, numbers.tolist()), strict=True)), 0.93)


def test_a_saved_pose_is_read_as_it_was(tmp_path):
    pose = some_pose()
    saved = write_pose(tmp_path / "new" / "poses", "Bow: deep", pose)
    [again], problems = read_poses(tmp_path / "new" / "poses")
    assert not problems
    assert (again.path, again.name, again.pose.hips_height) == (saved.path, "Bow: deep", 0.93)
    for part in BodyPart:
        assert again.pose.rotations[part] == pytest.approx(pose.rotations[part], abs=TINY_TURN)


def test_a_name_that_differs_by_case_only_does_not_replace_a_file(tmp_path):
    paths = {write_pose(tmp_path, name, some_pose()).path for name in ("Bow", "bow", "b/w", "b:w")}
    assert len({path.name.lower() for path in paths}) == 4
    assert len(read_poses(tmp_path)[0]) == 4


def test_a_renamed_pose_leaves_no_file_behind_and_a_deleted_one_none(tmp_path):
    renamed = rename_pose(write_pose(tmp_path, "Pose 1", some_pose()), "Guard")
    assert [path.name for path in tmp_path.iterdir()] == ["guard.json"]
    delete_pose(renamed)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "damage",
    [
        lambda record: record.pop(POSE_NAME_KEY),
        lambda record: record.pop(HIPS_HEIGHT_KEY),
        lambda record: record.pop(POSE_ROTATIONS_KEY),
        lambda record: record[POSE_ROTATIONS_KEY].pop("head"),
        lambda record: record[POSE_ROTATIONS_KEY].update(tail=[0, 0, 0]),
        lambda record: record[POSE_ROTATIONS_KEY].update(head=[0, 0]),
        lambda record: record[POSE_ROTATIONS_KEY].update(head=[0, 0, "x"]),
        lambda record: record[POSE_ROTATIONS_KEY].update(head=[0, 0, math.inf]),
        lambda record: record[POSE_ROTATIONS_KEY].update(head=[0, 0, 10**400]),
        lambda record: record[POSE_ROTATIONS_KEY].update(head=None),
        lambda record: record.update({HIPS_HEIGHT_KEY: math.nan}),
        lambda record: record.update({HIPS_HEIGHT_KEY: []}),
        lambda record: record.update({POSE_ROTATIONS_KEY: []}),
    ],
)
def test_a_damaged_file_is_reported_by_its_path_and_the_others_are_read(tmp_path, damage):
    write_pose(tmp_path, "Whole", some_pose())
    broken = write_pose(tmp_path, "Broken", some_pose()).path
    record = json.loads(broken.read_text())
    damage(record)
    broken.write_text(json.dumps(record))
    found, [problem] = read_poses(tmp_path)
    assert [each.name for each in found] == ["Whole"]
    assert problem.startswith(f"{broken} is not a pose. ")


def posed(layout, seed):
    """Random world rotations (S, 3, 3), vertebrae a little apart."""
    own = np.random.default_rng(seed).uniform(-0.4, 0.4, (layout.segment_count, 3))
    rotations = to_matrix(from_rotation_vector(own))
    for segment, parent in enumerate(layout.parent_segments()):
        if parent >= 0:
            rotations[segment] = rotations[parent] @ rotations[segment]
    return rotations


def turned_by(layout, rotations, turns):
    """World rotations with segments turned in their own axes, vertebrae sharing the abdomen's turn."""
    from studio.core.solver.correction_layer import PosedFrames, segment_turns, with_segments_turned

    batch = {part: np.array([turn]) for part, turn in turns.items()}
    frame = PosedFrames(np.zeros((1, layout.point_count, 3)), rotations[None])
    return with_segments_turned(layout, frame, segment_turns(layout, batch)).rotations[0]


@pytest.mark.parametrize("other_spine", [2, 3, 4, 6])
@pytest.mark.parametrize("spine", [2, 3, 5])
def test_a_pose_fits_bodies_of_any_number_of_vertebrae_and_replaces_the_offsets_before(spine, other_spine):
    layout, plain = BodyLayout(spine), posed(BodyLayout(spine), 1)
    before = {BodyPart.ABDOMEN: (0.1, 0.4, 0.0), BodyPart.LEFT_FOREARM: (0.3, 0.0, 0.1), BodyPart.THORAX: (0, 0.2, 0.1)}
    other = BodyLayout(other_spine)
    pose = local_pose(other, posed(other, 2), 1.0)
    turns = offsets_towards(layout, turned_by(layout, plain, before), pose, tuple(BodyPart), 1.0, before)
    reached = turned_by(layout, plain, turns)
    ends = [layout.spine_count - 1, *range(layout.spine_count, layout.segment_count)]
    others = [other_spine - 1, *range(other_spine, other.segment_count)]
    wanted = posed(other, 2)
    off = (reached[0].T @ reached[ends]).transpose(0, 2, 1) @ (wanted[0].T @ wanted[others])
    assert np.linalg.norm(to_rotation_vector(from_matrix(off)), axis=1).max() < 1e-6
