"""Feet in the air: above the floor, smoothly, and unchanged where they are clear of it anyway."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from studio.core.grounds import Bumps, Slope, Steps
from studio.core.kernels.algebra.smooth_steps import penetration_correction
from studio.core.kernels.support import swing_foot_clearance as kernel
from studio.core.rotations import to_matrix
from studio.core.solver.standing.swing_foot_path import Sole, clear_swing_foot, worn_height
from tests.core.motions import from_vectors

SOLE = np.array([[0.13, 0.01, -0.06, 0.08, 0.05, 0.09]])
RATE = 60.0
states = arrays(np.int64, st.integers(2, 60), elements=st.integers(0, 3))


def _points(ankles: np.ndarray, feet: np.ndarray, toes: np.ndarray) -> np.ndarray:
    """(F, 3) heights of heel, ball and tip of feet."""
    forward, left, down, height, heel, length = SOLE[0]
    joint = ankles + feet @ [forward, left, down]
    low = height + down
    ball = joint[:, 2] - low * np.maximum(feet[:, 2, 2], toes[:, 2, 2])
    return np.stack(
        [(ankles + feet @ [-heel, 0.0, -height])[:, 2], ball, (joint + toes @ [length, 0.0, -low])[:, 2]], 1
    )


class _Foot:
    """A foot that turns and dips at random, in the air or on the ground."""

    def __init__(self, seed: int, stands: np.ndarray, pitch: float = 0.6) -> None:
        random, frames = np.random.default_rng(seed), len(stands)
        times = np.arange(frames)[:, None] / 10
        ways = random.uniform(0.5, 2.0, 3), random.uniform(0, 6, 3)
        self.feet = to_matrix(from_vectors([0.2, pitch, 0.5] * np.sin(times * ways[0] + ways[1])))
        self.toes = self.feet @ to_matrix(from_vectors([0.0, 0.4, 0.0] * np.sin(times + ways[1])))
        self.ankles = np.column_stack([times, times, 0.1 + 0.1 * np.sin(times * ways[0][0])])
        self.states, self.before = stands, (self.ankles.copy(), self.toes.copy())
        kernel.raise_swing_foot(SOLE, stands, 0.0, RATE, self.ankles, self.feet, self.toes)


@given(st.integers(0, 2**32 - 1), states)
@settings(max_examples=40)
def test_nothing_of_a_foot_in_the_air_is_below_the_floor(seed: int, stands: np.ndarray) -> None:
    foot = _Foot(seed, stands)
    upright = foot.feet[:, 2, 2] > 0.0
    heights = _points(foot.ankles, foot.feet, foot.toes)
    assert (heights[(stands == 0) & upright] > -1e-9).all()


@given(st.integers(0, 2**32 - 1), states)
@settings(max_examples=40)
def test_what_stands_or_is_clear_stays_as_it_is(seed: int, stands: np.ndarray) -> None:
    foot = _Foot(seed, stands)
    ankles, toes = foot.before
    assert np.array_equal(foot.ankles[stands != 0], ankles[stands != 0])
    assert np.array_equal(foot.toes[stands & 2 != 0], toes[stands & 2 != 0])
    clear = _points(ankles, foot.feet, toes).min(axis=1) > kernel.SWING_CLEARANCE * SOLE[0, 3]
    assert np.array_equal(foot.ankles[clear], ankles[clear])
    around = 2 * round(kernel.TOE_BEND_LEAD * RATE)  # toes bend before they must
    long = np.lib.stride_tricks.sliding_window_view(np.pad(clear, around, constant_values=True), 2 * around + 1).all(1)
    assert np.array_equal(foot.toes[long], toes[long])
    assert (foot.ankles[:, 2] >= ankles[:, 2]).all()


@given(st.floats(-0.05, 0.05), st.floats(1e-4, 0.03))
def test_what_is_lacking_lifts_above_the_floor_and_grows_smoothly(height: float, room: float) -> None:
    step = 1e-6
    assert height + penetration_correction(height, room) >= 0.0
    assert 0.0 <= penetration_correction(height, room) - max(-height, 0.0) <= 3.0 / 16.0 * room + 1e-15
    assert abs(penetration_correction(height + step, room) - penetration_correction(height, room)) <= step * (
        1.0 + 1e-6
    )


def test_without_room_it_is_no_more_than_needed() -> None:
    assert [penetration_correction(height, 0.0) for height in (-0.02, 0.0, 0.01)] == [0.02, 0.0, 0.0]


def _bent_up(angle: float) -> np.ndarray:
    """A toe that points so many radians into the ground, after it was bent up."""
    c, s = math.cos(angle), math.sin(angle)
    toe = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    kernel.bend_toe_up(kernel.toe_bend(0.02, 0.09, 0.02, 0.0, 1.0, toe), toe)
    return toe


def _set_down(pitch: float, rate: float = 120.0, sink: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Radians that the toes of a foot point down which comes down in 0.4 s, ever more slowly, and what it is raised.

    They point so far down in the air; the whole foot comes to ``sink`` metres in the ground and up again.
    """
    times = np.arange(round(0.8 * rate)) / rate
    heights = 0.28 - sink + 0.2 * np.cos(np.pi * times / 0.4)
    feet = np.repeat(np.eye(3)[None], len(times), axis=0)
    toes = to_matrix(from_vectors(np.repeat([[0.0, pitch, 0.0]], len(times), axis=0)))
    ankles = np.column_stack([times, 0.0 * times, heights])
    kernel.raise_swing_foot(SOLE, np.zeros(len(times), np.int64), 0.0, rate, ankles, feet, toes)
    return np.arcsin(np.clip(-toes[:, 2, 0], -1.0, 1.0)), ankles[:, 2] - heights


