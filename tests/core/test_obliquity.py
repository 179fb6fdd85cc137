"""A pelvis that dips where two standing feet ask hips of different heights."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from studio.core.normalized.realize import realize_motion
from studio.core.solver.standing.obliquity import MAX_OBLIQUITY, dip_pelvis
from tests.builders import make_morphology
from tests.core.motions import walk

BODY = make_morphology(leg_scale=1.1)
WALK, _ = walk(120)


def dipped(lower: float, states: np.ndarray) -> tuple[np.ndarray, ...]:
    """Hips' moves, and positions and rotations before and after, where right feet stand ``lower`` metres."""
    positions, rotations = realize_motion(WALK, BODY)
    before, turned = positions.copy(), rotations.copy()
    off = np.zeros((2, 120, 3))
    off[1, :, 2] = -lower
    return dip_pelvis(off, states, BODY, WALK.frame_rate, positions, rotations), before, turned, positions, rotations


@given(st.floats(-0.1, 0.1))
def test_a_pelvis_dips_to_the_foot_that_stands_lower_and_bends_nothing_else(lower: float) -> None:
    moved, before, turned, positions, rotations = dipped(lower, np.full((2, 120), 3))
    assert (np.sign(moved[0, :, 2] - moved[1, :, 2]) == np.sign(np.round(lower, 12))).all() or abs(lower) < 1e-9
    assert np.array_equal(rotations[:, 1:], turned[:, 1:])
    between = np.einsum("fji,fjk->fik", turned[:, 0], rotations[:, 0])
    assert (
        np.arccos(np.clip((np.trace(between, axis1=1, axis2=2) - 1.0) / 2.0, -1.0, 1.0)) < MAX_OBLIQUITY + 1e-6
    ).all()
    hips = [BODY.layout.hip_point(side) for side in range(2)]
    for side, hip in enumerate(hips):
        assert np.allclose(positions[:, hip : hip + 5] - before[:, hip : hip + 5], moved[side, :, None], atol=1e-12)
        in_pelvis = np.einsum("fji,fj->fi", rotations[:, 0], positions[:, hip] - positions[:, 0])
        assert np.allclose(in_pelvis, np.einsum("fji,fj->fi", turned[:, 0], before[:, hip] - before[:, 0]), atol=1e-12)
    lumbar = np.linalg.norm(positions[:, 1] - positions[:, 0], axis=1)
    assert np.allclose(lumbar, np.linalg.norm(before[:, 1] - before[:, 0], axis=1), atol=1e-12)


def test_a_pelvis_over_feet_that_do_not_both_stand_stays_as_it_is() -> None:
    one = np.full((2, 120), 3)
    one[0] = 0
    _, before, turned, positions, rotations = dipped(0.05, one)
    assert np.array_equal(positions, before)
    assert np.array_equal(rotations, turned)
