"""Feet in the air: above the floor, over to where they land, and with room to kick."""

import math
from functools import cache
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology, sole_rows
from studio.core.captures.contacts import ContactInterval
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.grounds import Bumps, Slope, Steps
from studio.core.grounds.ground import Ground
from studio.core.kernels.algebra.smooth_steps import penetration_correction
from studio.core.kernels.support import swing_foot_clearance as kernel
from studio.core.normalized.compose import Composite, compose_pieces
from studio.core.normalized.normalize import capture_contacts, detected_contacts, normalize_capture
from studio.core.normalized.pieces import MotionPiece
from studio.core.quality.metrics import contact_quality
from studio.core.rotations import to_matrix
from studio.core.runs import runs_of
from studio.core.solver.adapt import body_point_positions, solve_constraints
from studio.core.solver.grounding.grounded_motion import GroundedMotion, ground_motion, grounded_motion_of
from studio.core.solver.grounding.swing_foot_path import Sole, clear_swing_foot, rounded_ground_height
from studio.core.solver.request import AdaptRequest
from studio.io.importing import load_capture
from studio.io.project.character_file import bundled_characters
from studio.resources_folder import example_captures_folder
from tests.captures import capture_file, outside
from tests.core.motions import from_vectors
from tests.core.test_compose import BODY, cut
from tests.core.test_transitions import picked

# Feet in the air: above the floor, smoothly, and unchanged where they are clear of it anyway.


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
def test_nothing_of_a_foot_in_the_air_is_below_the_floor(seed: int, stands: np.ndarray) -> None:
    foot = _Foot(seed, stands)
    upright = foot.feet[:, 2, 2] > 0.0
    heights = _points(foot.ankles, foot.feet, foot.toes)
    assert (heights[(stands == 0) & upright] > -1e-9).all()


@given(st.integers(0, 2**32 - 1), states)
def test_what_stands_or_is_clear_stays_as_it_is(seed: int, stands: np.ndarray) -> None:
    foot = _Foot(seed, stands)
    ankles, toes = foot.before
    assert np.array_equal(foot.ankles[stands != 0], ankles[stands != 0])
    assert np.array_equal(foot.toes[stands & 2 != 0], toes[stands & 2 != 0])
    clear = _points(ankles, foot.feet, toes).min(axis=1) > kernel.SWING_CLEARANCE * SOLE[0, 3]
    assert np.array_equal(foot.ankles[clear], ankles[clear])
    around = 2 * round(kernel.TOE_BEND_LEAD_SECONDS * RATE)  # toes bend before they must
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
        return float((rounded_ground_height(self.ground, points) - points[..., 2]).max())


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
    assert rounded_ground_height(steps, places).tolist() == [0.0, 0.0, pytest.approx(0.17)]


# A foot in the air where the next clip takes over is lifted over to where it lands.


AFTER = 1.5
"""Seconds after a change for which feet are looked at."""
LOW = 0.01
"""Metres over the ground below which a foot that moves skates."""
STEP, LIFT = 0.08, 0.02
"""Metres that a foot goes farther than by itself for it to be a step, and by which that is lifted at least."""
SKATE = 0.1
"""Metres that a foot goes farther than by itself, rolling over heel and ball, without skating."""


class Seen(NamedTuple):
    """Metres that feet skate farther than by themselves at a change, and by which the lowest step is lifted."""

    skate: float
    lift: float


def soles(stands: GroundedMotion, side: int) -> np.ndarray:
    """(F, P, 3) places of the lowest points of a foot."""
    body = stands.morphology
    foot = body.layout.spine_count + 12 + 4 * side
    turns = stands.rotations[:, foot], stands.rotations[:, foot + 1]
    return Sole.of(stands.positions[:, body.layout.ankle_point(side)], *turns, sole_rows(body, side)).points


def seen(row: Composite, pieces: tuple[MotionPiece, MotionPiece], body: Morphology) -> Seen:
    """Figures of the change of a ``row`` of two pieces."""
    known = body, Ground()
    stands = ground_motion(row.motion, known[0], row.contacts, known[1])
    alone = [ground_motion(each.motion, known[0], each.contacts, known[1]) for each in pieces]
    rate, first = stands.motion.frame_rate, row.motion.changes[0].first
    frames = np.arange(first - 1, min(first + round(AFTER * rate), row.motion.frame_count))
    own = np.rint(row.played[1].motion_frames(frames, row.timing)).astype(int).clip(0, pieces[1].motion.frame_count - 1)
    skate, lift = 0.0, np.inf
    for side in range(2):
        led, by_itself = soles(stands, side)[frames], soles(alone[1], side)[own]
        height, states = led[..., 2].min(axis=1), stands.footing.states[side, frames]
        ways = [np.linalg.norm(np.diff(each.mean(axis=1)[:, :2], axis=0), axis=1) for each in (led, by_itself)]
        for begin, stop in runs_of(height < LOW):
            skate = max(skate, float(np.sum((ways[0] - ways[1])[begin : stop - 1])))
        for begin, stop in runs_of(states == 0):
            if 0 < stop < len(frames):
                going = [np.linalg.norm(np.diff(each[[max(begin - 1, 0), stop]].mean(axis=1)[:, :2], axis=0))
                         for each in (led, by_itself)]  # fmt: skip
                if going[0] > 1.3 * going[1] + STEP:
                    lift = min(lift, float(height[begin:stop].max()))
    return Seen(skate, lift)


@cache
def by_chance() -> list[Seen]:
    return [seen(compose_pieces(pair), pair, BODY) for pair in picked()]


