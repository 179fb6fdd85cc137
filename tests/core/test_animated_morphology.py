"""Bodies whose measures change at every frame: feet stay locked, bones have their frame's length, nothing jitters."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from studio.core.body.kinematics import joint_world
from studio.core.body.morphology import AnimatedMorphology, sole_rows
from studio.core.grounds import Slope
from studio.core.grounds.ground import Ground
from studio.core.normalized.realize import realize_motion
from studio.core.quality.metrics import angular_acceleration, contact_quality
from studio.core.rigs.character_skeleton import character_poses, character_skeleton
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptRequest
from studio.io.project.character_file import bundled_characters
from tests.builders import make_morphology
from tests.core.motions import target, walk

BODIES = {name: character.morphology for name, character in bundled_characters().items()}
WALK, CONTACTS = walk(180)
TIME = np.linspace(0.0, 1.0, WALK.frame_count)
GROWING = TIME**3 * (10.0 - 15.0 * TIME + 6.0 * TIME**2)
HEELS = tuple(each for each in CONTACTS if each.point.is_heel)
TOES = tuple(each for each in CONTACTS if not each.point.is_heel)


def _between(first: str, second: str, shares: np.ndarray = GROWING) -> AnimatedMorphology:
    return AnimatedMorphology.from_bodies(BODIES[first], BODIES[second], shares)


@pytest.mark.parametrize("ground", [Ground(), Slope(0.0, 0.15, 0.4)], ids=["floor", "slope"])
@pytest.mark.parametrize(("first", "second"), [("child", "giant"), ("tall_man", "stocky_man")])
def test_feet_stay_locked_while_the_body_grows(first: str, second: str, ground: Ground) -> None:
    body = _between(first, second)
    adapted = adapt(AdaptRequest(WALK, body, CONTACTS, (), ground))
    assert contact_quality(adapted, HEELS, ground).slide < 1e-3
    whole = contact_quality(adapted, CONTACTS, ground)
    assert max(whole.rise, whole.penetration) < 2e-3
    for contact in TOES:  # a flat foot that grows pushes its toe ahead of its heel's edge by as much, and by no more
        soles = sole_rows(body, contact.point.side)[contact.first : contact.last + 1]
        lengths = soles[:, 0] + soles[:, 4]
        assert contact_quality(adapted, (contact,), ground).slide < np.ptp(lengths) * 1.1 + 1e-3


@pytest.mark.parametrize(("first", "second"), [("child", "giant"), ("adult_woman", "tall_man")])
def test_joints_are_as_smooth_as_on_a_still_body(first: str, second: str) -> None:
    """Travel, and turns, of a body that grows over the clip: at most 3 times the peaks of the still ones."""
    growing = adapt(AdaptRequest(WALK, _between(first, second), CONTACTS))
    still = [adapt(AdaptRequest(WALK, BODIES[name], CONTACTS)) for name in (first, second)]

    def peaks(positions: np.ndarray) -> np.ndarray:
        return np.linalg.norm(np.diff(positions, 2, axis=0), axis=-1).max(axis=0) * WALK.frame_rate**2

    assert (peaks(growing.positions) < 3.0 * np.maximum(*(peaks(each.positions) for each in still)) + 0.5).all()
    turns, usual = (angular_acceleration(each.rotations, WALK.frame_rate).max(axis=0) for each in (growing, still[0]))
    other = angular_acceleration(still[1].rotations, WALK.frame_rate).max(axis=0)
    assert (turns < 3.0 * np.maximum(usual, other) + 5.0).all()


@pytest.mark.parametrize("shift", [(0.0, 0.0), (20.0, -7.0)])
def test_where_a_growing_body_goes_does_not_depend_on_how_far_the_origin_is(shift: tuple[float, float]) -> None:
    body, channels = _between("child", "giant"), WALK.channels.copy()
    channels[:, :2] += shift
    here, there = (realize_motion(replace(WALK, channels=each), body)[0] for each in (WALK.channels, channels))
    apart = there - here
    assert np.allclose(apart, apart[0], atol=1e-9)
    assert np.allclose(apart[0, 0, :2], np.array(shift) * BODIES["child"].leg_length, atol=1e-9)


def test_every_frame_has_its_own_lengths_and_constraints_are_met() -> None:
    body = _between("child", "giant")
    wrist = target("left_forearm", (1.2, 0.4, 1.0))
    adapted = adapt(AdaptRequest(WALK, body, CONTACTS, (wrist,)), 20, 160)
    rows = body.rows[20:161]
    legs = np.linalg.norm(np.diff(adapted.positions[:, body.layout.hip_point(0) :][:, :3], axis=1), axis=2)
    assert np.allclose(legs, rows[:, 26:28], atol=1e-9)
    assert adapted.animated is body
    assert adapted.morphology == body.first_frame_body == BODIES["child"]
    whole = adapt(AdaptRequest(WALK, body, CONTACTS, (wrist,)))
    assert np.array_equal(adapted.positions, whole.positions[20:161])


def test_a_body_that_stays_as_it_is_is_the_still_one() -> None:
    body = BODIES["tall_man"]
    still = adapt(AdaptRequest(WALK, body, CONTACTS))
    animated = adapt(AdaptRequest(WALK, AnimatedMorphology(np.tile(body.packed, (WALK.frame_count, 1))), CONTACTS))
    assert np.allclose(animated.positions, still.positions, atol=1e-12)
    assert still.animated is None


def test_other_programs_get_every_joint_where_it_is() -> None:
    adapted = adapt(AdaptRequest(WALK, _between("child", "tall_man"), CONTACTS))
    poses = character_poses(adapted)
    places, _ = joint_world(character_skeleton(adapted.morphology), poses)
    ankle = adapted.morphology.layout.ankle_point(0)
    distances = np.linalg.norm(places - adapted.positions[:, ankle, None], axis=2).min(axis=1)
    assert distances.max() < 1e-9


@given(st.floats(0.0, 1.0), st.integers(2, 5))
@settings(max_examples=20)
def test_between_two_bodies_lie_their_measures(share: float, spine_count: int) -> None:
    small, large = (make_morphology(scale, spine_count=spine_count) for scale in (0.7, 1.3))
    body = AnimatedMorphology.from_bodies(small, large, np.array([0.0, share, 1.0]))
    assert body.layout == small.layout
    assert np.allclose(body.rows[1], small.packed + share * (large.packed - small.packed))
    assert body.first_frame_body == small


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        (np.zeros((0, 66)), "a row of measures a frame"),
        (np.full((2, 66), np.nan), "not finite"),
        (np.zeros((2, 66)), "in frame 0 one has none"),
    ],
)
def test_impossible_bodies_are_refused(rows: np.ndarray, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        AnimatedMorphology(rows)


def test_only_bodies_of_one_layout_grow_into_each_other() -> None:
    with pytest.raises(ValueError, match="as many spine segments"):
        AnimatedMorphology.from_bodies(make_morphology(spine_count=3), make_morphology(spine_count=4), TIME)
