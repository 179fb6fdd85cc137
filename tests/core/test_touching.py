"""Hands that touch: what is found, and that it holds on every body."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology
from studio.core.captures.contacts import ContactInterval, ContactPoint, Touch
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.normalized.mirror import mirrored_contacts
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.normalize import detected_contacts, normalize_capture
from studio.core.normalized.realize import realize_motion
from studio.core.normalized.touching import find_touches, hands_together_or_holding
from studio.core.quality.metrics import angular_acceleration
from studio.core.solver.adapt import adapt, body_point_positions
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.task_assembly.chains import point_masses
from studio.core.solver.task_assembly.clearance import arm_distances
from studio.io.importing import load_capture
from studio.io.project.character_file import bundled_characters
from studio.io.project.entity_json import entity_of, entity_record
from tests.builders import make_morphology

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "captures"
BODIES = ("child", "giant", "stocky_man")
PUNCH = "straight_punch"


@cache
def guard() -> tuple[NormalizedMotion, Morphology, tuple[ContactInterval, ...]]:
    """The first second of a punch: a guard with the hands before the chin."""
    capture = load_capture(EXAMPLES / f"{PUNCH}.bvh")
    motion, actor = normalize_capture(capture)
    return motion, actor.morphology, detected_contacts(capture, "motion")


def adapted(body: str, *touches: Touch, **asked: object) -> AdaptedMotion:
    motion, actor, contacts = guard()
    character = bundled_characters()[body]
    feet = tuple(each for each in contacts if isinstance(each.point, ContactPoint))
    spans = tuple(ContactInterval("motion", touch, 20, 60) for touch in touches)
    request = AdaptRequest(motion, character.morphology, (*feet, *spans), volume=character.volume, actor=actor, **asked)
    return adapt(request)


def wrists(found: AdaptedMotion) -> np.ndarray:
    """(F, 3) from the left wrist to the right."""
    layout = found.morphology.layout
    return found.positions[:, layout.wrist_point(1)] - found.positions[:, layout.wrist_point(0)]


def source_gaps() -> np.ndarray:
    motion, actor, _ = guard()
    positions, _ = realize_motion(motion, actor, play=True)
    return positions[:, actor.layout.wrist_point(1)] - positions[:, actor.layout.wrist_point(0)]


def test_a_guard_before_the_chin_is_found_as_hands_together() -> None:
    _, _, contacts = guard()
    together = [each for each in contacts if each.point is Touch.HANDS_TOGETHER]
    assert [each.first for each in together[:1]] == [0]


@pytest.mark.parametrize(("swing", "aside", "together"), [(0.2, 0.145, False), (0.0, 0.145, True), (0.2, 0.02, True)])
def test_hands_that_swing_past_each_other_are_not_together(swing: float, aside: float, together: bool) -> None:
    """A runner's wrists, each on its own side; hands held as near each other, or crossing on one side, are together."""
    actor, frames = make_morphology(), np.arange(90)
    layout, swinging = actor.layout, swing * np.sin(2.0 * np.pi * 1.4 * frames / 30.0)
    positions = np.zeros((90, layout.point_count, 3))
    for side, sign in enumerate((1.0, -1.0)):
        ahead, left = 0.3 + sign * swinging, np.full(90, aside * actor.leg_length * sign)
        positions[:, layout.wrist_point(side)] = np.stack([ahead, left, np.zeros(90)], axis=1)
    rotations = np.tile(np.eye(3), (90, layout.segment_count, 1, 1))
    assert hands_together_or_holding(actor, positions, rotations, 30.0)[0].any() == together


def test_hands_on_the_ground_are_not_together() -> None:
    motion, actor, _ = guard()
    assert not list(find_touches(motion, actor, np.zeros((2, motion.frame_count), dtype=bool)))


@pytest.mark.parametrize("body", BODIES)
def test_hands_that_are_together_lie_as_the_actors_do_by_the_length_of_arms(body: str) -> None:
    found = adapted(body, Touch.HANDS_TOGETHER)
    scale = found.morphology.arm.sum() / guard()[1].arm.sum()
    np.testing.assert_allclose(wrists(found)[20:61], scale * source_gaps()[20:61], atol=1e-4)


@pytest.mark.parametrize("body", BODIES)
def test_a_thing_between_the_hands_keeps_its_size(body: str) -> None:
    found = adapted(body, Touch.HANDS_ON_THING)
    np.testing.assert_allclose(wrists(found)[20:61], source_gaps()[20:61], atol=1e-4)


