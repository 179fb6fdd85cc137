"""Values that cannot be are refused in a sentence as they are made, whichever record of the core is to hold them."""

import re
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.body.canonical import BodyLayout, BodyPart
from studio.core.body.kinematics import joint_world, rest_poses
from studio.core.body.morphology import AnimatedMorphology, Morphology, Proportions
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.captures.contacts import ContactInterval, ContactPoint
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import BodyPoint, Chain, finite_vector
from studio.core.constraints.clear import ClearConstraint
from studio.core.constraints.distance import DistanceConstraint
from studio.core.constraints.follow import FollowBody
from studio.core.constraints.look_at import LookAtConstraint
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.parallel import ParallelConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.procedural import CirclePlace
from studio.core.constraints.rail import RailConstraint
from studio.core.constraints.scope import Scope
from studio.core.constraints.upright import UprightConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.curves.keyed import KeyedNumber, KeyedPlace
from studio.core.curves.tangents import Tangent, TangentMode, Tangents
from studio.core.errors import StudioError
from studio.core.grounds import Bumps, HeightMap, Slope, Steps, SurfaceMesh
from studio.core.grounds.ground import Ground
from studio.core.markers.cleaning import FillShortGaps, LowPass
from studio.core.mesh.triangle_mesh import TriangleMesh
from studio.core.rotations import IDENTITY_QUATERNION, from_matrix
from studio.core.stage.behaviour import Behaviour, Role, State, Transition
from studio.core.stage.clip import Clip
from studio.core.stage.conditions import DistanceCondition, EventCondition, KeyCondition, TimeCondition
from studio.core.stage.correction import Correction, KeyedPoses, PoseOffsets
from studio.core.stage.project import Performer
from studio.core.stage.prop import Carried, Prop, PropShape
from studio.core.stage.reactions import KeepDistance, LeanAway
from studio.io.project.character_file import bundled_characters
from tests.builders import make_capture, make_constraint, make_morphology
from tests.core.motions import walk

NAN, INF = float("nan"), float("inf")
ALWAYS = ActivationCurve(-1.0, -1.0, 100.0, 100.0)
LEFT, HAND, BODY = BodyPoint(BodyPart.LEFT_FOREARM, at_end=True), BodyPoint(BodyPart.RIGHT_HAND), make_morphology()
CHILD, WALK = bundled_characters()["child"], walk(30)[0]
GUARD, NEAR, NOWHERE = State("Guard"), DistanceCondition(distance=1.0), (0.0, 0.0, 0.0)
FIGHTER = Behaviour("Fighter", (GUARD, State("Strike")), (Transition("Guard", "Strike", (NEAR,)),))
HEADING, FREE = ((BodyPart.HEAD, (0.5, 0.0, 0.0)),), partial(Tangent, TangentMode.FREE)
RATES = Tangents(FREE((1.0,)), FREE((1.0,)))
FAR = np.array([[0.0, 0.0, 0.0], [1e31, 0.0, 0.0], [0.0, 1.0, 0.0]])
TRIANGLE, ROTATIONS = np.array([[0, 1, 2]]), np.random.default_rng(0).normal(size=(4, 3, 4))


def ask(kind: Callable[..., Any], point: BodyPoint = LEFT, **more: Any) -> Callable[[], object]:
    return lambda: kind("walk", kind.__name__, point, Chain(), 0, ALWAYS, **more)


def tree(names: str, *parents: int, offset: float = 0.0) -> Skeleton:
    words = tuple(names.split())
    return Skeleton(words, np.array(parents), np.full((len(words), 3), offset), np.zeros(len(words), dtype=bool))


def mesh(*vertices: tuple[float, float, float], corners: tuple[int, int, int] = (0, 1, 2)) -> TriangleMesh:
    return TriangleMesh(np.array(vertices), np.array([corners] if vertices else []))


def pose(**turns: tuple[float, ...]) -> PoseOffsets:
    return PoseOffsets(tuple((BodyPart(part), turn) for part, turn in turns.items()))  # type: ignore[misc]


def skin(member: str, damage: Callable[[np.ndarray], np.ndarray]) -> Callable[[], object]:
    return lambda: replace(CHILD.skin, **{member: damage(getattr(CHILD.skin, member))})


def body(**measures: Any) -> Callable[[], Morphology]:
    return lambda: replace(BODY, **measures)


