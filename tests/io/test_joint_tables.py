"""CSV and NPZ: where joints are, and by how much constraints are missed, as numbers for other programs."""

import csv
from dataclasses import replace

import numpy as np
import pytest

from studio.core.body.kinematics import joint_world
from studio.core.body.pose import PoseSequence
from studio.core.normalized.normalize import normalize_capture
from studio.core.rotations import from_euler, from_matrix
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptRequest
from studio.io.export import take_of_adapted, take_of_capture, write_take
from tests.builders import make_capture, make_character, make_constraint


@pytest.fixture
def take():
    """An adapted motion with two targets of one name."""
    character = make_character()
    constraints = (make_constraint(), make_constraint(target=(0.5, 0.5, 1.0)))
    request = AdaptRequest(normalize_capture(make_capture())[0], character.morphology, (), constraints)
    return take_of_adapted("Woman", adapt(request), character, request)


def test_a_table_has_a_row_a_frame_with_every_joint_and_residual(take, tmp_path):
    write_take(take, tmp_path / "out.csv")
    with open(tmp_path / "out.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    positions, rotations = joint_world(take.skeleton, take.poses)
    hand = take.skeleton.index("RightHand")
    assert len(rows) == 30
    assert [float(rows[9][f"RightHand.{axis}"]) for axis in "xyz"] == pytest.approx(positions[9, hand], abs=1e-7)
    turned = [float(rows[9][f"RightHand.q{axis}"]) for axis in "xyzw"]
    assert abs(np.dot(turned, from_matrix(rotations[9, hand]))) == pytest.approx(1.0, abs=1e-7)
    assert float(rows[9]["time"]) == pytest.approx(9 / 60)
    residuals = [rows[frame]["Right wrist (m)"] for frame in range(30)]
    assert residuals[-1] == ""
    assert float(residuals[9]) == pytest.approx(take.adapted.residuals[0, 9], abs=1e-7)
    assert "Right wrist 2 (m)" in rows[0]


def test_arrays_are_read_by_numpy_without_pickle(take, tmp_path):
    write_take(take, tmp_path / "out.npz")
    with np.load(tmp_path / "out.npz", allow_pickle=False) as file:
        positions, rotations = joint_world(take.skeleton, take.poses)
        assert tuple(file["joints"]) == take.skeleton.names
        assert file["positions"] == pytest.approx(positions, abs=1e-12)
        assert np.abs(np.abs(np.sum(file["rotations"] * from_matrix(rotations), axis=2)) - 1.0).max() < 1e-12
        assert file["times"][-1] == pytest.approx(29 / 60)
        assert np.array_equal(file["residuals"], take.adapted.residuals, equal_nan=True)
        assert tuple(file["constraints"]) == ("Right wrist (m)", "Right wrist 2 (m)")


def test_a_capture_has_no_residuals(tmp_path):
    write_take(take_of_capture(make_capture()), tmp_path / "out.npz")
    with np.load(tmp_path / "out.npz", allow_pickle=False) as file:
        assert file["residuals"].shape == (0, 30)


def test_quaternions_keep_their_sign_through_the_whole_of_a_long_motion(tmp_path):
    capture = make_capture(frames=1300)
    rotations = capture.poses.local_rotations.copy()
    rotations[:, 0] = from_euler("Z", np.linspace(0.0, 20 * np.pi, 1300)[:, None])
    capture = replace(capture, poses=PoseSequence(rotations, capture.poses.local_translations))
    write_take(take_of_capture(capture), tmp_path / "turns.npz")
    with np.load(tmp_path / "turns.npz") as arrays:
        turned, there = arrays["rotations"], arrays["positions"]
    assert np.abs(np.diff(turned, axis=0)).max() < 0.1
    assert np.allclose(there, joint_world(capture.skeleton, capture.poses)[0])
