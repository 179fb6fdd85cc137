"""Joint centres against those that Vicon left in real files, and against a made body's own."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.markers.functional import centre_of_rotation
from studio.core.markers.joint_centres import chord, joint_centres
from studio.core.markers.take import MarkerTake, centre_errors
from studio.core.rotations import to_matrix
from studio.io.c3d.reader import read_c3d
from studio.io.markers.maps import find_map
from tests.core.markers.made import made_body, made_measures

LEGS = {f"{side}_{joint}" for side in ("left", "right") for joint in ("hip", "knee", "ankle")}
ARMS = {f"{side}_{joint}" for side in ("left", "right") for joint in ("shoulder", "elbow", "wrist")}


@pytest.mark.parametrize(("name", "joints"), [("btk_PiG_FullBody_walk", LEGS | ARMS), ("btk_PiG_LowerBody_walk", LEGS)])
def test_plug_in_gait_gives_the_joint_centres_that_vicon_stored(captures: Path, name: str, joints: set[str]) -> None:
    trial = read_c3d(captures / "c3d" / f"{name}.c3d").trial
    errors = centre_errors(MarkerTake(trial, find_map(trial)))
    assert set(errors) == joints
    assert max(errors.values()) < 1e-5


def test_without_stored_measures_they_are_read_off_the_stored_joints(captures: Path) -> None:
    """This file keeps its points as integers, steps of 0.1 mm, and its wands were put on up to 18 degrees off."""
    trial = read_c3d(captures / "c3d" / "sample09_PlugInC3D.c3d").trial
    errors = centre_errors(MarkerTake(trial, find_map(trial)))
    assert set(errors) == LEGS
    assert max(errors.values()) < 1e-3


places = st.tuples(*[st.floats(-1.0, 1.0)] * 3).map(np.array)


@given(places, places, places, st.floats(0.01, 0.2))
def test_a_chord_is_right_angled_at_the_joint_and_turns_away_from_the_wand(start, marker, wand, offset) -> None:
    bone = np.linalg.norm(marker - start)
    if bone < 1.2 * offset or np.linalg.norm(np.cross(marker - start, wand - start)) < 1e-3:
        return
    joint = chord(start[None], marker[None], wand[None], offset)[0]
    assert np.linalg.norm(joint - marker) == pytest.approx(offset)
    assert (joint - marker) @ (joint - start) == pytest.approx(0.0, abs=1e-9)
    normal = np.cross(marker - start, wand - start)
    assert normal @ (joint - start) == pytest.approx(0.0, abs=1e-9)
    assert np.cross(marker - start, joint - start) @ normal < 0.0


def test_two_sides_of_a_joint_give_its_middle() -> None:
    markers, joints = made_body()
    found = joint_centres({role: track[:, None] for role, track in markers.items()}, made_measures())
    for joint in ("left_hip", "right_hip", "left_knee", "right_ankle", "left_elbow", "right_wrist"):
        np.testing.assert_allclose(found[joint], joints[joint], atol=1e-9)


def test_a_wand_finds_the_knee_where_only_its_outer_side_is_marked() -> None:
    markers, joints = made_body()
    lone = {role: track[:, None] for role, track in markers.items() if "inner" not in role}
    found = joint_centres(lone, made_measures())
    assert np.linalg.norm(found["left_knee"] - joints["left_knee"], axis=1).max() < 0.01


def test_a_joint_is_found_by_how_two_clusters_turn_about_it() -> None:
    random = np.random.default_rng(3)
    centre = random.normal(size=(80, 3))
    upper, lower = (to_matrix(random.normal(size=(80, 4)) / 1.0) for _ in range(2))
    upper, lower = (np.linalg.qr(turns)[0] * [1, 1, 1] for turns in (upper, lower))
    upper, lower = (turns * np.sign(np.linalg.det(turns))[:, None, None] for turns in (upper, lower))
    shapes = random.normal(scale=0.1, size=(2, 4, 3)) + np.array([0.0, 0.1, 0.2])
    clusters = [
        centre[:, None] + shape @ np.swapaxes(turns, -1, -2)
        for shape, turns in zip(shapes, (upper, lower), strict=True)
    ]
    found = centre_of_rotation(*clusters, usual=centre + 0.05)
    assert np.linalg.norm(found - centre, axis=1).max() < 1e-3