Refused = tuple[Callable[[], object], str]
"""Attempt to make something, and the words in its refusal."""

BODIES: dict[str, Refused] = {
    "channels of another spine": (lambda: replace(WALK, spine_places=np.linspace(0, 1, 5)), "not fit 5 spine segments"),
    "a grip beyond open": (lambda: replace(CHILD, grip=-1.1), "grip: a number from -1 to 1"),
    "a grip beyond a fist": (lambda: replace(CHILD, grip=1.5), "grip: a number from -1 to 1"),
    "a grip that is no number": (lambda: replace(CHILD, grip=NAN), "grip: a number from -1 to 1"),
    "a proportion too small": (lambda: Proportions(shanks=0.19), "shanks: a proportion lies between 0.2 and 5"),
    "a proportion too large": (lambda: Proportions(shanks=5.01), "shanks: a proportion lies between 0.2 and 5"),
    "a proportion that is no number": (lambda: Proportions(shanks=NAN), "shanks: a proportion lies between 0.2 and 5"),
    "a proportion without end": (lambda: Proportions(shanks=INF), "shanks: a proportion lies between 0.2 and 5"),
    "a spine of one measure": (body(spine=np.zeros((1, 3))), "spine: expected"),
    "an arm of another shape": (body(arm=np.ones(3)), "arm: expected shape"),
    "a hand of no numbers": (body(hand=np.full((2, 3), np.nan)), "hand: holds a number that is not finite"),
    "a leg without length": (body(leg=[[0.4, 0.0], [0.4, 0.4]]), "leg: a bone needs a length"),
    "a neck below zero": (body(neck=-0.1), "neck: a bone needs a length"),
    "a neck of kilometres": (body(neck=37_000.0), "is out of range: it must be at most"),
    "a growth without frames": (lambda: AnimatedMorphology(np.zeros((0, 66))), "a row of measures a frame"),
    "a growth of no numbers": (lambda: AnimatedMorphology(np.full((2, 66), np.nan)), "not finite"),
    "a growth without length": (lambda: AnimatedMorphology(np.zeros((2, 66))), "in frame 0 one has none"),
    "a growth into another spine": (
        lambda: AnimatedMorphology.from_bodies(
            make_morphology(spine_count=3), make_morphology(spine_count=4), np.arange(2.0)
        ),
        "as many spine segments",
    ),
    **{f"a spine of {n}": (partial(BodyLayout, n), "needs a pelvis and a thorax") for n in (-1, 0, 1)},
    "vertices in a plane": (skin("vertices", lambda array: array[:, :2]), "vertices"),
    "triangles of no vertex": (skin("triangles", lambda array: array + 1_000_000), "triangles"),
    "normals that are no numbers": (skin("normals", lambda array: array * np.nan), "normals"),
    "segments below zero": (skin("segments", lambda array: array - 50), "segments"),
    "weights that do not sum to one": (skin("weights", lambda array: array * 0.5), "weights"),
}

CAPTURES: dict[str, Refused] = {
    "a frame rate of years": (lambda: replace(make_capture(), frame_rate=1e-300), "A frame rate of 1e-300"),
    "a frame rate of no camera": (lambda: replace(make_capture(), frame_rate=1e9), "is out of range"),
    "a joint twice": (lambda: tree("a b b", -1, 0, 0), "Two joints of the skeleton are called 'b'"),
    "a child before its parent": (lambda: tree("a b c", -1, 2, 0), "Joint 'b' comes before its parent"),
    "a second root": (lambda: tree("a b c", -1, -1, 0), "Joint 'b' comes before its parent"),
    "no root": (lambda: tree("a b c", 1, 0, 0), "must be its root"),
    "no joint": (lambda: tree(""), "at least one joint"),
    "parents of more joints": (lambda: tree("a b", -1, 0, 0), "needs parents of shape"),
    "an offset that is no number": (lambda: tree("a b", -1, 0, offset=NAN), "offset of joint 'a' is not a finite"),
    "a joint that is not there": (lambda: tree("hips foot", -1, 0).index("Foot"), "'Foot'. Nearest names: foot"),
    "places of fewer joints": (lambda: PoseSequence(ROTATIONS, np.zeros((4, 2, 3))), "Poses need rotations"),
    "poses without frames": (lambda: PoseSequence(ROTATIONS[:0], np.zeros((0, 3, 3))), "at least one frame"),
    "a rotation of length zero": (
        lambda: PoseSequence(np.zeros((4, 3, 4)), np.zeros((4, 3, 3))),
        "quaternion of length zero",
    ),
    "a rotation that is no number": (
        lambda: PoseSequence(ROTATIONS * np.nan, np.zeros((4, 3, 3))),
        "rotation of joint 0 in frame 0 is not a finite number",
    ),
    "a place without end": (
        lambda: PoseSequence(ROTATIONS, np.full((4, 3, 3), np.inf)),
        "translation of joint 0 in frame 0 is not a finite",
    ),
    "poses of another skeleton": (
        lambda: joint_world(
            tree("a b", -1, 0), rest_poses(tree("a b c", -1, 0, 1), np.tile(IDENTITY_QUATERNION, (3, 1)))
        ),
        "Poses of 3 joints do not fit a skeleton of 2",
    ),
    "a filter below zero": (lambda: LowPass(cutoff=0.0), "must be more than zero"),
    "a gap that is no number": (lambda: FillShortGaps(longest=NAN), "must be more than zero"),
}