def test_no_foot_skates_where_clips_take_over_at_any_frame() -> None:
    """Of 32 by chance 8 did by more than 6 cm, one by 43 cm: a foot on its way to the ground was led back."""
    skates = np.array([each.skate for each in by_chance()])
    assert np.mean(skates > 0.06) < 1.0 / 8.0
    assert skates.max() < SKATE


def test_a_foot_that_steps_is_lifted() -> None:
    """Of 32 changes one stepped 11 mm above the ground."""
    assert min(each.lift for each in by_chance()) > LIFT


def captured(name: str) -> tuple[MotionPiece, Morphology]:
    capture = load_capture(capture_file(f"bvh/varied/{name}.bvh"))
    motion, actor = normalize_capture(capture)
    found = capture_contacts(capture)
    contacts = tuple(ContactInterval("", point, *span) for point, spans in found.items() for span in spans)
    return MotionPiece(motion, contacts, capture.first_frame, motion.frame_count - 1), actor.morphology


@pytest.mark.parametrize(
    ("first", "last", "second", "begin"),
    outside(
        ("accad_female1_B03_Walk1", 185, "accad_female1_D3_ConversationGestures", 0),
        ("accad_female1_B15_WalkTurnAround180", 103, "accad_female1_D3_ConversationGestures", 730),
        ("accad_male2_E20_DodgeRight", 73, "accad_female1_D3_ConversationGestures", 418),
        ("accad_female1_B03_Walk1", 123, "accad_female1_D3_ConversationGestures", 1286),
        ("accad_male2_E11_BlockLeftHigh", 61, "accad_female1_D3_ConversationGestures", 76),
    ),
)
def test_a_foot_in_the_air_at_the_end_of_a_captured_walk_or_fight_steps_into_a_stand(
    first: str, last: int, second: str, begin: int
) -> None:
    """It skated 66 cm back over the ground."""
    before, body = captured(first)
    before = cut(before, last=last)
    after, _ = captured(second)
    pair = before, cut(after, first=begin, last=min(begin + 120, after.last), start=before.end)
    row = compose_pieces(pair)
    found = seen(row, pair, body)
    adapted = solve_constraints(ground_motion(row.motion, body, row.contacts, Ground()), ())
    assert contact_quality(adapted, adapted.contacts, Ground()).slide < 2e-3
    assert found.skate < SKATE
    assert found.lift > LIFT


# A foot that is to kick a target near by: bodies step back from what hip and knee do not bend to, and hold it.


KICK = load_capture(example_captures_folder() / "front_kick.bvh")
MOTION, ACTOR = normalize_capture(KICK)
CONTACTS = detected_contacts(KICK, "kick")
BALL, CHAIN = BodyPoint(BodyPart.RIGHT_FOOT, at_end=True), Chain(clavicle=0.0, root=0.6)
TOP = 154
HOLD = slice(TOP - 6, TOP + 7)
"""Frames in which it is asked in full."""
CURVE = ActivationCurve(*((TOP + step) / MOTION.frame_rate for step in (-24.0, -6.0, 6.0, 24.0)))
STEPS = np.arange(0.02, 0.51, 0.04)
"""Metres by which the target is raised above where the child kicks."""


def _standing(name: str) -> GroundedMotion:
    body = bundled_characters()[name].morphology
    return grounded_motion_of(AdaptRequest(MOTION, body, CONTACTS, actor=ACTOR.morphology))


CHILD = _standing("child")
PLACE = body_point_positions(BALL, solve_constraints(CHILD, ()))[TOP]


def _missed(standing: GroundedMotion, raised: float, eased: bool = True) -> np.ndarray:
    target = (PLACE[0], PLACE[1], PLACE[2] + raised)
    kick = PositionConstraint("kick", "Ball", BALL, CHAIN, 0, CURVE, target=target)
    return solve_constraints(standing, (kick,), HOLD.start, HOLD.stop - 1, eased=eased).residuals[0]


@pytest.mark.parametrize("name", ["adult_woman", "tall_man", "stocky_man", "giant"])
def test_nobody_who_is_taller_fails_before_the_child_or_leaves_the_target_while_holding_it(name: str) -> None:
    """Frame by frame, and where moments between are eased: low targets are too near for long legs."""
    standing = _standing(name)
    for raised in STEPS:  # by then the child has failed by far
        assert _missed(standing, raised, eased=False).max() < 0.001, raised
        assert _missed(standing, raised).max() < 0.02, raised


def test_the_child_is_the_first_who_cannot_reach_it() -> None:
    missed = [_missed(CHILD, raised).max() for raised in STEPS]
    assert missed[0] < 1e-3
    assert missed[-1] > 0.2
    assert np.all(np.diff(missed) > -1e-3)  # what is met is met within less


@pytest.mark.parametrize("height", [0.9, 1.0, 1.2, 1.3])
@pytest.mark.parametrize("name", ["adult_woman", "tall_man", "stocky_man", "giant"])
def test_a_root_that_may_help_a_kick_never_makes_it_miss_by_more(name: str, height: float) -> None:
    """In every frame of the kick, those included in which the foot would have to turn far past its ankle's limit."""
    standing, throughout = _standing(name), ActivationCurve(2.0, 2.2, 2.8, 3.1)
    alone, helped = (
        solve_constraints(
            standing, (PositionConstraint("kick", "Ball", BALL, chain, 0, throughout, target=(1.0, 0.1, height)),)
        ).residuals[0]
        for chain in (Chain(), CHAIN)
    )
    assert np.nanmax(helped - alone) < 0.001
