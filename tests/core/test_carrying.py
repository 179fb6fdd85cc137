"""Contacts that carry a body: their laws, and a handstand, a bear's walk and a seat on bodies of any build."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from studio.core.body.morphology import Morphology
from studio.core.body.pose import PoseSequence
from studio.core.captures.contacts import ContactInterval, ContactPoint
from studio.core.grounds import Bumps, Slope, Steps
from studio.core.grounds.ground import Ground
from studio.core.kernels import channel_columns as channel
from studio.core.kernels.limbs.legs import place_leg
from studio.core.kernels.records import ArmTargets, LegTargets, Pose, SupportLinks
from studio.core.kernels.support import body_settling as kernel
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.normalize import normalize_capture
from studio.core.normalized.realize import realize_motion
from studio.core.quality.metrics import contact_quality
from studio.core.rotations import multiply
from studio.core.solver.adapt import adapt
from studio.core.solver.grounding.body_support import find_support, tilt_with_ground
from studio.core.solver.grounding.contact_blending import hann_average, interpolated_corrections
from studio.core.solver.grounding.trunk_arching import arch_trunk
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.io.project.character_file import bundled_characters
from tests.builders import make_capture, make_morphology, make_skeleton
from tests.core.motions import RATE, about, random_rotations, walk
from tests.core.twins.limb import place_limb, soft_reach
from tests.core.twins.rotation import from_quaternion, shortest_arc

seeds = st.integers(0, 2**32 - 1)
BODIES = {name: character.morphology for name, character in bundled_characters().items()}
BODY = make_morphology(leg_scale=1.1)
WALK = walk(60)[0]
TURNS = np.broadcast_to(np.eye(3), (120, BODY.layout.segment_count, 3, 3))


def _posed(frames: int, pitch: float, arms: float, legs: float, sway: float) -> NormalizedMotion:
    """A body whose trunk is pitched forward, arms and legs raised forward from hanging and straight, radians."""
    skeleton = make_skeleton()
    phase = 2 * np.pi * np.arange(frames) / RATE
    rotations = np.zeros((frames, skeleton.joint_count, 4))
    rotations[..., 3] = 1.0
    joint = skeleton.index
    rotations[:, joint("Hips")] = about((0, 1, 0), pitch + sway * np.sin(phase))
    for side, name in enumerate(("Left", "Right")):
        down = about((-1 if side == 0 else 1, 0, 0), np.pi / 2 + 0.0 * phase)
        forward = about((0, -1, 0), arms + sway * np.sin(phase + 1.0))
        rotations[:, joint(f"{name}Arm")] = multiply(forward, down)
        rotations[:, joint(f"{name}UpLeg")] = about((0, -1, 0), legs + sway * np.cos(phase))
    translations = np.tile(skeleton.offsets, (frames, 1, 1))
    translations[:, 0, 0] += 0.02 * np.sin(phase)
    return normalize_capture(
        make_capture("pose", frames, skeleton=skeleton, poses=PoseSequence(rotations, translations))
    )[0]


def _contacts(frames: int, *names: str) -> tuple[ContactInterval, ...]:
    return tuple(ContactInterval("pose", ContactPoint(name), 0, frames - 1) for name in names)


HANDSTAND = _posed(90, np.pi, np.pi, 0.0, 0.04), _contacts(90, "left_hand", "right_hand")
BEAR = _posed(90, 1.35, 1.2, 1.3, 0.04), _contacts(90, "left_hand", "right_hand", "left_toe", "right_toe")


def _adapted(case: tuple[NormalizedMotion, tuple[ContactInterval, ...]], name: str) -> AdaptedMotion:
    return adapt(AdaptRequest(case[0], BODIES[name], case[1]))


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("case", [HANDSTAND, BEAR], ids=["handstand", "bear"])
def test_hands_stand_on_the_ground_of_every_body(
    case: tuple[NormalizedMotion, tuple[ContactInterval, ...]], name: str
) -> None:
    quality = contact_quality(_adapted(case, name), case[1], Ground())
    assert quality.slide < 1e-3
    assert max(quality.rise, quality.penetration) < 2e-3


@pytest.mark.parametrize("name", BODIES)
def test_a_handstand_is_as_high_as_arms_and_trunk(name: str) -> None:
    body, adapted = BODIES[name], _adapted(HANDSTAND, name)
    layout = body.layout
    high = adapted.positions[:, [layout.hip_point(0), layout.hip_point(1)], 2].mean(axis=1)
    trunk = body.spine[:, 2].sum() + body.collar_base[0, 2] - body.hip_offset[0, 2]
    expected = body.arm[0].sum() + trunk + 0.065 * body.leg_length
    assert np.median(high) == pytest.approx(expected, rel=0.12)
    reaches = np.linalg.norm(
        adapted.positions[:, layout.wrist_point(0)] - adapted.positions[:, layout.wrist_point(0) - 2], axis=1
    )
    assert reaches.min() > 0.93 * body.arm[0].sum()  # on straight arms, as performed


def test_longer_legs_do_not_raise_a_handstand_and_longer_arms_do() -> None:
    body = BODIES["adult_woman"]

    def height(other: object) -> float:
        adapted = adapt(AdaptRequest(HANDSTAND[0], other, HANDSTAND[1]))
        return float(np.median(adapted.positions[:, 0, 2]))

    usual = height(body)
    assert height(replace(body, leg=1.2 * body.leg)) == pytest.approx(usual, abs=0.02)
    assert height(replace(body, arm=1.2 * body.arm)) == pytest.approx(usual + 0.2 * body.arm[0].sum(), abs=0.02)


def _plank(body: Morphology) -> AdaptedMotion:
    """A plank that ``BODY`` performed, on arms that hang."""
    contacts = _contacts(60, "left_hand", "right_hand", "left_toe", "right_toe")
    return adapt(AdaptRequest(_posed(60, 1.3, 1.3, 0.0, 0.0), body, contacts, actor=BODY))


def test_longer_arms_raise_a_level_trunk_and_leave_the_hips() -> None:
    longer = replace(BODY, arm=1.2 * BODY.arm)
    usual, raised = (_plank(body).positions[30] for body in (BODY, longer))
    hip, neck = BODY.layout.hip_point(0), BODY.layout.neck_base
    gain = raised[neck, 2] - usual[neck, 2]
    assert gain > 0.6 * 0.2 * BODY.arm[0].sum()
    assert raised[hip, 2] - usual[hip, 2] < 0.4 * gain


def test_a_trunk_that_arches_keeps_arms_and_gaze() -> None:
    positions, rotations = (each.copy() for each in realize_motion(_posed(5, 1.3, 1.3, 0.0, 0.0), BODY))
    before, turned, layout = positions.copy(), rotations.copy(), BODY.layout
    arch_trunk(np.full(5, 0.05), BODY, positions, rotations)
    assert positions[:, layout.neck_base, 2] - before[:, layout.neck_base, 2] == pytest.approx(0.05, abs=0.01)
    assert np.array_equal(positions[:, layout.hip_point(0) :], before[:, layout.hip_point(0) :])
    assert np.array_equal(rotations[:, layout.head_joint], turned[:, layout.head_joint])
    for side in range(2):
        shoulder, wrist = layout.collar_point(side) + 1, layout.wrist_point(side)
        assert positions[:, wrist] - positions[:, shoulder] == pytest.approx(before[:, wrist] - before[:, shoulder])
        bones = np.linalg.norm(np.diff(positions[:, shoulder : wrist + 1], axis=1), axis=2)
        assert bones == pytest.approx(np.broadcast_to(BODY.arm[side], bones.shape))


def test_palms_lie_flat() -> None:
    adapted = _adapted(HANDSTAND, "tall_man")
    layout = adapted.morphology.layout
    for side in range(2):
        fingers = adapted.positions[:, layout.wrist_point(side) + 1] - adapted.positions[:, layout.wrist_point(side)]
        assert np.abs(fingers[:, 2]).max() < 0.01
        assert np.abs(np.diff(fingers, axis=0)).max() < 1e-9


@pytest.mark.parametrize("above", [0.0, 0.05, 0.1])
def test_a_wrist_over_fingers_that_slope_down_is_as_high_as_the_actors(above: float) -> None:
    motion, palm = _posed(60, 1.3, 1.3, 0.0, 0.0), 0.065 * BODY.leg_length
    wrist, tip = BODY.layout.wrist_point(0), BODY.layout.wrist_point(0) + 1
    lower = realize_motion(motion, BODY)[0][0, wrist, 2] - palm - above
    channels = motion.channels.copy()
    channels[:, channel.HIPS + 2] -= lower / BODY.leg_length
    contacts = _contacts(60, "left_hand", "right_hand", "left_toe", "right_toe")
    adapted = adapt(AdaptRequest(replace(motion, channels=channels), BODY, contacts, actor=BODY))
    assert adapted.positions[30, [wrist, tip], 2] == pytest.approx([palm + above, palm], abs=2e-3)
    assert contact_quality(adapted, contacts[:2], Ground()).rise < 2e-3


def test_on_feet_alone_nothing_else_is_asked() -> None:
    motion, contacts = walk(60)
    positions = np.zeros((60, BODY.layout.point_count, 3))
    assert find_support(motion, BODY, contacts, Ground(), positions, TURNS) is None


@given(seeds)
def test_who_leans_with_a_slope_stands_on_it_as_on_the_floor(seed: int) -> None:
    """Places on the floor under the root stay, what stood upright stands along the normal, and nothing is stretched."""
    random = np.random.default_rng(seed)
    way = random.uniform(-3, 3)
    ground = Slope(0.0, random.uniform(-0.4, 0.4), way, (-99.0 * np.cos(way), -99.0 * np.sin(way)))
    positions = random.normal(size=(30, BODY.layout.point_count, 3))
    positions[:, 1] = positions[:, 0] - positions[:, 0, 2:] * [0.0, 0.0, 1.0]
    turns = np.broadcast_to(np.eye(3), (30, BODY.layout.segment_count, 3, 3))
    leant, turned, upright = tilt_with_ground(np.ones((30, 1)), BODY, ground, RATE, positions, turns)
    assert np.allclose(leant[:, 1], positions[:, 1], atol=1e-12)
    normals = ground.normal_at(positions[:, 0])
    assert np.allclose(leant[:, 0] - leant[:, 1], positions[:, 0, 2:] * normals, atol=1e-9)
    assert np.allclose(turned[:, 0, :, 2], normals, atol=1e-9)
    spans = [np.linalg.norm(np.diff(points, axis=1), axis=2) for points in (positions, leant)]
    assert np.allclose(*spans, atol=1e-9)
    assert np.allclose(upright[..., 2], positions[..., 2], atol=1e-12)
    for same in tilt_with_ground(np.zeros((30, 1)), BODY, ground, RATE, positions, turns)[::2]:
        assert np.allclose(same, positions, atol=1e-12)


def test_who_carries_adds_up_to_everything_and_passes_on_smoothly() -> None:
    motion = _posed(120, 1.35, 1.2, 1.3, 0.0)
    contacts = (
        ContactInterval("pose", ContactPoint.LEFT_TOE, 0, 50), ContactInterval("pose", ContactPoint.LEFT_HAND, 40, 80),
        ContactInterval("pose", ContactPoint.SEAT, 95, 119),
    )  # fmt: skip
    carrying = find_support(motion, BODY, contacts, Ground(), np.ones((120, BODY.layout.point_count, 3)), TURNS)
    assert carrying is not None
    share = carrying.feet_fraction
    assert share[0] == pytest.approx(1.0)
    assert share[70:].max() < 1e-9
    assert (np.diff(share) < 1e-12).all()
    assert np.abs(np.diff(share, 2)).max() * RATE**2 < 80.0


@given(arrays(np.float64, st.tuples(st.integers(1, 60), st.just(2)), elements=st.floats(-2, 2)), st.floats(0.02, 0.3))
def test_averages_stay_within_and_keep_what_is_still(values: np.ndarray, reach: float) -> None:
    smooth = hann_average(values, reach, RATE)
    assert smooth.shape == values.shape
    assert (smooth <= values.max(axis=0) + 1e-12).all()
    assert (smooth >= values.min(axis=0) - 1e-12).all()
    assert np.allclose(hann_average(np.full_like(values, 0.7), reach, RATE), 0.7)


@given(seeds)
def test_corrections_hold_where_they_are_known_and_fade_away_from_it(seed: int) -> None:
    random = np.random.default_rng(seed)
    known = np.repeat(random.integers(0, 2, 12), random.integers(1, 40, 12)).astype(bool)
    assume(known.any())
    corrections = np.where(known[:, None], random.normal(size=(len(known), 3)), 0.0)
    filled = interpolated_corrections(corrections, known, RATE)
    assert np.array_equal(filled[known], corrections[known])
    away = np.array([np.abs(np.flatnonzero(known) - frame).min(initial=999) for frame in range(len(known))])
    assert (filled[away > 0.4 * RATE] == 0.0).all()


@given(seeds)
def test_what_goes_from_one_place_to_the_next_goes_beyond_neither(seed: int) -> None:
    """A hand that was led on as fast as the ground took it back overshot, and pulled the body after it."""
    random = np.random.default_rng(seed)
    known = np.repeat(random.integers(0, 2, 12), random.integers(1, 40, 12)).astype(bool)
    assume(known.any())
    corrections = np.where(known[:, None], np.cumsum(random.normal(size=(len(known), 3)), axis=0), 0.0)
    filled = interpolated_corrections(corrections, known, RATE)
    stands = np.flatnonzero(known)
    for frame in np.flatnonzero(~known):
        ends = [corrections[stands[stands < frame][-1:]], corrections[stands[stands > frame][:1]], np.zeros((1, 3))]
        either = np.concatenate(ends)
        assert (filled[frame] <= either.max(axis=0) + 1e-12).all()
        assert (filled[frame] >= either.min(axis=0) - 1e-12).all()


class _Links:
    """Random limbs round a root, all of which a small move brings into reach."""

    def __init__(self, seed: int) -> None:
        random = np.random.default_rng(seed)
        self.starts = random.normal(size=(3, 1, 3)) * 0.3
        wanted, turn = random.normal(size=3) * 0.05, Rotation.from_rotvec(random.normal(size=3) * 0.1)
        ways = random.normal(size=(3, 1, 3))
        lengths = random.uniform(0.3, 0.9, (3, 1))
        self.roots = random.normal(size=(1, 3))
        reached = self.roots + wanted + turn.apply(self.starts[:, 0])[:, None]
        self.ends = reached + lengths[..., None] * ways / np.linalg.norm(ways, axis=2, keepdims=True)
        self.least, self.most = lengths.copy(), lengths.copy()
        self.least[0] = 0.0
        self.seats = np.column_stack([random.normal(size=(1, 3)) * 0.1, np.zeros((1, 4))])

    def misses(self, move: np.ndarray) -> np.ndarray:
        turned = Rotation.from_rotvec(move[3:]).apply(self.starts[:, 0])
        spans = np.linalg.norm(self.ends[:, 0] - self.roots[0] - move[:3] - turned, axis=1)
        return spans - np.clip(spans, self.least[:, 0], self.most[:, 0])

    def settled(self, stiffness: float) -> np.ndarray:
        moves = np.zeros((1, 6))
        links = SupportLinks(self.starts, self.ends, self.least, self.most)
        kernel.settle_frames(self.roots, links, self.seats, np.zeros((1, 6)), stiffness, moves)
        return moves[0]


@given(seeds)
def test_a_body_settles_where_all_that_stands_is_nearly_or_wholly_in_reach(seed: int) -> None:
    links = _Links(seed)
    spread = np.linalg.svd(links.starts[:, 0], compute_uv=False)
    assume(spread.min() > 0.15)
    move = links.settled(1e-6)
    assert np.abs(links.misses(move)).max() < 0.3 * np.abs(links.misses(np.zeros(6))).max() + 1e-3
    assert np.linalg.norm(move) < 1.0


def test_it_misses_hardly_more_than_an_optimum_does() -> None:
    stiffness, excesses = 1e-2, []
    weights = np.sqrt(stiffness) * np.array([1.0, 1.0, 1.0, *[kernel.METRES_PER_RADIAN] * 3])
    for seed in range(200):
        links = _Links(seed)
        links.least[0] = links.most[0]

        def costs(move: np.ndarray, links: _Links = links) -> np.ndarray:
            return np.concatenate([links.misses(move), weights * move])

        best = least_squares(costs, np.zeros(6), xtol=1e-14, ftol=1e-14)
        excesses.append(np.sum(costs(links.settled(stiffness)) ** 2) / (np.sum(best.fun**2) + 1e-8))
    assert np.quantile(excesses, 0.98) < 1.5
    assert max(excesses) < 10.0  # least squares have hollows: now and then one of the two ends in a higher one


@given(seeds)
def test_an_arm_is_placed_as_its_twin(seed: int) -> None:
    random = np.random.default_rng(seed)
    side, row = int(random.integers(2)), WALK.channels[random.integers(WALK.frame_count)]
    layout = BODY.layout
    positions = np.tile(random.normal(size=3), (layout.point_count, 1))
    rotations = random_rotations(random, layout.segment_count)
    before = positions.copy()
    shoulder, upper = layout.collar_point(side) + 1, layout.spine_count + 3 + 4 * side
    way = random.normal(size=3)
    wrist = positions[shoulder] + random.uniform(0.2, 1.3) * BODY.arm[side].sum() * way / np.linalg.norm(way)
    hand = random_rotations(random)
    comfort = random.uniform(0.9, 1.0)
    ours = (np.stack([[each]] * 2) for each in (comfort, wrist, hand, 1.0))
    kernel.place_arm(0, side, BODY.packed, ArmTargets(row[None], *ours), Pose(positions, rotations))

    clavicle = rotations[layout.spine_count - 1] @ from_quaternion(row[channel.CLAVICLE + 4 * side :][:4])
    frame = clavicle @ from_quaternion(row[channel.LIMB_FRAME + 4 * side :][:4])
    apart, length = wrist - before[shoulder], BODY.arm[side].sum()
    distance = np.linalg.norm(apart)
    elbow, reached, first, second = place_limb(
        before[shoulder],
        shortest_arc(frame[:, 2], apart / distance) @ frame,
        length * soft_reach(distance / length, comfort),
        tuple(BODY.arm[side]),
        row[channel.LIMB_OFF_PLANE + side] * length,
        1.0,
        row[channel.LIMB_TWIST + 2 * side :][:2],
    )
    assert np.allclose(positions[shoulder + 1 : shoulder + 3], [elbow, reached], atol=1e-9)
    assert np.allclose(rotations[upper : upper + 3], [first, second, hand], atol=1e-9)
    assert np.allclose(positions[shoulder + 3], reached + hand @ BODY.hand[side], atol=1e-12)
    others = np.delete(positions, range(shoulder + 1, shoulder + 4), axis=0)
    assert np.array_equal(others, np.delete(before, range(shoulder + 1, shoulder + 4), axis=0))


def _frame_along(direction: np.ndarray) -> np.ndarray:
    """Columns x, y, z: z along the direction, x as far forward as it can be."""
    z = direction / np.linalg.norm(direction)
    x = np.array([1.0, 0.0, 0.0]) - z[0] * z
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z], axis=1)


@given(seeds)
def test_a_held_knee_is_where_it_is_to_be_and_its_ankle_too(seed: int) -> None:
    random = np.random.default_rng(seed)
    side, layout = int(random.integers(2)), BODY.layout
    upper, lower = BODY.leg[side]
    positions = np.tile(random.normal(size=3), (layout.point_count, 1))
    rotations = random_rotations(random, layout.segment_count)
    hip = positions[0] + rotations[0] @ BODY.hip_offset[side]
    ways = random.normal(size=(2, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    knee = hip + upper * ways[0]
    ankle = knee + lower * ways[1]
    span = np.linalg.norm(ankle - hip)
    assume(0.5 * (upper + lower) < span < 0.9 * (upper + lower))
    row, foot, toe = WALK.channels[0], random_rotations(random), random_rotations(random)
    target = np.array([*ankle, *knee, 1.0])
    legs = LegTargets(row, *(np.stack([each] * 2) for each in (0.97, target, foot, toe)))
    place_leg(side, BODY.packed, legs, Pose(positions, rotations))
    assert np.allclose(positions[layout.ankle_point(side)], ankle, atol=1e-9)
    assert np.allclose(positions[layout.hip_point(side) + 1], knee, atol=1e-9)


@given(seeds)
def test_contacts_of_any_kind_anywhere_leave_a_whole_body(seed: int) -> None:
    """No number that is not finite, no bone of another length, whatever is said to stand, on whatever ground."""
    random = np.random.default_rng(seed)
    motion = (WALK, HANDSTAND[0], BEAR[0])[seed % 3]
    contacts = []
    for point in ContactPoint:
        for first in random.integers(0, motion.frame_count, random.integers(0, 3)).tolist():
            contacts.append(ContactInterval("pose", point, first, first + int(random.integers(0, 50))))
    ground = (Ground(), Slope(0.0, 0.2, 0.5), Steps(0.0, 0.17, 0.3, 5), Bumps(0.0, 0.08))[seed % 4]
    body = list(BODIES.values())[seed % len(BODIES)]
    adapted = adapt(AdaptRequest(motion, body, tuple(contacts), (), ground))
    assert np.isfinite(adapted.positions).all()
    assert np.isfinite(adapted.rotations).all()
    for side in range(2):
        for first, lengths in (
            (body.layout.hip_point(side), body.leg[side]),
            (body.layout.collar_point(side) + 1, body.arm[side]),
        ):
            bones = np.diff(adapted.positions[:, first : first + 3], axis=1)
            assert np.allclose(np.linalg.norm(bones, axis=2), lengths, atol=1e-8)
