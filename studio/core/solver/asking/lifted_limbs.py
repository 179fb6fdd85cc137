"""Arms and legs that constraints take into the ground are raised out of it (METHOD 7).

Feet and hands first rotate out of it (``lifted_ends``); what is left raises the whole limb, which swings and bends in
its plane. Then elbow and knee turn out of the ground about the line from the limb's root to its end, so that targets
of wrist and ankle are still met. The trunk stays, as raising it would move what constraints of higher priority hold.
Frames are independent of each other.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import at_frames, sole_rows
from studio.core.captures.contacts import BODY_POINTS
from studio.core.compact_array import PoseArray
from studio.core.rotations import normalized
from studio.core.solver.asking.lifted_ends import END_MARGIN, may_rise, risen
from studio.core.solver.standing.blends import smooth_penetrations, smoothstep_array
from studio.core.solver.standing.body_support import limb_freedom, raise_by_swinging
from studio.core.solver.standing.held_foot import FootPath
from studio.core.solver.standing.limb_moves import TwoBoneLimb, across
from studio.core.solver.standing.stand import Standing
from studio.core.solver.standing.tipping import heights_of

FloatArray = NDArray[np.float64]

LIMB_TOLERANCE = 0.004
"""Depth in metres that is left to a limb: a foot that has rotated out of the ground keeps its ankle where that is."""
HARD_MARGIN = 1e-6
"""Margin in metres of a limb with a fully active constraint: its targets near the ground are met."""
SLOPE_ROUNDS = 3
"""Iterations over ground that is not level: a limb that swings comes over other ground."""
LEAST_CIRCLE = 0.005
"""Rise in metres of elbow or knee on its circle at which its turn is halved: a lower one would whirl."""


class _PosedBody(NamedTuple):
    """Frames of a ``window``, (F, P, 3) and (F, S, 3, 3)."""

    standing: Standing
    window: slice
    positions: PoseArray
    rotations: PoseArray


def lift_limbs(
    standing: Standing, window: slice, held: FloatArray, positions: FloatArray, rotations: FloatArray
) -> None:
    """Raise arms and legs of solved frames of a ``window``, (F, P, 3) and (F, S, 3, 3), in place, until no part of them
    is lower than before the constraints, or below the ground.

    ``held`` (4, F) are the activations of constraints on each limb: the less a limb is held, the sooner it rises.
    """
    before = _PosedBody(standing, window, standing.positions[window], standing.rotations[window])
    solved, rounds = _PosedBody(standing, window, positions, rotations), 1 if standing.ground.is_level else SLOPE_ROUNDS
    for number in range(4):
        margins = _margins(held[number])
        for move in (_raise_end, _raise_middle):
            for _ in range(rounds):
                if not move(number, margins, before, solved):
                    break


def _raise_end(number: int, margins: FloatArray, before: _PosedBody, solved: _PosedBody) -> bool:
    """Raise the end of a limb with hand or foot, in place; True if it rises in any frame."""
    heights, limb = _end_heights(number, solved), TwoBoneLimb.of(number, solved.standing.morphology.layout)
    if not may_rise(heights):
        return False
    rises = _rises(heights, _end_heights(number, before), margins).max(axis=0)
    rises = rises * _contact_freedom(number, solved)
    frames = np.flatnonzero(rises)
    if len(frames):
        posed = solved.positions[frames], solved.rotations[frames]
        goals = raise_by_swinging(posed[0][:, limb.root + 2], posed[0][:, limb.root], rises[frames])
        limb.move_end(goals, rises[frames], *posed)
        solved.positions[frames], solved.rotations[frames] = posed
    return len(frames) > 0


def _contact_freedom(limb: int, posed: _PosedBody) -> FloatArray:
    """Release weights (F,) of a limb from contacts of hand or knee, which stay where they stand; feet in contact are
    on the ground already.
    """
    contacts, motion = posed.standing.contacts, posed.standing.motion
    held = [each for each in contacts if each.point in BODY_POINTS]
    return limb_freedom(held, limb, motion.frame_count, motion.frame_rate)[posed.window]


def _raise_middle(number: int, _: FloatArray, before: _PosedBody, solved: _PosedBody) -> bool:
    """Raise elbow or knee, in place; True if it rises in any frame."""
    limb = TwoBoneLimb.of(number, solved.standing.morphology.layout)
    heights, own = (_heights(each.standing, each.positions[:, limb.root + 1]) for each in (solved, before))
    if not may_rise(heights):
        return False
    rises = _rises(heights, own, np.full(len(own), END_MARGIN))
    frames = np.flatnonzero(rises)
    if len(frames):
        posed = solved.positions[frames], solved.rotations[frames]
        limb.turn(_turns(limb, rises[frames], posed[0]), *posed)
        solved.positions[frames], solved.rotations[frames] = posed
    return len(frames) > 0


def _margins(held: FloatArray) -> FloatArray:
    """Heights (F,) in metres of a limb above the ground below which it begins to rise."""
    return np.asarray(HARD_MARGIN + (END_MARGIN - HARD_MARGIN) * smoothstep_array(1.0 - held))


def _end_heights(limb: int, posed: _PosedBody) -> FloatArray:
    """Heights (2 or 3, F) in metres above the ground of wrist and finger tips, or of ankle, heel and toes."""
    standing, window, positions, rotations = posed
    layout = standing.morphology.layout
    if limb < 2:
        wrist = layout.wrist(limb)
        return np.stack([_heights(standing, positions[:, point]) for point in (wrist, wrist + 1)])
    foot = layout.foot(limb - 2)
    path = FootPath(positions[:, layout.ankle(limb - 2)], rotations[:, foot], rotations[:, foot + 1])
    sole = heights_of(path, at_frames(sole_rows(standing.morphology, limb - 2), window), standing.ground)
    return np.stack([_heights(standing, path.ankles), *sole])


def _heights(standing: Standing, points: FloatArray) -> FloatArray:
    """Heights (F, ...) in metres of points (F, ..., 3) above the ground."""
    return np.asarray(points[..., 2] - standing.ground.height_at(points))


def _rises(heights: FloatArray, before: FloatArray, margins: FloatArray) -> FloatArray:
    """Metres (..., F) by which points at ``heights`` rise, which were as high as ``before`` without constraints."""
    least = np.minimum(before, 0.0) - LIMB_TOLERANCE
    return risen(smooth_penetrations(heights - least, np.minimum(before - least, margins)))


def _turns(limb: TwoBoneLimb, rises: FloatArray, positions: FloatArray) -> FloatArray:
    """Rotation vectors (F, 3) about the line from root to end that raise elbow or knee by ``rises`` (F,), as far as
    its circle does.
    """
    roots = positions[:, limb.root]
    line = normalized(positions[:, limb.root + 2] - roots)
    arm = across(positions[:, limb.root + 1] - roots, line)
    height, aside = arm[:, 2], np.cross(line, arm)[:, 2]
    most = np.maximum(np.hypot(height, aside), 1e-9)
    phase, goal = np.arctan2(aside, height), np.arccos(np.clip((height + rises) / most, -1.0, 1.0))
    weight = most**2 / (most**2 + LEAST_CIRCLE**2)
    return np.asarray((weight * np.sign(phase) * np.maximum(np.abs(phase) - goal, 0.0))[:, None] * line)
