"""Arms raised above the ground: hands and elbows of arms longer than the actor's would be below it (METHOD 6)."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from studio.core.body.joint_limits import WRIST_RANGE
from studio.core.body.morphology import AnyMorphology
from studio.core.grounds.ground import Ground
from studio.core.kernels.support.heel_roll import LEAST_ROLL_GAIN
from studio.core.rotations import normalized, shortest_arc
from studio.core.solver.grounding.body_support import raise_by_swinging
from studio.core.solver.grounding.contact_blending import (
    RELEASE_SECONDS,
    SLOW_RELEASE_SECONDS,
    release_weight,
    smooth_drops,
    smooth_penetrations,
    smoothstep_array,
)
from studio.core.solver.grounding.contact_settling import ArmStance
from studio.core.solver.grounding.limb_moves import STRAIGHT_LIMB_OFFSET, TwoBoneLimb, across

FloatArray = NDArray[np.float64]

ARM_CLEARANCE = 0.03
"""Height above the ground, in leg lengths, below which wrist and finger tips begin to rise; at ground height they are
raised by 3/16 of this.
"""
ELBOW_OUTWARD_FACTOR = 2.0
"""Outward component of an elbow's displacement per unit of its depth, both in upper arm lengths."""
ELBOW_ROTATIONS = 3
"""Iterations of the rotation of an arm in contact: on its circle an elbow is lower than on its way out."""


class _PosedBody(NamedTuple):
    """A posed body over its ground, whose ``positions`` (F, P, 3) and ``rotations`` (F, S, 3, 3) are corrected in
    place.
    """

    body: AnyMorphology
    ground: Ground
    frame_rate: float
    positions: FloatArray
    rotations: FloatArray


def raise_arms(
    body: AnyMorphology,
    ground: Ground,
    arms: ArmStance | None,
    frame_rate: float,
    positions: FloatArray,
    rotations: FloatArray,
) -> None:
    """Raise hands and elbows of a grounded body, (F, P, 3) and (F, S, 3, 3), out of level ground, in place.

    Hands bend back first; then arms raise them, with their world orientation. Hands in contact (``arms``) stay.
    """
    if not ground.is_level:
        return
    posed = _PosedBody(body, ground, frame_rate, positions, rotations)
    for side in range(2):
        stands = np.zeros(len(positions), dtype=np.bool_) if arms is None else arms.standing[side]
        free, slowly_free = (
            release_weight(stands, frame_rate, seconds) for seconds in (RELEASE_SECONDS, SLOW_RELEASE_SECONDS)
        )
        _bend_hand(side, slowly_free, posed)
        _raise_hand(side, free, posed)
        _raise_elbow(side, free, posed)


def _angles(line: FloatArray, now: FloatArray, then: FloatArray) -> FloatArray:
    """Angles (F,) in radians about unit vectors ``line`` from ``now`` to ``then``, all (F, 3), both perpendicular to
    ``line``.
    """
    return np.asarray(np.arctan2(np.sum(np.cross(now, then) * line, axis=1), np.sum(now * then, axis=1)))


def _outright(now: FloatArray) -> FloatArray:
    """Fraction (F,) by which an arm is rotated about its line, for an elbow at ``now`` (F, 3) from that line; small
    near it.
    """
    wide = np.sum(now**2, axis=1)
    return np.asarray(wide / (wide + STRAIGHT_LIMB_OFFSET**2))


def _bend_hand(side: int, free: FloatArray, posed: _PosedBody) -> None:
    """Bend a hand back at the wrist, in place, by its weight ``free`` (F,), until its fingers are above the ground.

    It bends at most until it is level: people bend the wrist before the elbow. A hand whose back is down would not
    rise.
    """
    body, ground, frame_rate, positions, rotations = posed
    wrist, hand, margin = (
        body.layout.wrist_point(side),
        body.layout.hand_segment(side),
        ARM_CLEARANCE * body.leg_length,
    )
    heights = _above(ground, positions[:, wrist + 1])
    if heights.min() >= margin:
        return
    fingers, back = positions[:, wrist + 1] - positions[:, wrist], rotations[:, hand] @ [2.0 * side - 1.0, 0.0, 0.0]
    lengths = np.maximum(np.linalg.norm(fingers, axis=1), 1e-9)
    ahead, forearm = fingers / lengths[:, None], normalized(positions[:, wrist] - positions[:, wrist - 1])
    back = normalized(across(back, ahead))
    own = np.arctan2(-np.sum(forearm * back, axis=1), np.sum(forearm * ahead, axis=1))
    most = np.maximum(np.minimum(np.radians(WRIST_RANGE.radii[0]) - own, np.arctan2(-ahead[:, 2], back[:, 2])), 1e-3)
    rises = smooth_drops(smooth_penetrations(heights, margin), frame_rate) / lengths
    bends = most * np.tanh(rises / np.maximum(back[:, 2], LEAST_ROLL_GAIN) / most)
    bends *= free * smoothstep_array(np.clip(1.0 + 2.0 * back[:, 2], 0.0, 1.0))
    bent = np.flatnonzero(bends > 0.0)
    rotation_matrices = Rotation.from_rotvec(bends[bent, None] * np.cross(ahead, back)[bent]).as_matrix()
    rotations[bent, hand] = rotation_matrices @ rotations[bent, hand]
    positions[bent, wrist + 1] = positions[bent, wrist] + np.einsum("fij,fj->fi", rotation_matrices, fingers[bent])


