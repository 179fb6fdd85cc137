"""Joints of limbs go no further than a person's, or than the motion itself; never beyond by a constraint."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from studio.core.body.canonical import BodyPart
from studio.core.body.joint_limits import HIP_RANGE, SHOULDER_RANGE, BallLimit, limb_limit_records
from studio.core.body.morphology import Morphology
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.follow import FollowTracked
from studio.core.constraints.position import PositionConstraint
from studio.core.quality.metrics import angular_acceleration
from studio.core.quality.report import BLOCKED_BY_LIMITS, blocking_constraints
from studio.core.solver.grounding.grounded_motion import grounded_motion_of
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.task_assembly.tracks import Track
from studio.io.project.character_file import bundled_characters
from tests.core.grounding import adapt_again
from tests.core.motions import ALWAYS, RATE, local_rotations, target, walk
from tests.core.reachable import Mannequin
from tests.core.scenes import Scene

BODIES = {name: character.morphology for name, character in bundled_characters().items()}
WOMAN = BODIES["adult_woman"]
WALK, CONTACTS = walk(60)
ARM = Chain(clavicle=0.0)
HANGING = np.array([[0.0, -1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]).T
STANDING = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]).T


def _swings(relative: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Swing (..., 2) and twist (...) of rotations (..., 3, 3), by quaternions."""
    x, y, z, w = np.moveaxis(Rotation.from_matrix(relative).as_quat(), -1, 0)
    twist = Rotation.from_quat(np.stack([0 * x, 0 * y, z, w], axis=-1))
    swing = (Rotation.from_matrix(relative) * twist.inv()).as_rotvec()
    return swing[..., :2], 2.0 * np.arctan2(z, w)


