"""Constraints that cannot go together are refused in a sentence that names them; what merely competes is not."""

from dataclasses import replace

import pytest

from studio.core.body.canonical import BodyPart
from studio.core.constraints.area import AreaConstraint
from studio.core.constraints.balance import BalanceConstraint, Support
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.distance import DistanceConstraint
from studio.core.constraints.follow import FollowBody
from studio.core.constraints.objections import objection, objections
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve

LEFT, RIGHT, HEAD = BodyPoint(BodyPart.LEFT_HAND), BodyPoint(BodyPart.RIGHT_HAND), BodyPoint(BodyPart.HEAD)
NOW = ActivationCurve(0.0, 0.5, 1.0, 1.5)


def asked(name: str, kind: type = PositionConstraint, point: BodyPoint = LEFT, priority: int = 0, **more) -> Constraint:
    return kind("motion", name, point, Chain(), priority, more.pop("activation", NOW), **more)


REACH = asked("Reach", target=(0.1, 0.2, 1.0))


def test_two_targets_for_one_point_at_once_and_of_one_priority_are_a_contradiction() -> None:
    other = asked("Grasp", target=(0.3, 0.2, 1.0))
    assert objection(other, [REACH]) == (
        "'Grasp' contradicts 'Reach': both ask for the same point at the same time with the same priority."
        " Give one of them another priority or other times."
    )
    assert objections([REACH, other]) == [objection(other, [REACH])]


def test_the_same_twice_is_one_too_many() -> None:
    assert objection(replace(REACH, name="Again"), [REACH]) == (
        "'Again' asks the same as 'Reach' at the same time and with the same priority. Keep one of them."
    )


@pytest.mark.parametrize(
    "change",
    [
        {"priority": 1},
        {"point": RIGHT},
        {"enabled": False},
        {"motion_id": "another"},
        {"activation": ActivationCurve(1.0, 1.5, 2.0, 2.5)},  # comes while the other fades
    ],
)
def test_what_gives_way_or_comes_later_is_no_contradiction(change: dict) -> None:
    assert objection(replace(asked("Grasp", target=(0.3, 0.2, 1.0)), **change), [REACH]) is None


def test_kinds_are_compared_by_what_they_are_about() -> None:
    fixed, over = (asked(name, BalanceConstraint, point, place=place) for name, point, place in (
        ("Own", HEAD, None), ("Over", LEFT, Support())))  # fmt: skip
    assert "contradicts" in objection(over, [fixed])
    palm = asked("Palm", OrientationConstraint)
    assert "contradicts" in objection(asked("Fist", OrientationConstraint, target=(1.0, 0.0, 0.0, 0.0)), [palm])
    assert objection(palm, [REACH]) is None
    ropes = [asked("Rope", DistanceConstraint, other=place, distance=1.0) for place in ((0, 0, 0), (1, 0, 0))]
    assert objection(*ropes[:1], ropes[1:]) is None
    assert "contradicts" in objection(replace(ropes[0], distance=2.0), ropes[:1])
    table, wall = asked("Table", AreaConstraint), asked("Wall", AreaConstraint, centre=(1.0, 0.0, 0.0))
    assert objection(wall, [table]) is None
    assert "asks the same" in objection(replace(table, name="Desk"), [table])


@pytest.mark.parametrize(
    ("point", "followed", "refused"),
    [
        (BodyPoint(BodyPart.LEFT_FOREARM, at_end=True), LEFT, True),
        (LEFT, BodyPoint(BodyPart.LEFT_FOREARM, (0.0, 0.0, 0.1)), True),
        (BodyPoint(BodyPart.LEFT_UPPER_ARM, at_end=True), LEFT, True),
        (BodyPoint(BodyPart.LEFT_HAND, at_end=True), BodyPoint(BodyPart.LEFT_UPPER_ARM), False),  # by bending the elbow
        (BodyPoint(BodyPart.LEFT_UPPER_ARM), LEFT, False),  # the shoulder comes to where the hand bends up
        (BodyPoint(BodyPart.LEFT_FOREARM, at_end=True), RIGHT, False),
    ],
)
def test_a_limb_does_not_follow_what_it_carries(point: BodyPoint, followed: BodyPoint, refused: bool) -> None:
    sentence = objection(asked("Wrist", point=point, target=FollowBody(followed)), [])
    assert bool(sentence) == refused
    assert sentence is None or sentence.startswith("'Wrist' would follow a point of its own limb")


def test_points_that_follow_each_other_in_a_circle_are_refused() -> None:
    first = asked("First", target=FollowBody(RIGHT))
    second = asked("Second", point=RIGHT, target=FollowBody(HEAD))
    third = asked("Third", point=HEAD, target=FollowBody(BodyPoint(BodyPart.LEFT_HAND, (0.0, 0.1, 0.0))))
    assert objection(second, [first]) is None
    sentence = (
        "'Third' would follow itself in a circle, by 'Third', 'First', 'Second'. Let one of them stay where it is."
    )
    assert objection(third, [first, second]) == sentence
    later = replace(third, activation=ActivationCurve(2.0, 2.5, 3.0, 3.5))
    assert objection(later, [first, second]) is None


@pytest.mark.parametrize(
    ("part", "at_end", "chain", "stuck"),
    [
        ("left_shank", True, Chain(limb=0.0, clavicle=1.0, trunk=1.0), True),
        ("left_shank", True, Chain(limb=0.0, clavicle=0.0, root=0.1), False),
        ("thorax", True, Chain(limb=1.0, clavicle=1.0), True),
        ("left_forearm", True, Chain(limb=0.0, end_segment=1.0, clavicle=0.0), True),
        ("left_hand", True, Chain(limb=0.0, end_segment=1.0, clavicle=0.0), False),
        ("head", False, Chain(limb=0.0, clavicle=0.0, trunk=0.1), False),
        ("thorax", True, Chain(trunk=1.0, segments=(("abdomen", 0.0), ("thorax", 0.0))), True),
        ("thorax", True, Chain(trunk=1.0, segments=(("abdomen", 0.0),)), False),
        ("abdomen", True, Chain(segments=(("thorax", 0.5),)), True),
        ("left_shank", True, Chain(limb=0.0, trunk=1.0, segments=(("pelvis", 0.5),)), False),
        ("left_forearm", True, Chain(limb=0.0, clavicle=0.0, segments=(("right_clavicle", 1.0),)), True),
        ("left_forearm", True, Chain(limb=0.0, clavicle=0.0, segments=(("left_clavicle", 1.0),)), False),
        ("head", True, Chain(0.0, 0.0, 0.0, 0.0, 0.0, (("neck", 1.0),)), False),
    ],
)
def test_a_chain_that_does_not_carry_its_point_is_refused(part: str, at_end: bool, chain: Chain, stuck: bool) -> None:
    constraint = replace(REACH, point=BodyPoint(BodyPart(part), at_end=at_end), chain=chain)
    sentence = objection(constraint, [])
    assert (sentence is not None) == stuck
    assert not stuck or sentence.startswith("'Reach': nothing that its chain frees can move the ")


def test_the_other_end_of_a_distance_may_be_the_one_that_moves() -> None:
    chain = Chain(limb=1.0, clavicle=0.0)
    clap = DistanceConstraint("motion", "Touch", BodyPoint(BodyPart.THORAX), chain, 0, NOW, other=LEFT)
    assert objection(clap, []) is None
    assert "chest" in objection(replace(clap, other=(0.0, 0.0, 0.0)), [])