CONSTRAINTS: dict[str, Refused] = {
    "a chain locked throughout": (lambda: Chain(0.0, 0.0, 0.0, 0.0, 0.0), "No part of the IK chain may move"),
    "a chain of locked segments": (
        lambda: Chain(0.0, 0.0, 0.0, 0.0, 0.0, (("thorax", 0.0),)),
        "No part of the IK chain may move",
    ),
    "a segment freer than free": (lambda: Chain(segments=(("thorax", 1.5),)), "between 0 and 1: thorax is 1.5."),
    "a segment's weight that is no number": (lambda: Chain(segments=(("thorax", NAN),)), "thorax is nan"),
    "a weight of the end": (
        lambda: Chain(segments=(("left_foot", 0.5),)),
        "The left foot cannot have a weight override: set end_segment instead.",
    ),
    "a segment twice": (lambda: Chain(segments=(("thorax", 0.5), ("thorax", 0.6))), "two weight overrides"),
    **{
        f"{part} of {place}": (make, f"{said} must be three finite numbers")
        for place in ((0.0, 0.0), (0.0, NAN, 0.0), (INF, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0))
        for part, make, said in (
            ("a point", partial(BodyPoint, BodyPart.HEAD, place), "A point's offset"),  # type: ignore[arg-type]
            ("a target", partial(make_constraint, name="Wrist", target=place), "'Wrist': a target"),
        )
    },
    "a place at infinity": (lambda: finite_vector((0.0, INF, 0.0), "A place"), "A place must be three finite numbers"),
    "a place that is no number": (
        lambda: finite_vector((0.0, NAN, 0.0), "A place"),
        "A place must be three finite numbers",
    ),
    "a place beyond the sun": (lambda: finite_vector((0.0, 1e16, 0.0), "A place"), "A place of 1e+16"),
    "a place beyond all": (lambda: finite_vector((0.0, 1e160, 0.0), "A place"), "is out of range"),
    "a scope of two kinds": (lambda: Scope("somebody", "something"), "not both"),
    "a priority above the highest": (
        lambda: make_constraint(priority=-1),
        "'Right wrist': the priority must be 0 (highest) or more, not -1",
    ),
    **{
        f"a weight of {weight}": (
            partial(make_constraint, weight=weight),
            "the weight must be a finite number of 0 or more",
        )
        for weight in (-0.1, NAN, INF)
    },
    "a keyed weight below zero": (
        partial(make_constraint, weight=KeyedNumber((0.0, 1.0), (1.0, -1.0))),
        "'Right wrist': the weight",
    ),
    "no margin": (ask(ClearConstraint, margin=-0.01), "'ClearConstraint': the margin"),
    "a margin as wide as a body": (ask(ClearConstraint, margin=0.6), "'ClearConstraint': the margin"),
    "a margin that is no number": (ask(ClearConstraint, margin=NAN), "'ClearConstraint': the margin"),
    "a margin inside": (
        ask(AreaConstraint, margin=0.1, inside=True),
        "'AreaConstraint': a point with a margin can only stay outside",
    ),
    "a margin of a surface": (
        ask(AreaConstraint, margin=0.1, on_surface=True),
        "a point with a margin can only stay outside a volume",
    ),
    "a flat box": (ask(AreaConstraint, size=(0.0, 1.0, 1.0), shape="box"), "must be greater than zero"),
    "a half space of no size": (ask(AreaConstraint, size=NOWHERE, shape="half_space"), "must be greater than zero"),
    "an area of a mesh without one": (ask(AreaConstraint, shape=AreaShape.MESH), "needs a mesh"),
    "an area tilted by no rotation": (ask(AreaConstraint, tilt=(0.0, 0.0, 0.0, 0.0)), "rotation"),
    "a distance from itself": (ask(DistanceConstraint, other=LEFT, distance=0.1), "of a point from itself"),
    "a distance from itself, followed": (ask(DistanceConstraint, other=FollowBody(LEFT)), "of a point from itself"),
    "a distance below zero": (ask(DistanceConstraint, distance=-0.1), "0 or more"),
    "a distance keyed below zero": (
        ask(DistanceConstraint, distance=KeyedNumber((0.0, 1.0), (0.1, -0.1))),
        "0 or more",
    ),
    "a distance from nowhere": (ask(DistanceConstraint, other=(0.0, NAN, 0.0)), "finite"),
    "an orientation of zero": (ask(OrientationConstraint, target=(0.0, 0.0, 0.0, 0.0)), "not all zero"),
    "a segment that follows itself": (
        ask(OrientationConstraint, target=FollowBody(LEFT)),
        "a segment cannot follow itself",
    ),
    "a point that follows itself": (ask(PositionConstraint, target=FollowBody(LEFT)), "a point cannot follow itself"),
    "a look at infinity": (ask(LookAtConstraint, target=(INF, 0.0, 0.0)), "finite"),
    "a balance over no number": (ask(BalanceConstraint, place=(NAN, 0.0)), "finite"),
    "a balance with a height": (ask(BalanceConstraint, place=(0.0, NAN, 0.0)), "finite"),
    "an upright axis of nowhere": (ask(UprightConstraint, axis=NOWHERE), "has no length"),
    "upright towards nowhere": (ask(UprightConstraint, direction=NOWHERE), "has no length"),
    "an upright cone below zero": (ask(UprightConstraint, cone=-0.1), "maximum angle"),
    "an axis of nowhere": (ask(ParallelConstraint, HAND, axis=NOWHERE), "has no length"),
    "parallel to nowhere": (ask(ParallelConstraint, HAND, other_axis=NOWHERE), "has no length"),
    "a parallel cone below zero": (ask(ParallelConstraint, HAND, cone=-0.1), "maximum angle"),
    "parallel to itself": (ask(ParallelConstraint, HAND, other=HAND), "itself"),
    "a rail to nowhere": (ask(RailConstraint, direction=NOWHERE), "has no length"),
    "a rail without length": (ask(RailConstraint, length=0.0), "length"),
    "a rail of no number": (ask(RailConstraint, length=NAN), "length"),
    "a rail at infinity": (ask(RailConstraint, centre=(0.0, INF, 0.0)), "finite"),
    "a circle in no time": (lambda: CirclePlace(seconds=0.0), "greater than 0"),
    "a circle of no radius": (lambda: CirclePlace(radius=NAN), "finite"),
    "a circle at infinity": (lambda: CirclePlace(centre=(0.0, 0.0, INF)), "finite"),
}