def _parts(row: np.void, joint: int, carrier: np.ndarray, segment: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Parts (F,) of their limits that swing and twist take."""
    swing, twist = _swings(np.swapaxes(carrier @ row["axes"][joint], -1, -2) @ segment)
    radii = np.where(swing >= 0.0, row["radii"][joint][[0, 2]], row["radii"][joint][[1, 3]])
    off = np.mod(twist - row["twists"][joint, 0] + np.pi, 2 * np.pi) - np.pi
    return np.linalg.norm(swing / radii, axis=-1), off / row["twists"][joint, 1]


def _bends(upper: np.ndarray, lower: np.ndarray) -> np.ndarray:
    z = np.einsum("fji,fj->fi", upper, lower[:, :, 2])
    return np.arctan2(-z[:, 1], z[:, 2])


def _beyond(adapted: AdaptedMotion, before: AdaptedMotion, limbs: set[int]) -> float:
    """Radians by which joints of ``limbs`` go further than their limits, or than the motion ``before``, in radians."""
    body, k, worst = adapted.morphology, adapted.morphology.layout.spine_count, -np.inf
    limits = limb_limit_records(body)
    for limb in limbs:
        upper = k + (3 if limb < 2 else 10) + 4 * (limb % 2)
        carrier = upper - 1 if limb < 2 else 0
        for joint, (parent, child) in enumerate(((carrier, upper), (upper + 1, upper + 2))):
            now, own = (_parts(limits[limb], joint, a.rotations[:, parent], a.rotations[:, child])
                        for a in (adapted, before))  # fmt: skip
            worst = max(worst, (now[0] - np.maximum(own[0], 1.0)).max())
            worst = max(worst, (now[1] - np.maximum(own[1], 1.0)).max(), (np.minimum(own[1], -1.0) - now[1]).max())
        now, own = (_bends(a.rotations[:, upper], a.rotations[:, upper + 1]) for a in (adapted, before))
        least, most = limits[limb]["bends"]
        worst = max(worst, (now - np.maximum(own, most)).max(), (np.minimum(own, least) - now).max())
    return float(worst)


def _asked(constraints: tuple[Constraint, ...]) -> set[int]:
    sides = {"left": 0, "right": 1}
    parts = [constraint.point.part.value.partition("_") for constraint in constraints]
    arms = {sides[side] for side, _, bone in parts if bone in ("upper_arm", "forearm", "hand")}
    return arms | {2 + sides[side] for side, _, bone in parts if bone in ("thigh", "shank", "foot", "toe")}


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_no_set_of_constraints_brings_a_limb_beyond_its_limits_or_the_motion(body: Morphology) -> None:
    before = adapt_again(AdaptRequest(WALK, body, CONTACTS))
    kinds = ("position", "orientation", "distance", "area", "position", "look_at", "balance")
    for seed in range(12):
        scene = Scene(before, seed, tuple(np.random.default_rng(seed).choice(kinds, size=1 + seed % 4)))
        request = AdaptRequest(WALK, body, CONTACTS, scene.constraints, tracks=scene.tracks)
        assert _beyond(adapt_again(request), before, _asked(scene.constraints)) < 1e-6


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_targets_all_about_the_shoulders_and_hips_keep_limbs_within(body: Morphology) -> None:
    random, before = np.random.default_rng(7), adapt_again(AdaptRequest(WALK, body))
    for part in ("left_forearm", "right_hand", "left_upper_arm", "right_shank", "left_foot"):
        points = body.layout.proximal_points()
        root = points[
            body.layout.segment_of_part(BodyPart(part.split("_")[0] + ("_thigh" if part[-1] in "kt" else "_upper_arm")))
        ]
        for _ in range(6):
            place = before.positions[30, root] + random.normal(size=3) * 0.25 * body.stature
            wish = target(part, place, random.choice([ARM, Chain(trunk=1.0)]))
            assert _beyond(adapt_again(AdaptRequest(WALK, body, (), (wish,))), before, _asked((wish,))) < 1e-6


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_what_is_well_within_is_as_without_limits_to_the_bit(body: Morphology) -> None:
    standing = adapt_again(AdaptRequest(WALK, body, CONTACTS))
    assert np.array_equal(standing.rotations, adapt_again(AdaptRequest(WALK, body, CONTACTS, limited=False)).rotations)
    place = standing.positions[30, body.layout.collar_point(0) + 1] + body.stature * np.array([0.2, 0.02, -0.05])
    request = AdaptRequest(WALK, body, CONTACTS, (target("left_forearm", place, ARM),))
    free = replace(request, limited=False)
    assert np.array_equal(adapt_again(request, 30, 30).rotations, adapt_again(free, 30, 30).rotations)


def test_what_a_person_cannot_reach_is_missed_unless_the_trunk_helps_and_the_limits_are_named() -> None:
    before = adapt_again(AdaptRequest(WALK, WOMAN, CONTACTS), 30, 30)
    place = before.positions[0, WOMAN.layout.collar_point(0) + 1] + [0.1, -0.5, 0.2]
    alone = AdaptRequest(WALK, WOMAN, CONTACTS, (target("left_forearm", place, ARM),))
    adapted = adapt_again(alone, 30, 30)
    assert adapted.residuals[0, 0] > 0.1
    assert adapt_again(replace(alone, limited=False), 30, 30).residuals[0, 0] < 0.05
    assert blocking_constraints(grounded_motion_of(alone), alone.constraints, {}, adapted)[0, 0] == BLOCKED_BY_LIMITS
    helped = replace(alone, constraints=(target("left_forearm", place, Chain(trunk=1.0, root=1.0)),))
    assert adapt_again(helped, 30, 30).residuals[0, 0] < 1e-3


def test_a_limb_swivels_back_before_it_gives_up_its_target() -> None:
    before = adapt_again(AdaptRequest(WALK, WOMAN, CONTACTS), 30, 30)
    shoulder = before.positions[0, WOMAN.layout.collar_point(0) + 1]
    for aside in ([-0.15, 0.26, -0.18], [-0.04, -0.33, -0.09], [0.08, -0.22, 0.31], [-0.32, 0.29, 0.16]):
        request = AdaptRequest(WALK, WOMAN, CONTACTS, (target("left_forearm", shoulder + aside, ARM),))
        free, limited = adapt_again(replace(request, limited=False), 30, 30), adapt_again(request, 30, 30)
        assert _beyond(free, before, {0}) > -0.05
        assert limited.residuals[0, 0] < 2e-4


def _beyond_the_arm(body: Morphology, random: np.random.Generator) -> np.ndarray:
    """A place of the left wrist for an arm well within its limits on a trunk that has turned a little."""
    before, k, row = (
        adapt_again(AdaptRequest(WALK, body, CONTACTS), 30, 30),
        body.layout.spine_count,
        limb_limit_records(body)[0],
    )
    doll = Mannequin(before, 0, random)
    for vertebra in range(1, k):
        doll.jiggle(vertebra, 0.12)
    doll.jiggle(k + 2, 0.2)
    angle, far = random.uniform(0.0, 2.0 * np.pi), 0.92 * np.sqrt(random.uniform(0.2, 0.95))
    way = far * np.array([np.cos(angle), np.sin(angle)])
    swing = way * np.where(way >= 0.0, row["radii"][0][[0, 2]], row["radii"][0][[1, 3]])
    twist = row["twists"][0, 0] + random.uniform(-0.9, 0.9) * row["twists"][0, 1]
    posture = Rotation.from_rotvec([*swing, 0.0]) * Rotation.from_rotvec([0.0, 0.0, twist])
    wanted = doll.rotations[k + 2] @ row["axes"][0] @ posture.as_matrix()
    doll.turn(k + 3, Rotation.from_matrix(wanted @ doll.rotations[k + 3].T).as_rotvec())
    bend = random.uniform(0.3, 2.2) - _bends(doll.rotations[None, k + 3], doll.rotations[None, k + 4])[0]
    doll.turn(k + 4, bend * doll.rotations[k + 3, :, 0])
    return doll.place(BodyPoint(BodyPart.LEFT_FOREARM, at_end=True))


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_the_trunk_brings_a_limited_arm_to_what_they_can_reach_together(body: Morphology) -> None:
    random, misses = np.random.default_rng(5), list[float]()
    while len(misses) < 24:
        place = _beyond_the_arm(body, random)
        request = AdaptRequest(WALK, body, CONTACTS, (target("left_forearm", place, ARM),))
        if adapt_again(request, 30, 30).residuals[0, 0] > 5e-3:
            for chain in (Chain(trunk=1.0), Chain(trunk=1.0, root=1.0)):
                wish = target("left_forearm", place, chain)
                misses.append(adapt_again(replace(request, constraints=(wish,)), 30, 30).residuals[0, 0])
    assert np.mean(np.array(misses) < 2e-4) > 0.9
    assert max(misses) < 2e-3


def _circling(axis: int) -> tuple[FollowTracked, Track]:
    """A place that goes all about the left shoulder in three seconds, 0.4 m away."""
    before = adapt_again(AdaptRequest(LONG, WOMAN, LONG_CONTACTS))
    angles = 2 * np.pi * np.arange(before.frame_count) / (3 * RATE)
    circle = np.insert(np.stack([np.cos(angles), np.sin(angles)], axis=1), axis, 0.25, axis=1)
    places = before.positions[:, WOMAN.layout.collar_point(0) + 1] + 0.4 * circle
    return FollowTracked("circle"), Track(places, np.eye(3)[None])


LONG, LONG_CONTACTS = walk(180)


@pytest.mark.parametrize("axis", range(3))
def test_a_target_that_goes_smoothly_through_all_limits_moves_no_joint_with_a_jerk(axis: int) -> None:
    follow, track = _circling(axis)
    wish = PositionConstraint("motion", "Wrist", BodyPoint(BodyPart.LEFT_FOREARM, at_end=True), ARM, 0, ALWAYS, follow)
    request = AdaptRequest(LONG, WOMAN, LONG_CONTACTS, (wish,), tracks={follow: track})
    adapted, arm = adapt_again(request), slice(WOMAN.layout.spine_count + 2, WOMAN.layout.spine_count + 6)
    assert _beyond(adapted, adapt_again(AdaptRequest(LONG, WOMAN, LONG_CONTACTS)), {0}) < 1e-6
    assert angular_acceleration(local_rotations(adapted)[:, arm], RATE).max() < 1500.0
    part = adapt_again(request, 60, 70)
    assert np.array_equal(part.rotations, adapted.rotations[60:71])


def _turned(start: np.ndarray, *turns: tuple[str, float]) -> np.ndarray:
    for axis, degrees in turns:
        start = Rotation.from_euler(axis, degrees, degrees=True).as_matrix() @ start
    return start


def _part_of(ball: BallLimit, posture: np.ndarray) -> float:
    swing, _ = _swings(ball.axes.T @ posture)
    radii = np.radians(np.where(swing >= 0.0, [ball.radii[0], ball.radii[2]], [ball.radii[1], ball.radii[3]]))
    return float(np.linalg.norm(swing / radii))


PUBLISHED = {
    "flexion": (SHOULDER_RANGE, HANGING, ("y", -167.0)), "extension": (SHOULDER_RANGE, HANGING, ("y", 62.0)),
    "abduction": (SHOULDER_RANGE, HANGING, ("x", 180.0)),
    "across": (SHOULDER_RANGE, HANGING, ("x", 90.0), ("z", -135.0)),
    "behind": (SHOULDER_RANGE, HANGING, ("x", 90.0), ("z", 45.0)), "hip flexion": (HIP_RANGE, STANDING, ("y", -122.0)),
    "hip extension": (HIP_RANGE, STANDING, ("y", 20.0)), "hip abduction": (HIP_RANGE, STANDING, ("x", 46.0)),
    "hip adduction": (HIP_RANGE, STANDING, ("x", -27.0)),
    "sitting astride": (HIP_RANGE, STANDING, ("y", -90.0), ("z", 45.0)),
}  # fmt: skip


@pytest.mark.parametrize("name", PUBLISHED)
def test_published_ranges_lie_within_the_limits(name: str) -> None:
    ball, start, *turns = PUBLISHED[name]
    assert 0.5 < _part_of(ball, _turned(start, *turns)) < 1.05


@pytest.mark.parametrize(
    ("ball", "start", "turns"),
    [
        (SHOULDER_RANGE, HANGING, [("y", 110.0)]),
        (SHOULDER_RANGE, HANGING, [("x", 90.0), ("z", 80.0)]),
        (SHOULDER_RANGE, HANGING, [("x", 90.0), ("z", -190.0)]),
        (HIP_RANGE, STANDING, [("y", 60.0)]),
        (HIP_RANGE, STANDING, [("x", 100.0)]),
        (HIP_RANGE, STANDING, [("y", -160.0)]),
    ],
)
def test_what_nobody_can_lies_beyond(ball: BallLimit, start: np.ndarray, turns: list[tuple[str, float]]) -> None:
    assert _part_of(ball, _turned(start, *turns)) > 1.0


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_an_elbow_folds_as_far_as_an_elbow_does(body: Morphology) -> None:
    before = adapt_again(AdaptRequest(WALK, body), 30, 30)
    k, place = body.layout.spine_count, before.positions[0, body.layout.collar_point(0) + 1] + [0.02, 0.0, 0.0]
    adapted = adapt_again(AdaptRequest(WALK, body, (), (target("left_forearm", place, ARM),)), 30, 30)
    bend = np.degrees(_bends(adapted.rotations[:, k + 3], adapted.rotations[:, k + 4])[0])
    assert 140.0 < bend < 150.0
