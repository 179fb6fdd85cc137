"""Constraints before they are solved: chains, scopes, objections, and clips that play them."""

from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.body.canonical import BodyPart
from studio.core.captures.contacts import ContactPoint
from studio.core.constraints.area import AreaConstraint
from studio.core.constraints.balance import BalanceConstraint, Support
from studio.core.constraints.base import BodyPoint, Chain, Constraint, finite_vector
from studio.core.constraints.carried_over import ClipTransform, constraint_on_clip, mirrored_constraint
from studio.core.constraints.distance import DistanceConstraint
from studio.core.constraints.follow import FollowBody
from studio.core.constraints.objections import objection, objections
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.own_place import KeyedOwnPlace, OwnPlace
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.procedural import CirclePlace
from studio.core.constraints.scope import EVERYONE, Scope
from studio.core.curves.activation import ActivationCurve
from studio.core.curves.keyed import KeyedNumber
from studio.core.solver.performers.stage import constraints_of_performer
from studio.core.stage.clip import Clip
from studio.core.stage.project import Project
from tests.builders import make_constraint, make_contact, make_project

# Point, chain and priority, which every constraint has.


PARTS = [field.name for field in fields(Chain) if field.default != ()]


def test_an_arm_alone_reaches_with_limb_and_clavicle() -> None:
    assert Chain() == Chain(limb=1.0, end_segment=0.0, clavicle=1.0, trunk=0.0, root=0.0)


@pytest.mark.parametrize("part", PARTS)
@given(weight=st.floats(1e-6, 1.0))
def test_one_free_part_makes_a_chain(part: str, weight: float) -> None:
    locked = dict.fromkeys(PARTS, 0.0)
    assert getattr(Chain(**locked | {part: weight}), part) == weight


def test_vectors_are_taken_from_arrays_and_kept_as_plain_numbers() -> None:
    assert finite_vector(np.array([1, 2, 3]), "It") == (1.0, 2.0, 3.0)
    assert make_constraint(target=np.zeros(3)) == make_constraint(target=(0.0, 0.0, 0.0))


def test_a_part_may_be_called_by_its_name_and_no_other() -> None:
    assert BodyPoint("left_hand").part is BodyPart.LEFT_HAND  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="tail"):
        BodyPoint("tail")  # type: ignore[arg-type]


def test_constraints_are_values() -> None:
    constraint = make_constraint()
    assert constraint == make_constraint()
    assert len({constraint, make_constraint(), replace(constraint, priority=3)}) == 2
    assert PositionConstraint.kind == "position"


# Scope of a constraint: all who play a motion, one performer, or one clip.


FIRST, SECOND = (Scope(performer_id=f"performer {k}") for k in range(2))


def asked(project: Project, performer_id: str) -> list[str]:
    return [each.constraint_id for each in constraints_of_performer(project, performer_id)]


def test_two_performers_of_one_motion_are_asked_different_things() -> None:
    project = make_project(constraints=1)
    project = project.with_entity("constraints", "mine", make_constraint(priority=1, scope=FIRST))
    project = project.with_entity("constraints", "theirs", make_constraint(priority=1, scope=SECOND))
    assert asked(project, "performer 0") == ["constraint 0", "mine"]
    assert asked(project, "performer 1") == ["constraint 0", "theirs"]


def test_what_is_asked_of_a_clip_is_asked_in_each_of_its_repeats_and_of_no_other() -> None:
    project = make_project(constraints=0)
    performer = project.performers["performer 0"]
    clips = (Clip("motion", 0, 29, id="a"), Clip("motion", 0, 29, start=0.5, id="b", repeats=3))
    project = project.with_entity("performers", "performer 0", replace(performer, clips=clips))
    project = project.with_entity("constraints", "c", make_constraint(scope=Scope(clip_id="b")))
    assert [(each.clip, each.repeat) for each in constraints_of_performer(project, "performer 0")] == [
        (1, 0),
        (1, 1),
        (1, 2),
    ]
    assert asked(project, "performer 1") == []