def test_toes_that_point_down_come_up_before_they_are_in_the_floor() -> None:
    """They snapped up in a frame or two, and the foot was thrown up meanwhile."""
    pitches, raised = _set_down(math.radians(50.0))
    assert pitches.min() < math.radians(20.0)
    assert np.abs(np.diff(pitches, 2)).max() * 120.0**2 < 400.0
    assert raised.max() < 0.02


def test_toes_of_a_foot_that_is_raised_anyway_stay_level() -> None:
    """Bent up by 35 degrees to get out of a floor that the whole foot was in, they slapped down as it stood."""
    pitches, raised = _set_down(0.0, sink=0.03)
    assert raised.max() > 0.02
    assert np.abs(pitches).max() < math.radians(8.0)


@pytest.mark.parametrize("pitch", [10.0, 50.0])
def test_toes_bend_rather_than_the_ankle_rises_as_far_as_toes_do(pitch: float) -> None:
    angle = math.radians(pitch)
    toe = _bent_up(angle)
    assert np.allclose(toe.T @ toe, np.eye(3), atol=1e-12)
    bent = angle - math.asin(-toe[2, 0]) if toe[2, 2] > 0.0 else 0.0
    assert 0.0 < bent < kernel.MAX_TOE_BEND
    assert (0.02 + toe @ [0.09, 0.0, -0.02])[2] > -0.05


def test_toes_that_point_straight_down_do_not_flip_from_frame_to_frame() -> None:
    """The nearer they come to it, the less they bend: ever more slowly turned toes stay ever more alike."""
    angles = np.radians(np.arange(0.0, 120.0, 0.5))
    steps = np.abs(np.diff([_bent_up(angle) for angle in angles], axis=0)).max(axis=(1, 2))
    assert steps.max() < 0.1


class _Step:
    """A foot that flies 0.6 m along x in half a second, level, 4 cm high, from a tread to one beside it."""

    def __init__(self, rise: float, first: float = 0.05, frames: int = 50) -> None:
        share = np.clip((np.arange(frames) - 10) / 30, 0.0, 1.0)
        eased = share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
        self.states = np.where((share > 0.0) & (share < 1.0), 0, 3)
        self.ground = Steps(0.0, rise, 0.26, 2, 0.0, (SOLE[0, 0] + SOLE[0, 5] + first, 0.0))
        still = np.tile(np.eye(3), (frames, 1, 1))
        ankles = np.column_stack([0.6 * eased, 0.0 * share, SOLE[0, 3] + 0.64 * share * (1 - share) ** 2])
        self.level = Sole.of(ankles, still, still, SOLE)
        self.draped = Sole.of(ankles + np.outer(2.0 * rise * eased, [0.0, 0.0, 1.0]), still, still, SOLE)
        self.led = clear_swing_foot(self.level, self.draped, self.states, self.ground, RATE)

    def depth(self, foot: Sole) -> float:
        points = Sole.of(foot.ankles, foot.feet, foot.toes, SOLE).points[self.states == 0]
        return float((worn_height(self.ground, points) - points[..., 2]).max())


@pytest.mark.parametrize("rise", [0.17, 0.10, -0.10, -0.17])
def test_a_foot_is_led_clear_of_steps_and_stands_where_it_stood(rise: float) -> None:
    step = _Step(rise)
    assert step.depth(step.draped) > 0.012
    assert step.depth(step.led) < 0.3 * step.depth(step.draped)
    stands = step.states != 0
    assert np.array_equal(step.led.ankles[stands], step.draped.ankles[stands])
    assert np.allclose(step.led.feet[stands], step.draped.feet[stands], atol=1e-15)


@pytest.mark.parametrize("rise", [0.17, -0.17])
def test_it_hurries_hardly_more_than_it_did(rise: float) -> None:
    step = _Step(rise)
    led, draped = (np.linalg.norm(np.diff(foot.ankles, 2, axis=0), axis=1).max() for foot in (step.led, step.draped))
    assert led < 2.5 * draped


@pytest.mark.parametrize("ground", [Slope(0.0, 0.2, 0.3, (-9.0, 0.0)), Bumps(0.0, 0.0)])
def test_what_is_clear_is_the_same_foot(ground: Slope | Bumps) -> None:
    step = _Step(0.0)
    raised = Sole(step.level.ankles, step.level.feet, step.level.toes, step.level.points + np.array([0.0, 0.0, 3.0]))
    assert clear_swing_foot(step.level, raised, step.states, ground, RATE) is raised


def test_an_edge_is_worn_by_half_a_centimetre() -> None:
    steps = Steps(0.0, 0.17, 0.30, 1)
    places = np.array([[-0.01, 0.0], [0.004, 0.2], [0.006, 0.4]])
    assert worn_height(steps, places).tolist() == [0.0, 0.0, pytest.approx(0.17)]