@pytest.mark.parametrize("body", BODIES)
def test_a_hand_on_the_body_lies_on_its_surface(body: str) -> None:
    palm = arm_distances(adapted(body, Touch.LEFT_HAND_ON_TRUNK))[20:61, 0, 3]
    assert np.median(np.abs(palm)) < 0.02


def test_who_touches_nothing_is_left_alone() -> None:
    motion, _, contacts = guard()
    body = bundled_characters()["giant"].morphology
    feet = tuple(each for each in contacts if isinstance(each.point, ContactPoint))
    plain = adapt(AdaptRequest(motion, body, feet))
    touched = adapted("giant", Touch.HANDS_TOGETHER)
    away = np.r_[90 : motion.frame_count]
    np.testing.assert_array_equal(touched.positions[away], plain.positions[away])


def test_the_other_hand_follows_one_of_which_something_is_asked() -> None:
    found = adapted("giant", Touch.HANDS_TOGETHER)
    wrist = BodyPoint(BodyPart.LEFT_FOREARM, at_end=True)
    place = found.positions[40, found.morphology.layout.wrist_point(0)] + [0.05, 0.0, 0.1]
    always = ActivationCurve(-1.0, -1.0, 100.0, 100.0)
    target = tuple(place.tolist())
    asked = PositionConstraint("motion", "Reach", wrist, Chain(clavicle=0.0), 0, always, target=target)
    reached = adapted("giant", Touch.HANDS_TOGETHER, constraints=(asked,))
    assert np.linalg.norm(reached.positions[40, reached.morphology.layout.wrist_point(0)] - place) < 2e-4
    np.testing.assert_allclose(wrists(reached)[40], wrists(found)[40], atol=1e-4)


def led_hand(body: str, touch: Touch, side: int) -> tuple[AdaptedMotion, AdaptedMotion]:
    """A guard whose hands touch: balanced alone, and with one wrist at a place below the balance, in short ramps."""
    free = adapted(body, touch)
    wrist = BodyPoint((BodyPart.LEFT_FOREARM, BodyPart.RIGHT_FOREARM)[side], at_end=True)
    place = free.positions[40, free.morphology.layout.wrist_point(side)] + [0.1, 0.0, -0.2]
    moment = 40 / free.frame_rate
    curve = ActivationCurve(moment - 0.6, moment - 0.3, moment + 0.3, moment + 0.6)
    always, shifts = ActivationCurve(-1.0, -1.0, 100.0, 100.0), Chain(0.0, 0.0, 0.0, 0.0, 1.0)
    balance = BalanceConstraint("motion", "Balance", BodyPoint(BodyPart.PELVIS), shifts, 0, always)
    target = tuple(place.tolist())
    asked = PositionConstraint("motion", "Reach", wrist, Chain(trunk=1.0), 1, curve, target=target)
    return free, adapted(body, touch, constraints=(balance, asked), eased=True)


@pytest.mark.parametrize("side", [0, 1])
@pytest.mark.parametrize("touch", [Touch.HANDS_TOGETHER, Touch.HANDS_ON_THING])
@pytest.mark.parametrize("body", BODIES)
def test_a_balance_counts_the_hand_that_follows_the_other(body: str, touch: Touch, side: int) -> None:
    free, reached = led_hand(body, touch, side)
    masses = point_masses(free.morphology.layout)
    off = np.einsum("p,fpi->fi", masses, reached.positions - free.positions)[:, :2]
    assert np.linalg.norm(off, axis=1).max() < 1e-3


@pytest.mark.parametrize("side", [0, 1])
@pytest.mark.parametrize("body", BODIES)
def test_a_hand_that_follows_the_other_jolts_no_more_than_that_one(body: str, side: int) -> None:
    free, reached = led_hand(body, Touch.HANDS_TOGETHER, side)
    forearms = [
        free.morphology.layout.segment_of_part(part) for part in (BodyPart.LEFT_FOREARM, BodyPart.RIGHT_FOREARM)
    ]
    own, peaks = (
        angular_acceleration(each.rotations, each.frame_rate).max(axis=0)[forearms] for each in (free, reached)
    )
    assert peaks[1 - side] < 1.5 * max(peaks[side], own.max())