CURVES: dict[str, Refused] = {
    "a mirror for a rotation": (lambda: from_matrix(np.diag([1.0, 1.0, -1.0])[None]), "determinant"),
    **{
        f"times out of order: {times}": (partial(ActivationCurve, *times), "in order, start, full, full end, end: ")
        for times in ((1.0, 0.5, 2.0, 3.0), (0.0, 1.0, 0.5, 3.0), (0.0, 1.0, 2.0, 1.9))
    },
    **{f"a time of {t}": (partial(ActivationCurve, 0.0, 1.0, 2.0, t), "four finite times") for t in (NAN, INF, -INF)},
    "an end beyond all time": (lambda: ActivationCurve(0.0, 1.0, 2.0, 1e300), "is out of range: it must be at most"),
    "tangents over the hold": (lambda: ActivationCurve(0.0, 0.1, 0.2, 0.3, weights=(1.0, 1.0, 0.0, 1.0)), "weight"),
    "fewer values than times": (lambda: KeyedPlace((0.0, 1.0), (NOWHERE,)), "as many"),
    "a key before the last": (lambda: KeyedPlace((1.0, 0.5), (NOWHERE, NOWHERE)), "0.500 s comes after 1.000 s"),
    "a key at no time": (lambda: KeyedPlace((0.0, NAN), (NOWHERE, NOWHERE)), "finite"),
    "a key beyond all time": (
        lambda: KeyedPlace((0.0, 1e12), (NOWHERE, NOWHERE)),
        "is out of range: it must be at most",
    ),
    "a key of no number": (lambda: KeyedPlace((0.0,), ((0.0, NAN, 0.0),)), "3 finite numbers"),
    "a key of two numbers": (lambda: KeyedPlace((0.0,), ((0.0, 0.0),)), "3 finite numbers"),
    "a step into a key": (lambda: Tangents(Tangent(TangentMode.STEPPED)), "tangent"),
    "a free tangent without a rate": (lambda: Tangent(TangentMode.FREE), "rate"),
    "a flat tangent with a rate": (lambda: Tangent(TangentMode.FLAT, (1.0,)), "rate"),
    "a tangent without weight": (lambda: Tangent(weight=0.0), "weight"),
    "two rates of one key": (lambda: Tangents(FREE((1.0,)), FREE((2.0,))), "rate"),
    "rates of two numbers": (
        lambda: KeyedNumber((0.0,), (0.0,), tangents=(Tangents(FREE((1.0, 2.0)), FREE((1.0, 2.0))),)),
        "rate",
    ),
    "tangents of fewer keys": (lambda: KeyedNumber((0.0, 1.0), (0.0, 1.0), tangents=(RATES,)), "tangent"),
}