def test_the_narrowest_contacts_of_a_point_count() -> None:
    project = make_project(contacts=0)
    for key, scope, first in (("all", EVERYONE, 3), ("own", FIRST, 7)):
        project = project.with_entity("contacts", key, make_contact(first=first, scope=scope))
    toe = make_contact(point=ContactPoint.LEFT_TOE)
    project = project.with_entity("contacts", "toe", toe)
    clip = project.performers["performer 0"].clips[0]
    assert {each.first for each in project.contacts_for("performer 0", clip).values() if each.point.is_heel} == {7}
    assert {each.first for each in project.contacts_for("performer 1", clip).values() if each.point.is_heel} == {3}
    assert toe in project.contacts_for("performer 0", clip).values()


def test_who_is_removed_takes_what_was_asked_of_it_alone_along() -> None:
    project = make_project()
    project = project.with_entity("constraints", "mine", make_constraint(scope=FIRST))
    assert ("constraints", "mine") in project.referring_to("performers", "performer 0")


def test_constraints_of_different_performers_do_not_contradict_each_other() -> None:
    one, other = (make_constraint(name=name, target=(x, 0.0, 1.0)) for name, x in (("a", 0.2), ("b", 0.6)))
    assert objection(one, [other]) is not None
    assert objection(replace(one, scope=FIRST), [replace(other, scope=SECOND)]) is None
    assert objection(replace(one, scope=FIRST), [other]) is not None


# Constraints that cannot go together are refused in a sentence that names them; what merely competes is not.


LEFT, RIGHT, HEAD = BodyPoint(BodyPart.LEFT_HAND), BodyPoint(BodyPart.RIGHT_HAND), BodyPoint(BodyPart.HEAD)
NOW = ActivationCurve(0.0, 0.5, 1.0, 1.5)


def constraint_of(
    name: str, kind: type = PositionConstraint, point: BodyPoint = LEFT, priority: int = 0, **more
) -> Constraint:
    return kind("motion", name, point, Chain(), priority, more.pop("activation", NOW), **more)


REACH = constraint_of("Reach", target=(0.1, 0.2, 1.0))


def test_two_targets_for_one_point_at_once_and_of_one_priority_are_a_contradiction() -> None:
    other = constraint_of("Grasp", target=(0.3, 0.2, 1.0))
    assert objection(other, [REACH]) == (
        "'Grasp' conflicts with 'Reach': both constrain the same point at the same time with the same priority."
        " Give one of them another priority, other times or a keyed weight."
    )
    assert objection(replace(other, weight=KeyedNumber((1.0, 2.0), (0.0, 1.0))), [REACH]) is None
    assert objections([REACH, other]) == [objection(other, [REACH])]