def _raise_hand(side: int, free: FloatArray, posed: _PosedBody) -> None:
    """Raise a hand out of the ground, in place, by its weight ``free`` (F,); its arm bends and swings in its plane."""
    body, ground, frame_rate, positions, rotations = posed
    wrist, margin = body.layout.wrist_point(side), ARM_CLEARANCE * body.leg_length
    heights = _above(ground, positions[:, wrist : wrist + 2]).min(axis=1)
    if heights.min() >= margin:
        return
    raises = free * smooth_drops(smooth_penetrations(heights, margin), frame_rate)
    shoulders, wrists = positions[:, wrist - 2], positions[:, wrist]
    raised = np.flatnonzero(raises > 0.0)
    goals, moved = raise_by_swinging(wrists, shoulders, raises), (positions[raised], rotations[raised])
    TwoBoneLimb.of(side, body.layout).move_end(goals[raised], raises[raised], *moved)
    positions[raised], rotations[raised] = moved


def _above(ground: Ground, positions: FloatArray) -> FloatArray:
    """Heights (...) in metres of ``positions`` (..., 3) above the ground."""
    return np.asarray(positions[..., 2] - ground.height_at(positions))


def _raise_elbow(side: int, free: FloatArray, posed: _PosedBody) -> None:
    """Move an elbow out of the ground, in place.

    The upper arm swings out; forearm and hand move along by their weight ``free`` (F,). With a hand in contact the arm
    rotates about the line from shoulder to wrist.
    """
    body, ground, _, positions, rotations = posed
    layout = body.layout
    wrist, arm = layout.wrist_point(side), layout.upper_arm_segment(side)
    if _above(ground, positions[:, wrist - 1]).min() >= 0.0:
        return
    shoulders = positions[:, wrist - 2]
    out = normalized((shoulders - positions[:, layout.wrist_point(1 - side) - 2]) * [1.0, 1.0, 0.0])
    displacements = _displacements_out(positions[:, wrist - 1], shoulders, out, ground)
    upper = positions[:, wrist - 1] - shoulders
    swings = normalized(upper + free[:, None] * displacements)
    rotations[:, arm] = shortest_arc(normalized(upper), swings) @ rotations[:, arm]
    positions[:, wrist - 1 : wrist + 2] += (swings * np.linalg.norm(upper, axis=1)[:, None] - upper)[:, None]
    line = normalized(positions[:, wrist] - shoulders)
    for _ in range(ELBOW_ROTATIONS):
        elbows = positions[:, wrist - 1]
        now, then = (
            across(each - shoulders, line)
            for each in (elbows, elbows + _displacements_out(elbows, shoulders, out, ground))
        )
        rotation_matrices = (_angles(line, now, then) * _outright(now))[:, None] * line
        TwoBoneLimb.of(side, layout).turn(rotation_matrices, positions, rotations)


def _displacements_out(elbows: FloatArray, shoulders: FloatArray, out: FloatArray, ground: Ground) -> FloatArray:
    """Displacements (F, 3) in metres of ``elbows`` out of the ground, about their ``shoulders``, both (F, 3).

    They lead away from the elbow's hanging position and, increasingly with depth, along ``out`` (F, 3), away from the
    body.
    """
    upper = elbows - shoulders
    lengths = np.maximum(np.linalg.norm(upper, axis=1), 1e-9)
    down = -upper[:, 2] / lengths
    deep = np.minimum(np.maximum(-_above(ground, elbows), 0.0) / lengths, down + 1.0)
    level = normalized(upper[:, :2] / lengths[:, None] + ELBOW_OUTWARD_FACTOR * deep[:, None] * out[:, :2])
    level *= np.sqrt(np.maximum(1.0 - (down - deep) ** 2, 0.0))[:, None]
    displacements = lengths[:, None] * np.column_stack([level, deep - down]) - upper
    return np.where(deep[:, None] > 0.0, displacements, 0.0)
