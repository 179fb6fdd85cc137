"""Weights of constraints of one priority, constant and keyed: space switching."""

from dataclasses import replace

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.curves.keyed import KeyedNumber, KeyedPlace
from studio.core.quality.report import report_of
from studio.core.rotations import angle_between, from_matrix, from_rotation_vector, to_matrix
from studio.core.solver.adapt import adapt, body_point_positions, grounded_motion
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.io.project.character_file import bundled_characters
from tests.core.motions import walk

WRIST, SHOULDER = BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True), BodyPoint(BodyPart.RIGHT_UPPER_ARM)
HAND, CHEST = BodyPoint(BodyPart.RIGHT_HAND), BodyPoint(BodyPart.THORAX)
LEFT_WRIST = BodyPoint(BodyPart.LEFT_FOREARM, at_end=True)
ALWAYS = ActivationCurve(-9.0, -9.0, 99.0, 99.0)
BEGIN, END = 1.0, 1.5
"""Seconds between which the weights cross."""
WALK, CONTACTS = walk()
SLICE = slice(round(0.9 * WALK.frame_rate), round(1.6 * WALK.frame_rate))
CHARACTERS = bundled_characters()
BODIES = tuple(CHARACTERS)
RISING, FALLING = KeyedNumber((BEGIN, END), (0.0, 1.0)), KeyedNumber((BEGIN, END), (1.0, 0.0))
CHAINS = {"arm": Chain(), "trunk": Chain(limb=0.5, trunk=0.6, clavicle=1.0)}


def adapted(name: str, *constraints: PositionConstraint | OrientationConstraint) -> AdaptedMotion:
    return adapt(AdaptRequest(WALK, CHARACTERS[name].morphology, CONTACTS, constraints))


def beside(name: str, offset: tuple[float, float, float], point: BodyPoint = SHOULDER) -> KeyedPlace:
    """Positions that move with a point of the body without constraints, ``offset`` from it."""
    places = body_point_positions(point, adapted(name)) + np.array(offset)
    return KeyedPlace(tuple(WALK.times.tolist()), tuple(map(tuple, places.tolist())))


def at(target: KeyedPlace, name: str = "", point: BodyPoint = WRIST, **values: object) -> PositionConstraint:
    constraint = PositionConstraint("walk", f"At {name}", point, Chain(), 0, ALWAYS, target=target)
    return replace(constraint, **values)  # type: ignore[arg-type]


def pair(name: str) -> tuple[KeyedPlace, KeyedPlace]:
    return beside(name, (0.3, 0.1, 0.1)), beside(name, (0.1, -0.2, -0.35))


def missed(motion: AdaptedMotion, wanted: np.ndarray, point: BodyPoint = WRIST) -> np.ndarray:
    return np.linalg.norm(body_point_positions(point, motion) - wanted, axis=1)


def crossing(one: KeyedPlace, other: KeyedPlace) -> np.ndarray:
    """(F, 3) the position that crossing weights ask for."""
    part = RISING.at(WALK.times)
    return (1.0 - part) * one.at(WALK.times) + part * other.at(WALK.times)


def test_constant_keys_give_the_poses_of_the_number_to_the_bit() -> None:
    one, other = pair("tall_man")
    for weight in (0.3, 1.0, 7.0):
        for second in (at(other, "b", LEFT_WRIST), at(other, "b", priority=1)):
            plain, curve = (adapted("tall_man", at(one, weight=each), second) for each in (weight, constant(weight)))
            assert np.array_equal(plain.positions, curve.positions)
            assert np.array_equal(plain.rotations, curve.rotations)
            assert np.array_equal(plain.residuals, curve.residuals, equal_nan=True)


def constant(weight: float) -> KeyedNumber:
    """Keys of one value."""
    return KeyedNumber((0.4, 1.1, 2.0), (weight,) * 3)


def test_two_targets_of_constant_weights_contradict_each_other_and_the_miss_is_told() -> None:
    """A hand between both would have been told as held."""
    one, other = pair("tall_man")
    motion = adapted("tall_man", at(one, "a"), at(other, "b", weight=3.0))
    apart = np.linalg.norm(one.at(WALK.times) - other.at(WALK.times), axis=1)
    assert (motion.residuals.sum(axis=0) > apart - 2e-3).all()


@pytest.mark.parametrize("chain", CHAINS)
@pytest.mark.parametrize("name", BODIES)
def test_crossing_weights_hand_a_wrist_over_on_the_way_between_both_targets(name: str, chain: str) -> None:
    one, other = pair(name)
    motion = adapted(
        name,
        at(one, "a", weight=FALLING, chain=CHAINS[chain]),
        at(other, "b", weight=RISING, chain=CHAINS[chain]),
    )
    wanted = crossing(one, other)
    alone = max(
        missed(adapted(name, at(each, chain=CHAINS[chain])), each.at(WALK.times)).max() for each in (one, other)
    )
    assert missed(motion, wanted)[SLICE].max() < alone + 5e-4
    steps, asked = (
        np.linalg.norm(np.diff(each, axis=0), axis=1) for each in (body_point_positions(WRIST, motion), wanted)
    )
    assert (steps < 1.5 * asked + 2e-3)[SLICE].all()