def test_the_same_twice_is_one_too_many() -> None:
    assert objection(replace(REACH, name="Again"), [REACH]) == (
        "'Again' duplicates 'Reach': same settings, time and priority. Delete one of them."
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
    assert objection(replace(constraint_of("Grasp", target=(0.3, 0.2, 1.0)), **change), [REACH]) is None


def test_kinds_are_compared_by_what_they_are_about() -> None:
    fixed, over = (constraint_of(name, BalanceConstraint, point, place=place) for name, point, place in (
        ("Own", HEAD, None), ("Over", LEFT, Support())))  # fmt: skip
    assert "conflicts" in objection(over, [fixed])
    palm = constraint_of("Palm", OrientationConstraint)
    assert "conflicts" in objection(constraint_of("Fist", OrientationConstraint, target=(1.0, 0.0, 0.0, 0.0)), [palm])
    assert objection(palm, [REACH]) is None
    ropes = [constraint_of("Rope", DistanceConstraint, other=place, distance=1.0) for place in ((0, 0, 0), (1, 0, 0))]
    assert objection(*ropes[:1], ropes[1:]) is None
    assert "conflicts" in objection(replace(ropes[0], distance=2.0), ropes[:1])
    table, wall = constraint_of("Table", AreaConstraint), constraint_of("Wall", AreaConstraint, centre=(1.0, 0.0, 0.0))
    assert objection(wall, [table]) is None
    assert "duplicates" in objection(replace(table, name="Desk"), [table])


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
    sentence = objection(constraint_of("Wrist", point=point, target=FollowBody(followed)), [])
    assert bool(sentence) == refused
    assert sentence is None or sentence.startswith("'Wrist' cannot follow a point farther out on its own limb")


def test_points_that_follow_each_other_in_a_circle_are_refused() -> None:
    first = constraint_of("First", target=FollowBody(RIGHT))
    second = constraint_of("Second", point=RIGHT, target=FollowBody(HEAD))
    third = constraint_of("Third", point=HEAD, target=FollowBody(BodyPoint(BodyPart.LEFT_HAND, (0.0, 0.1, 0.0))))
    assert objection(second, [first]) is None
    sentence = "'Third' would follow itself: 'Third', 'First', 'Second' form a cycle. Give one of them a fixed target."
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
    assert not stuck or sentence.startswith("'Reach': no free segment of the IK chain moves the ")


def test_the_other_end_of_a_distance_may_be_the_one_that_moves() -> None:
    chain = Chain(limb=1.0, clavicle=0.0)
    clap = DistanceConstraint("motion", "Touch", BodyPoint(BodyPart.THORAX), chain, 0, NOW, other=LEFT)
    assert objection(clap, []) is None
    assert "chest" in objection(replace(clap, other=(0.0, 0.0, 0.0)), [])


# Constraints of a motion, where a clip of it plays.


seconds = st.floats(-5.0, 5.0)


@given(st.lists(seconds, min_size=4, max_size=4).map(sorted), seconds, seconds, st.floats(0.1, 4.0))
def test_what_is_asked_comes_and_goes_while_its_clip_plays_however_short_that_is(
    times: list[float], first: float, last: float, speed: float
) -> None:
    """A clip that others cover from its first frame on ends before it begins: nothing is asked then."""
    asked = PositionConstraint("m", "hold", BodyPoint(BodyPart.LEFT_HAND), Chain(), 0, ActivationCurve(*times))
    curve = constraint_on_clip(asked, ClipTransform(0.0, speed, 0.0, (0.0, 0.0), False, first, last)).activation
    assert (curve.at([min(first, last) - 1e-6, max(first, last) + 1e-6]) == 0.0).all()
    assert first <= last or (curve.at([first, last]) == 0.0).all()


def test_keys_and_rules_per_character_are_mirrored_with_their_origin() -> None:
    point = BodyPoint(BodyPart.LEFT_FOREARM, at_end=True)
    own = OwnPlace(point, 0.5, (0.1, 0.2, 0.3), (("child", (0.0, 0.1, 0.0)),))
    mirrored = OwnPlace(
        BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True), 0.5, (0.1, -0.2, 0.3), (("child", (0.0, -0.1, 0.0)),)
    )
    curve = ActivationCurve(0.0, 0.1, 1.0, 1.1)
    keyed = KeyedOwnPlace((0.2, 0.6), ((0.0, 0.0, 0.0), (0.1, 0.3, 0.2)), origin=own)
    asked = PositionConstraint("m", "reach", BodyPoint(BodyPart.LEFT_HAND), Chain(), 0, curve, target=keyed)
    seen = mirrored_constraint(asked)
    assert seen.target == KeyedOwnPlace((0.2, 0.6), ((0.0, 0.0, 0.0), (0.1, -0.3, 0.2)), origin=mirrored)  # type: ignore[attr-defined]
    assert mirrored_constraint(seen) == asked
    ruled = replace(asked, target=CirclePlace(centre=(0.0, 0.1, 0.2), origin=own))
    assert mirrored_constraint(ruled).target.origin == mirrored  # type: ignore[attr-defined]
    moved = constraint_on_clip(ruled, ClipTransform(0.0, 1.0, 0.0, (3.0, 4.0), False, 0.0, 2.0))
    assert moved.target.centre == (0.0, 0.1, 0.2)  # type: ignore[attr-defined]
