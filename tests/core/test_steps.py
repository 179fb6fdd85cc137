"""A foot in the air where the next clip takes over is lifted over to where it lands."""

from functools import cache
from typing import NamedTuple

import numpy as np
import pytest

from studio.core.body.morphology import Morphology, sole_rows
from studio.core.captures.contacts import ContactInterval
from studio.core.grounds.ground import Ground
from studio.core.normalized.compose import Composite, compose_pieces
from studio.core.normalized.normalize import capture_contacts, normalize_capture
from studio.core.normalized.pieces import MotionPiece
from studio.core.quality.metrics import contact_quality
from studio.core.runs import runs_of
from studio.core.solver.adapt import solve_constraints
from studio.core.solver.standing.stand import GroundedMotion, stand
from studio.core.solver.standing.swing_foot_path import Sole
from studio.io.importing import load_capture
from tests.captures import capture_file, outside
from tests.core.test_compose import BODY, cut
from tests.core.test_transitions import picked

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
    stands = stand(row.motion, known[0], row.contacts, known[1])
    alone = [stand(each.motion, known[0], each.contacts, known[1]) for each in pieces]
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
    adapted = solve_constraints(stand(row.motion, body, row.contacts, Ground()), ())
    assert contact_quality(adapted, adapted.contacts, Ground()).slide < 2e-3
    assert found.skate < SKATE
    assert found.lift > LIFT
