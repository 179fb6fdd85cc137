"""Feet that stand: soles level, ankles and toes at one place; the kernels against twins and by laws."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from studio.core.kernels.support import foot_rotation as kernel
from studio.core.kernels.support.foot_anchoring import anchor_ankles
from studio.core.kernels.support.gap_interpolation import fade_into_gaps, interpolate_gaps
from studio.core.kernels.support.sole import ball_above_heel, toe_heading
from studio.core.rotations import to_matrix
from tests.core.motions import from_vectors, random_rotations
from tests.core.twins import feet as twin

seeds = st.integers(0, 2**32 - 1)
SOLE = twin.Sole(np.array([0.13, 0.0, -0.06]), 0.08, 0.05)
TOE_LENGTH = 0.06
MEASURES = np.array([[*SOLE.foot, SOLE.ankle_height, SOLE.heel_length, TOE_LENGTH]])
LEVEL = np.zeros(60)


class _Steps:
    """A foot that turns smoothly at random while it stands on heel, toe, both or neither."""

    def __init__(self, seed: int, frames: int = 60) -> None:
        random = np.random.default_rng(seed)
        times = np.arange(frames)[:, None] / 10
        vectors = [0.3, 0.4, 1.0] * np.sin(times * random.uniform(0.5, 2, 3) + random.uniform(0, 6, 3))
        self.rotations = to_matrix(from_vectors(vectors))
        self.toes = to_matrix(from_vectors(0.4 * np.sin(times + random.uniform(0, 6, 3))))
        self.ankles = np.cumsum(random.normal(size=(frames, 3)), axis=0) / 50 + [0, 0, 0.2]
        lengths = random.integers(1, 12, size=frames)
        self.states = np.repeat(random.integers(0, 4, size=frames), lengths)[:frames]
        self.ground = 0.1 * np.sin(times[:, 0])


def _levelled(steps: _Steps) -> np.ndarray:
    out = np.empty_like(steps.rotations)
    kernel.level_soles(steps.rotations, steps.states, twin.REACH, twin.FADE, out)
    return out


def _planted(steps: _Steps, feet: np.ndarray, pitches: np.ndarray = LEVEL) -> np.ndarray:
    out = np.empty_like(steps.ankles)
    anchor_ankles(steps.ankles, feet, steps.states, MEASURES, steps.ground, pitches, twin.REACH, twin.FADE, out)
    return out


@given(seeds)
@settings(max_examples=30)
def test_the_kernels_agree_with_their_twins(seed: int) -> None:
    steps = _Steps(seed)
    feet = _levelled(steps)
    assert np.allclose(feet, twin.level_soles(steps.rotations, steps.states), atol=1e-9)
    toes = np.empty_like(feet)
    kernel.level_toes(feet, steps.toes, steps.states, LEVEL, twin.REACH, twin.FADE, toes)
    assert np.allclose(toes, twin.level_toes(feet, steps.toes, steps.states), atol=1e-9)
    planted = twin.plant_ankles(steps.ankles, feet, steps.states, SOLE, steps.ground)
    assert np.allclose(_planted(steps, feet), planted, atol=1e-12)
    values, known = steps.ankles.copy(), steps.states == 2
    interpolate_gaps(values, known)
    assert np.allclose(values, twin.fill_gaps(steps.ankles, known), atol=1e-12)


@pytest.mark.parametrize("roll", [-20.0, 0.0, 20.0])
def test_a_standing_toe_turns_little_by_little_while_its_foot_is_pitched_past_straight_down(roll: float) -> None:
    pitches = np.arange(20.0, 110.0, 0.5)
    feet = Rotation.from_euler("ZYX", [[30.0, pitch, roll] for pitch in pitches], degrees=True).as_matrix()
    headings = np.degrees(np.unwrap([np.arctan2(*toe_heading(foot)[::-1]) for foot in feet]))
    assert np.abs(np.diff(headings)).max() < 1.0


@given(seeds)
@settings(max_examples=20)
def test_a_flat_foot_is_level_and_looks_one_way(seed: int) -> None:
    steps = _Steps(seed)
    feet = _levelled(steps)
    for stretch in twin.stretches(steps.states == twin.FLAT):
        assert np.allclose(feet[stretch, :, 2], [0.0, 0.0, 1.0], atol=1e-9)
        assert np.allclose(feet[stretch], feet[stretch[0]], atol=1e-9)


@given(seeds)
@settings(max_examples=20)
def test_what_stands_stays_where_it_is(seed: int) -> None:
    steps = _Steps(seed)
    feet = _levelled(steps)
    ankles = _planted(steps, feet)
    toes = ankles + feet @ SOLE.foot
    heels = ankles + [SOLE.pad_below_ankle(foot) for foot in feet]
    for bit, track in ((twin.HEEL, heels), (twin.TOE, toes)):
        for stretch in twin.stretches((steps.states & bit) != 0):
            still = track[stretch, :2]
            assert np.allclose(still, still[0], atol=1e-9)


@given(seeds)
@settings(max_examples=20)
def test_the_lowest_of_heel_and_ball_lies_on_the_ground(seed: int) -> None:
    steps = _Steps(seed)
    feet = _levelled(steps)
    ankles = _planted(steps, feet)
    for frame in np.flatnonzero(steps.states):
        heel, ball = SOLE.heel_below_ankle(feet[frame]), SOLE.ball_below_ankle(feet[frame])
        assert ankles[frame, 2] + min(heel[2], ball[2]) == pytest.approx(steps.ground[frame], abs=1e-12)


@given(seeds)
@settings(max_examples=20)
def test_toes_that_roll_over_their_tip_keep_it_where_it_is(seed: int) -> None:
    steps = _Steps(seed)
    steps.states = np.repeat([twin.FLAT, twin.TOE, 0], 20)
    steps.rotations[:] = np.eye(3)
    pitches = np.where(steps.states == twin.TOE, 0.9 * np.clip((np.arange(60) - 24) / 12, 0.0, 1.0), 0.0)
    toes = np.empty_like(steps.toes)
    kernel.level_toes(steps.rotations, steps.toes, steps.states, pitches, twin.REACH, twin.FADE, toes)
    balls = _planted(steps, steps.rotations, pitches) + steps.rotations @ SOLE.foot
    thick = SOLE.ankle_height + SOLE.foot[2]
    tips = balls + toes @ [TOE_LENGTH, 0.0, -thick]
    assert np.allclose(tips[:40, :2], tips[0, :2], atol=1e-9)
    assert np.allclose(tips[:40, 2], steps.ground[:40], atol=1e-9)
    assert balls[39, 2] - thick > steps.ground[39] + 0.5 * TOE_LENGTH


@given(seeds)
@settings(max_examples=20)
def test_a_foot_tilted_the_wrong_way_is_put_down_and_a_right_one_left_alone(seed: int) -> None:
    steps = _Steps(seed)
    feet = _levelled(steps)
    kept = feet.copy()
    kernel.limit_foot_pitch(MEASURES, steps.states, twin.REACH, twin.FADE, kept)
    for frame in np.flatnonzero(steps.states):
        before, after = (SOLE.ball_below_ankle(r)[2] - SOLE.heel_below_ankle(r)[2] for r in (feet[frame], kept[frame]))
        state = steps.states[frame]
        right = state == twin.FLAT or (before >= 0.0) == (state == twin.HEEL)
        if right:
            assert np.allclose(kept[frame], feet[frame], atol=1e-12)
        else:
            assert after == pytest.approx(0.0, abs=1e-3)


@given(seeds)
def test_how_the_ball_lies_above_the_heel_is_told_by_geometry(seed: int) -> None:
    rotation = random_rotations(np.random.default_rng(seed))
    rise = SOLE.ball_below_ankle(rotation)[2] - SOLE.heel_below_ankle(rotation)[2]
    found = ball_above_heel(rotation, MEASURES[0])
    assert found == pytest.approx(rise, abs=1e-12)


def test_a_foot_that_never_stands_is_left_as_it_is() -> None:
    steps = _Steps(0)
    steps.states[:] = 0
    assert np.allclose(_levelled(steps), steps.rotations, atol=1e-15)
    assert np.array_equal(_planted(steps, steps.rotations), steps.ankles)


def test_the_way_between_two_stands_has_no_corner() -> None:
    """Position, velocity and acceleration pass over both ends of a gap without a jump."""
    known = np.ones(90, dtype=bool)
    known[30:60] = False
    values = np.zeros((90, 3))
    values[60:] = 1.0
    interpolate_gaps(values, known)
    acceleration = np.diff(values[:, 0], 2)
    assert np.abs(np.diff(values[:, 0])).max() < 2.0 / 30
    assert np.abs(np.diff(acceleration)).max() < 3 * np.abs(acceleration).max() * 2 * np.pi / 30


def test_what_comes_to_rest_on_the_ground_and_starts_from_it_changes_its_speed_in_many_small_steps() -> None:
    """A foot that goes on and on, and its place on the ground: no frame takes all of its speed at once."""
    frames, reach = np.arange(90), 12.0
    known = (frames >= 30) & (frames < 60)
    track = 0.01 * np.column_stack([frames, frames, frames])
    values = np.where(known[:, None], track[45] - track, 0.0)
    fade_into_gaps(values, known, track, reach, reach)
    speeds = np.diff((track + values)[:, 0])
    assert np.allclose(speeds[30:59], 0.0, atol=1e-12)
    assert np.abs(np.diff(speeds)).max() < 0.4 * 0.01


@given(st.integers(4, 40), st.floats(0.0, 0.2), st.floats(1e-4, 0.02), seeds)
def test_a_fading_correction_adds_half_of_the_motions_own_acceleration_or_fades_in_its_least_time(
    gap: int, size: float, own: float, seed: int
) -> None:
    """It is interpolated at worst, and gone where there is time."""
    least, begin = 8.0, np.random.default_rng(seed).normal(size=3)
    known = np.ones(20 + gap, dtype=bool)
    known[10 : 10 + gap] = False
    values = np.where(np.arange(20 + gap)[:, None] < 10, size * begin / np.linalg.norm(begin), 0.0)
    track = np.zeros((20 + gap, 3))
    track[:, 0] = 0.5 * own * np.arange(20 + gap) ** 2
    faded, interpolated = values.copy(), values.copy()
    fade_into_gaps(faded, known, track, least, least)
    interpolate_gaps(interpolated, known)
    assert (np.linalg.norm(faded, axis=1) <= np.linalg.norm(interpolated, axis=1) + 1e-12).all()
    added = np.linalg.norm(np.diff(faded, 2, axis=0), axis=1).max(initial=0.0)
    slowest = np.linalg.norm(np.diff(interpolated, 2, axis=0), axis=1).max(initial=0.0)
    assert added <= max(0.5 * own, slowest, 6.0 * size / least**2) + 1e-12


@given(seeds)
def test_corrections_that_need_not_fade_are_interpolated(seed: int) -> None:
    random = np.random.default_rng(seed)
    known = np.repeat(random.random(12) < 0.5, 5)
    values = np.repeat(random.normal(size=(12, 3)), 5, axis=0)
    faded, interpolated = values.copy(), values.copy()
    fade_into_gaps(faded, known, values, 8.0, np.inf)
    interpolate_gaps(interpolated, known)
    assert np.allclose(faded, interpolated, atol=1e-12)
