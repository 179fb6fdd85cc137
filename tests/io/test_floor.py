"""The floor is where feet stand lowest for a while; other heights are named, and the sole lies below any joint."""

from dataclasses import replace

import numpy as np
import pytest

from studio.core.body.kinematics import joint_positions
from studio.core.captures.capture import Capture, Guess
from studio.io.guessing import guess_floor
from studio.io.importing import load_capture
from studio.resources_folder import example_captures_folder


@pytest.fixture(scope="module")
def walk() -> Capture:
    return load_capture(example_captures_folder() / "walk_turn.bvh")


def floor_of(capture: Capture, rise: np.ndarray | float) -> Guess:
    """The floor of a capture that is lifted by ``rise`` metres, one for all or one a frame (F,)."""
    positions = joint_positions(capture.skeleton, capture.poses).copy()
    positions[..., 2] += np.reshape(rise, (-1, 1)) - capture.floor
    assert capture.body_map is not None
    return guess_floor(capture.skeleton, positions, capture.body_map, capture.frame_rate)


def height(guess: Guess) -> float:
    return float(guess.value.split()[0])


@pytest.mark.parametrize("lift", [-1.3, -0.885, -0.2, 0.4, 1.0])
def test_wherever_zero_lies_the_floor_is_as_far_below_the_feet(walk: Capture, lift: float) -> None:
    assert height(floor_of(walk, lift)) == pytest.approx(height(floor_of(walk, 0.7)) + lift - 0.7, abs=1e-3)


def stairs(capture: Capture, steps: int, rise: float) -> np.ndarray:
    """(F,) heights of a flight, a step down between one stand and the next, so that the last stand is at zero."""
    return rise * np.repeat(np.arange(steps)[::-1], -(-capture.frame_count // steps))[: capture.frame_count]


def test_down_a_flight_the_floor_is_its_foot_and_the_steps_are_named(walk: Capture) -> None:
    guess = floor_of(walk, stairs(walk, 4, 0.17))
    assert height(guess) == pytest.approx(height(floor_of(walk, 0.0)), abs=0.02)
    assert "The take also stands 0.1" in guess.reason


@pytest.mark.parametrize("scale", [0.6, 1.0])
def test_a_child_takes_lower_steps(walk: Capture, scale: float) -> None:
    child = replace(
        walk,
        floor=scale * walk.floor,
        skeleton=replace(walk.skeleton, offsets=scale * walk.skeleton.offsets),
        poses=replace(walk.poses, local_translations=scale * walk.poses.local_translations),
    )
    guess = floor_of(child, stairs(child, 4, 0.17 * scale))
    assert height(guess) == pytest.approx(height(floor_of(child, 0.0)), abs=0.02 * scale)
    assert "as on steps" in guess.reason


@pytest.mark.parametrize("last", [0.05, 0.08, 0.5])
def test_off_a_stage_the_floor_is_where_it_lands_however_late(walk: Capture, last: float) -> None:
    standing = np.arange(walk.frame_count) < (1.0 - last) * walk.frame_count
    guess = floor_of(walk, 0.9 * standing)
    assert height(guess) == pytest.approx(height(floor_of(walk, 0.0)), abs=0.02)
    assert "as on steps" in guess.reason


def test_a_level_take_stands_at_one_height(walk: Capture) -> None:
    assert "as on steps" not in floor_of(walk, 0.0).reason