STAGE: dict[str, Refused] = {
    **{
        f"a contact from {first} to {last}": (
            partial(ContactInterval, "walk", ContactPoint.LEFT_HEEL, first, last),
            "runs from a frame to a later one",
        )
        for first, last in ((5, 4), (-1, 3))
    },
    "a ground of no height": (lambda: Ground(NAN), "finite"),
    "a ground beyond the sky": (lambda: Ground(1e308), "is out of range: it must be at most"),
    "a slope that is a wall": (lambda: Slope(angle=1.3), "an angle of at most 60 degrees"),
    "a slope at infinity": (lambda: Slope(foot=(INF, 0.0)), "finite"),
    "stairs without treads": (lambda: Steps(tread=0.0), "tread"),
    "stairs without steps": (lambda: Steps(count=0), "number from 1 to 1000"),
    "stairs of no rise": (lambda: Steps(rise=NAN), "finite"),
    "bumps without a wave": (lambda: Bumps(wavelength=0.0), "wave"),
    "bumps of a seed below zero": (lambda: Bumps(seed=-1), "seed"),
    "heights in a line": (lambda: HeightMap(heights=np.zeros((1, 5))), "height"),
    "heights of no number": (lambda: HeightMap(heights=np.full((3, 3), np.nan)), "height"),
    "a height beyond the sky": (lambda: HeightMap(heights=np.array([[0.0, 1e308], [0.0, 0.0]])), "is out of range"),
    "heights without a cell": (lambda: HeightMap(cell=0.0), "cell"),
    "a surface at infinity": (lambda: SurfaceMesh(0.0, [[0, 0, np.inf]], []), "finite"),
    "a surface of no vertex": (lambda: SurfaceMesh(0.0, [[0, 0, 0]], [[0, 0, 1]]), "vertex"),
    "a surface beyond the sky": (lambda: SurfaceMesh(vertices=FAR, triangles=TRIANGLE), "is out of range"),
    "a mesh beyond the sky": (lambda: TriangleMesh(FAR, TRIANGLE), "is out of range: it must be at most"),
    "a mesh of no number": (lambda: mesh((0, 0, 0), (1, 0, 0), (0, NAN, 0)), "not finite"),
    "a mesh of no vertex": (lambda: mesh((0, 0, 0), (1, 0, 0), (0, 1, 0), corners=(0, 1, 3)), "not a vertex"),
    "a mesh without an area": (lambda: mesh((0, 0, 0), (1, 0, 0), (2, 0, 0)), "with an area"),
    "a mesh of nothing": (lambda: mesh(), "with an area"),
    "a prop of a mesh without one": (lambda: Prop("Thing", shape=PropShape.MESH), "Load it from a file first"),
    "put down before picked up": (lambda: Carried("performer 0", begin=2.0, end=1.0), "after it is picked up"),
    "a clip before all time": (lambda: Clip("motion", 0, 10, start=-1e12), "is out of range: it must be at most"),
    "a clip almost at rest": (
        lambda: Clip("motion", 0, 10, speed=KeyedNumber((0, 1), (1, 0.05))),
        "speed lies between",
    ),
    "a clip too fast": (lambda: Clip("motion", 0, 10, speed=KeyedNumber((0, 1), (1, 11.0))), "speed lies between"),
    "a clip of more than a fist": (lambda: Clip("motion", 0, 5, grip=1.5), "must be between -1"),
    "a performer beyond the sun": (lambda: Performer("Anna", "woman", position=(1e200, 0.0)), "is out of range"),
    "a pose at no time": (lambda: KeyedPoses((NAN,), (PoseOffsets(),)), "finite"),
    "a turn without end": (lambda: pose(head=(0.0, INF, 0.0)), "finite"),
    "a segment turned twice": (lambda: PoseOffsets((*HEADING, *HEADING)), "rotate each segment only once"),
    "no pose": (lambda: KeyedPoses((), ()), "at least one: 0 and 0"),
    "two poses at once": (lambda: KeyedPoses((1.0, 1.0), (PoseOffsets(), PoseOffsets())), "1.000 s"),
    "a correction heavier than one": (
        lambda: Correction("Head", "p", ALWAYS, KeyedPoses((1.0,), (PoseOffsets(HEADING),)), weight=1.5),
        "weight",
    ),
    "a behaviour without states": (lambda: replace(FIGHTER, states=()), "needs at least one state"),
    "a beginning that is no state": (
        lambda: replace(FIGHTER, start="Nap"),
        "the start state 'Nap' does not exist",
    ),
    "a state twice": (lambda: replace(FIGHTER, states=(*FIGHTER.states, GUARD)), "two states are called 'Guard'"),
    "a transition to no state": (
        lambda: replace(FIGHTER, transitions=(Transition("Guard", "Nap", (NEAR,)),)),
        "from 'Guard' to 'Nap' refers to a missing state, 'Nap'",
    ),
    "two roles of one body": (
        lambda: replace(FIGHTER, cast=(Role("a"), Role("a", "b"))),
        "can use a behaviour only once",
    ),
    "a partner of itself": (lambda: Role("a", "a"), "A character cannot be its own partner"),
    "a transition for nothing": (lambda: Transition("Guard", "Strike", ()), "needs a condition"),
    "a blend below zero": (
        lambda: Transition("Guard", "Strike", (NEAR,), -1.0),
        "the blend time must be 0 to 5 seconds, not -1.0",
    ),
    "a state without a name": (lambda: State("  "), "needs a name"),
    "a state nowhere": (lambda: State("Nap", place=(NAN, 0.0)), "two finite numbers"),
    "nearer than zero": (lambda: DistanceCondition(distance=-0.1), "0 or more, not -0.1"),
    "a wait without end": (lambda: TimeCondition(INF), "0 or more seconds"),
    "an event without a name": (lambda: EventCondition(" "), "An event needs a name"),
    "a key that is none": (lambda: KeyCondition(""), "A key is a letter"),
    "no distance to keep": (lambda: KeepDistance(distance=0.0), "greater than zero"),
    "less than no room": (lambda: KeepDistance(room=-1.0), "0 or more, not -1.0"),
    "a lean by nothing": (lambda: LeanAway(metres=0.0), "greater than 0 metres"),
}

TABLES = {**BODIES, **CAPTURES, **CONSTRAINTS, **CURVES, **STAGE}


@pytest.mark.parametrize("case", TABLES)
def test_what_cannot_be_is_refused_in_a_sentence(case: str) -> None:
    make, words = TABLES[case]
    with pytest.raises(StudioError if case in CAPTURES else ValueError, match=re.escape(words)) as refusal:
        make()
    assert str(refusal.value).endswith(".")


@given(
    part=st.sampled_from(("limb", "clavicle", "trunk", "root", "end_segment")),
    weight=st.floats(max_value=-1e-9) | st.floats(min_value=1.000001) | st.just(NAN),
)
def test_a_weight_of_a_chain_beyond_0_and_1_is_refused_by_name(part: str, weight: float) -> None:
    with pytest.raises(ValueError, match=f"must be between 0 and 1: {part} is"):
        Chain(**{part: weight})
