"""Limbs as links of variable length: laws of the analytic placement, and its twin."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.kernels.algebra.rotation_tuples import write_rotation
from studio.core.kernels.limbs import limb as kernel
from studio.core.kernels.records import LimbShape, Pose
from tests.core.motions import random_rotations
from tests.core.twins import limb as twin

seeds = st.integers(0, 2**32 - 1)


class _Limb:
    """Two bones in a random frame, stretched to a random distance that they can span."""

    def __init__(self, seed: int, distance: float | None = None, off_plane: float | None = None) -> None:
        random = np.random.default_rng(seed)
        self.root, self.frame = random.normal(size=3), random_rotations(random)
        self.bones = tuple(random.uniform(0.2, 0.5, size=2))
        near, far = abs(self.bones[0] - self.bones[1]), sum(self.bones)
        self.distance = random.uniform(near + 0.01 * far, 0.999 * far) if distance is None else distance
        self.off_plane = random.uniform(-0.2, 0.2) if off_plane is None else off_plane
        self.bend, self.twist = random.choice([-1.0, 1.0]), random.uniform(-3, 3, size=2)
        limb = LimbShape(self.bones, self.distance, self.off_plane, self.bend, tuple(self.twist))
        pose = Pose(np.stack([self.root] * 3), np.empty((2, 3, 3)))
        kernel.place_limb(0, 0, tuple(self.frame.ravel()), limb, pose)
        self.points, (self.upper, self.lower) = pose.positions[1:], pose.rotations


@given(seeds)
def test_the_kernel_agrees_with_its_twin(seed: int) -> None:
    limb = _Limb(seed)
    expected = twin.place_limb(limb.root, limb.frame, limb.distance, limb.bones, limb.off_plane, limb.bend, limb.twist)
    for result, wanted in zip((*limb.points, limb.upper, limb.lower), expected, strict=True):
        assert np.allclose(result, wanted, atol=1e-9)


@given(seeds)
def test_bones_keep_their_lengths_and_lie_along_the_z_axes_of_their_segments(seed: int) -> None:
    limb = _Limb(seed)
    middle, end = limb.points
    assert np.allclose(middle - limb.root, limb.bones[0] * limb.upper[:, 2], atol=1e-9)
    assert np.allclose(end - middle, limb.bones[1] * limb.lower[:, 2], atol=1e-9)


@given(seeds)
def test_the_extremity_lies_at_the_distance_along_z(seed: int) -> None:
    limb = _Limb(seed)
    assert np.allclose(limb.points[1], limb.root + limb.distance * limb.frame[:, 2], atol=1e-12)


@given(seeds)
def test_the_middle_joint_stands_on_the_side_of_the_bend(seed: int) -> None:
    limb = _Limb(seed, off_plane=0.0)
    x, y, _ = limb.frame.T @ (limb.points[0] - limb.root)
    assert limb.bend * y > 0.0
    assert x == pytest.approx(0.0, abs=1e-12)


@given(seeds)
def test_rotations_stay_rotations(seed: int) -> None:
    limb = _Limb(seed)
    for rotation in (limb.upper, limb.lower):
        assert np.allclose(rotation.T @ rotation, np.eye(3), atol=1e-12)
        assert np.linalg.det(rotation) == pytest.approx(1.0)


@pytest.mark.parametrize("distance", [0.0, 1e-9, 1e-3])
def test_a_folded_limb_has_no_nan(distance: float) -> None:
    limb = _Limb(0, distance)
    assert np.isfinite([*limb.points, *limb.upper, *limb.lower]).all()


def test_a_straight_limb_lies_on_the_line() -> None:
    limb = _Limb(3, distance=sum(_Limb(3).bones))
    assert np.allclose(limb.points[0], limb.root + limb.bones[0] * limb.frame[:, 2], atol=1e-7)


@given(st.floats(0, 10), st.floats(0.5, 0.999))
def test_soft_reach_is_exact_up_to_comfort_and_never_beyond_one(needed: float, comfort: float) -> None:
    reached = kernel.soft_extension(needed, comfort)
    assert reached == pytest.approx(twin.soft_reach(needed, comfort), abs=1e-12)
    assert reached <= min(needed, 1.0)
    if needed <= comfort:
        assert reached == needed


@given(st.floats(0.5, 0.999))
def test_soft_reach_rises_smoothly_at_the_comfort(comfort: float) -> None:
    step = 1e-6 * (1.0 - comfort)
    slope = (kernel.soft_extension(comfort + step, comfort) - comfort) / step
    assert slope == pytest.approx(1.0, abs=1e-5)
    samples = [kernel.soft_extension(needed, comfort) for needed in np.linspace(0.0, 1.5, 60)]
    assert (np.diff(samples) >= 0.0).all()


@given(seeds, st.floats(-12, 0))
def test_a_bone_that_nearly_points_back_is_still_a_rotation(seed: int, nearness: float) -> None:
    random = np.random.default_rng(seed)
    frame, bone, turn = random_rotations(random), 0.3 * np.array([0.0, 0.0, -1.0]), np.empty((3, 3))
    bone[:2] = 10.0**nearness * random.normal(size=2)
    write_rotation(kernel.bone_rotation(tuple(frame.ravel()), *bone, random.uniform(-3, 3)), turn)
    assert np.allclose(turn.T @ turn, np.eye(3), atol=1e-12)
    assert np.allclose(turn[:, 2] * np.linalg.norm(bone), frame @ bone, atol=1e-12)


@given(st.floats(0.0, 1.0), st.floats(0.01, 0.45))
def test_bones_of_other_lengths_fold_no_nearer_than_they_can_and_never_snap_shut(share: float, apart: float) -> None:
    bones = 0.5 + 0.5 * apart, 0.5 - 0.5 * apart
    reach, step = kernel.soft_flexion(share, bones), 1e-6
    assert reach > apart
    assert reach >= share
    assert -1e-9 <= kernel.soft_flexion(share + step, bones) - reach <= step * (1.0 + 1e-6)
    assert kernel.soft_flexion(share, (0.5, 0.5)) == share
    assert kernel.soft_flexion(-share, (0.5, 0.5)) == -share  # a channel that a spline has overshot


@given(st.floats(0.0, 1.0), st.floats(0.01, 0.45))
def test_an_ankle_that_is_brought_too_near_stops_softly_and_stays_where_a_fold_has_it(share: float, apart: float):
    bones, step = (0.5 + 0.5 * apart, 0.5 - 0.5 * apart), 1e-6
    reach = kernel.soft_minimum_reach(share, bones)
    assert reach > apart
    assert reach >= share - 1e-12
    assert -1e-9 <= kernel.soft_minimum_reach(share + step, bones) - reach <= step * (1.0 + 1e-6)
    folded = kernel.soft_flexion(share, bones)
    assert kernel.soft_minimum_reach(folded, bones) == pytest.approx(folded, abs=1e-12)