@pytest.mark.parametrize("chain", CHAINS)
def test_the_residual_is_the_distance_to_what_the_weights_ask_for(chain: str) -> None:
    """A hand that is half way, as asked, is no problem: it was listed as half a metre off both targets."""
    one, other = beside("tall_man", (0.9, 0.1, 0.4)), beside("tall_man", (0.1, -0.2, -0.35))  # the first out of reach
    asked = [
        at(target, name, weight=weight, chain=CHAINS[chain])
        for name, target, weight in (("a", one, FALLING), ("b", other, RISING))
    ]
    request = AdaptRequest(WALK, CHARACTERS["tall_man"].morphology, CONTACTS, tuple(asked))
    motion = adapt(request)
    away = missed(motion, crossing(one, other))
    assert motion.residuals[0] == pytest.approx(away, abs=2e-3)
    assert motion.residuals[1] == pytest.approx(away, abs=2e-3)
    assert motion.residuals[:, WALK.times > END].max() < 2e-4
    report = report_of(grounded_motion(request), request, motion)
    assert report.misses == pytest.approx(np.stack([away, away]), abs=1e-6)


@pytest.mark.parametrize("scale", [0.01, 3.0, 400.0])
def test_the_scale_of_both_weights_changes_nothing(scale: float) -> None:
    one, other = pair("child")
    scaled = [replace(each, values=tuple(scale * value for value in each.values)) for each in (FALLING, RISING)]
    plain = adapted("child", at(one, "a", weight=FALLING), at(other, "b", weight=RISING))
    motion = adapted("child", at(one, "a", weight=scaled[0]), at(other, "b", weight=scaled[1]))
    assert motion.positions == pytest.approx(plain.positions, abs=1e-6)


def test_a_weight_is_the_part_of_the_way_beyond_ten_to_one_too() -> None:
    one, other = pair("tall_man")
    for ratio in (1.0, 3.0, 30.0):
        motion = adapted("tall_man", at(one, "a"), at(other, "b", weight=constant(ratio)))
        wanted = (one.at(WALK.times) + ratio * other.at(WALK.times)) / (1.0 + ratio)
        assert missed(motion, wanted).max() < 2e-4


def test_three_targets_meet_at_their_mean_and_their_order_does_not_matter() -> None:
    one, other = pair("tall_man")
    third = beside("tall_man", (0.3, -0.2, 0.2))
    three = at(one, "a", weight=1.0), at(other, "b", weight=constant(2.0)), at(third, "c", weight=0.5)
    wanted = (one.at(WALK.times) + 2.0 * other.at(WALK.times) + 0.5 * third.at(WALK.times)) / 3.5
    assert missed(adapted("tall_man", *three), wanted).max() < 2e-4
    renamed = [replace(each, name=letter) for each, letter in zip(three, "cba", strict=True)]
    assert missed(adapted("tall_man", *renamed), wanted).max() < 2e-4


def test_a_hand_is_turned_from_one_orientation_to_the_other_by_crossing_weights() -> None:
    free = adapted("tall_man")
    hand = free.morphology.layout.segment_of_part(BodyPart.RIGHT_HAND)
    own = free.rotations[round((BEGIN + END) / 2.0 * WALK.frame_rate), hand]
    first, last = (from_matrix(own @ to_matrix(from_rotation_vector(np.array([0.0, by, 0.0])))) for by in (-0.3, 0.3))
    chain = Chain(limb=0.0, end_segment=1.0)
    ends = [
        OrientationConstraint("walk", name, HAND, chain, 0, ALWAYS, target=tuple(turn.tolist()), weight=weight)
        for name, turn, weight in (("a", first, FALLING), ("b", last, RISING))
    ]
    motion, part = adapted("tall_man", *ends), RISING.at(WALK.times)[SLICE, 0]
    turned = from_matrix(motion.rotations[SLICE, hand])
    assert angle_between(turned, np.broadcast_to(first, turned.shape)) == pytest.approx(0.6 * part, abs=2e-3)
    assert angle_between(turned, np.broadcast_to(last, turned.shape)) == pytest.approx(0.6 * (1.0 - part), abs=2e-3)


def test_a_point_of_the_trunk_is_handed_over_too() -> None:
    chest = beside("tall_man", (0.0, 0.0, 0.0), CHEST)
    one, other = (
        replace(chest, values=tuple((x + by, y, z - 0.05) for x, y, z in chest.values)) for by in (-0.06, 0.06)
    )
    chain = Chain(trunk=1.0, root=1.0)
    motion = adapted(
        "tall_man",
        at(one, "a", CHEST, weight=FALLING, chain=chain),
        at(other, "b", CHEST, weight=RISING, chain=chain),
    )
    assert missed(motion, crossing(one, other), CHEST)[SLICE].max() < 2e-3


def test_a_target_that_fades_in_beside_one_of_the_same_point_does_not_jump() -> None:
    one, other = pair("tall_man")
    for fading in ("a", "z"):  # before and after the other one in order
        ramp = ActivationCurve(BEGIN, END, 99.0, 99.0)
        motion = adapted("tall_man", at(one, "m"), at(other, fading, activation=ramp))
        steps = np.linalg.norm(np.diff(body_point_positions(WRIST, motion), axis=0), axis=1)
        asked = np.linalg.norm(np.diff(crossing(one, other), axis=0), axis=1).max()
        assert steps[SLICE].max() < 1.5 * asked