def test_a_hand_on_the_hips_stays_there_as_the_trunk_bends() -> None:
    free = adapted("giant", Touch.LEFT_HAND_ON_HIPS)
    head = free.positions[40, free.morphology.layout.segment_of_part(BodyPart.HEAD) + 1] + [0.3, 0.0, -0.2]
    always, bends = ActivationCurve(-1.0, -1.0, 100.0, 100.0), Chain(1.0, 1.0, 0.0, 1.0)
    target = tuple(head.tolist())
    asked = PositionConstraint("motion", "Bow", BodyPoint(BodyPart.HEAD), bends, 0, always, target=target)
    bent = adapted("giant", Touch.LEFT_HAND_ON_HIPS, constraints=(asked,))
    wrist = free.morphology.layout.wrist_point(0)
    there, here = (
        np.einsum("fij,fi->fj", each.rotations[:, 0], each.positions[:, wrist] - each.positions[:, 0])[20:61]
        for each in (free, bent)
    )
    np.testing.assert_allclose(here, there, atol=5e-4)


def test_any_window_of_frames_is_as_in_the_whole() -> None:
    motion, actor, _ = guard()
    touches = tuple(
        ContactInterval("motion", each, 20, 60) for each in (Touch.HANDS_TOGETHER, Touch.LEFT_HAND_ON_TRUNK)
    )
    request = AdaptRequest(motion, bundled_characters()["child"].morphology, touches, actor=actor, clears=True)
    whole, part = adapt(request), adapt(request, 30, 50)
    np.testing.assert_array_equal(part.positions, whole.positions[30:51])


@pytest.mark.parametrize(
    ("name", "body", "part", "moment"),
    [
        (PUNCH, "giant", BodyPart.LEFT_FOREARM, 3.0),
        ("handstand", "giant", BodyPart.HEAD, 1.0),
        ("handstand", "tall_man", BodyPart.RIGHT_HAND, 1.0),
        ("front_kick", "stocky_man", BodyPart.RIGHT_FOREARM, 3.4),
    ],
)
def test_arms_are_let_alone_in_every_frame_in_which_no_constraint_acts(
    name: str, body: str, part: BodyPart, moment: float
) -> None:
    """Arms that pass the body were pushed out of it once more before and after, by up to 81 mm."""
    capture = load_capture(EXAMPLES / f"{name}.bvh")
    motion, rig = normalize_capture(capture)
    character, contacts = bundled_characters()[body], detected_contacts(capture, "motion")
    free = AdaptRequest(
        motion, character.morphology, contacts, volume=character.volume, actor=rig.morphology, eased=True, clears=True
    )
    before, curve = adapt(free), ActivationCurve(moment - 0.4, moment - 0.1, moment + 0.1, moment + 0.5)
    point, row = BodyPoint(part, at_end=True), round(moment * motion.frame_rate)
    place = body_point_positions(point, before)[row] + [0.05, 0.05, 0.0]
    asked = PositionConstraint("motion", "Reach", point, Chain(trunk=0.4, root=0.2), 0, curve, target=tuple(place))
    after = adapt(replace(free, constraints=(asked,)))
    idle = curve.at(motion.times) == 0.0
    assert np.abs(after.positions[~idle] - before.positions[~idle]).max() > 0.04
    np.testing.assert_array_equal(after.positions[idle], before.positions[idle])
    part_of_it = adapt(replace(free, constraints=(asked,)), row - 8, row + 20)
    np.testing.assert_allclose(part_of_it.positions, after.positions[row - 8 : row + 21], atol=1e-12)


def test_a_mirrored_touch_is_of_the_other_hand() -> None:
    contacts = [ContactInterval("m", each, 0, 1) for each in (Touch.LEFT_HAND_ON_HIPS, Touch.HANDS_TOGETHER)]
    points = [each.point for each in mirrored_contacts(contacts)]
    assert points == [Touch.RIGHT_HAND_ON_HIPS, Touch.HANDS_TOGETHER]


def test_a_stored_touch_comes_back_and_older_versions_are_told_that_it_is_new() -> None:
    contact = ContactInterval("m", Touch.RIGHT_HAND_ON_HEAD, 2, 9)
    record = entity_record("contacts", "a", contact, {})
    assert entity_of("contacts", record, lambda _name: np.empty(0)) == contact
    assert record["schema"] == 3
    assert entity_record("contacts", "b", replace(contact, point=ContactPoint.SEAT), {})["schema"] == 2
