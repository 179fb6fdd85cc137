"""Arms kept above the ground: on bodies with longer ones hands and elbows would sink into it (METHOD 4)."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from studio.core.body.joint_limits import WRIST
from studio.core.body.morphology import AnyMorphology
from studio.core.grounds.ground import Ground
from studio.core.kernels.limbs.limb import MAX_EXTENSION
from studio.core.kernels.support.heel_roll import LEAST_ROLL_GAIN
from studio.core.rotations import normalized, shortest_arc
from studio.core.solver.standing.blends import LET_GO, SLOWLY_LET_GO, freedom, lacking, smooth_drops, smoothstep
from studio.core.solver.standing.carrying import swung
from studio.core.solver.standing.settling import Arms

FloatArray = NDArray[np.float64]

ROOM = 0.03
"""Parts of the leg's length above the ground below which wrist and finger tips begin to be raised; 3/16 is kept."""
SLIGHT = 0.02
"""Metres of an elbow from the line between shoulder and wrist up to which it bends as its hinge has it, and at which it
is turned by half: a straight arm has no bend of its own.
"""
OUTWARDS = 2.0
"""How much more an elbow goes away from the body the deeper it is in the ground."""
TURNS = 3
"""Times that the arm of a hand that stands is turned, for on its circle an elbow is lower than on its way out."""


class _Posed(NamedTuple):
    """A body whose ``positions`` (F, P, 3) and ``rotations`` (F, S, 3, 3) are put right in place."""

    body: AnyMorphology
    ground: Ground
    frame_rate: float
    positions: FloatArray
    rotations: FloatArray


def raise_arms(
    body: AnyMorphology,
    ground: Ground,
    arms: Arms | None,
    frame_rate: float,
    positions: FloatArray,
    rotations: FloatArray,
) -> None:
    """Raise hands and elbows of a standing body, (F, P, 3) and (F, S, 3, 3), in place, that would be in level ground.

    Hands bend back first, then arms raise them as they lie in the world; those that stand, as ``arms`` tells, stay
    where they are.
    """
    if not ground.is_level:
        return
    posed = _Posed(body, ground, frame_rate, positions, rotations)
    for side in range(2):
        stands = np.zeros(len(positions), dtype=np.bool_) if arms is None else arms.standing[side]
        free, slowly_free = (freedom(stands, frame_rate, seconds) for seconds in (LET_GO, SLOWLY_LET_GO))
        _bend_hand(side, slowly_free, posed)
        _raise_hand(side, free, posed)
        _raise_elbow(side, free, posed)


def _angles(line: FloatArray, now: FloatArray, then: FloatArray) -> FloatArray:
    """(F,) radians about unit vectors ``line`` from ``now`` to ``then``, all (F, 3), both across it."""
    return np.asarray(np.arctan2(np.sum(np.cross(now, then) * line, axis=1), np.sum(now * then, axis=1)))


def _outright(now: FloatArray) -> FloatArray:
    """(F,) the part of its turn that an elbow takes that is off its arm's line by ``now`` (F, 3)."""
    wide = np.sum(now**2, axis=1)
    return np.asarray(wide / (wide + SLIGHT**2))


def _turn_arm(side: int, body: AnyMorphology, turns: FloatArray, positions: FloatArray, rotations: FloatArray) -> None:
    """Turn an arm by ``turns`` (F, 3) about the line from its shoulder to its wrist, in place; the hand stays."""
    wrist, arm = body.layout.wrist(side), body.layout.spine_count + 3 + 4 * side
    turned, upper = Rotation.from_rotvec(turns).as_matrix(), positions[:, wrist - 1] - positions[:, wrist - 2]
    positions[:, wrist - 1] += np.einsum("fij,fj->fi", turned, upper) - upper
    rotations[:, arm : arm + 2] = turned[:, None] @ rotations[:, arm : arm + 2]


def _bend_hand(side: int, free: FloatArray, posed: _Posed) -> None:
    """Bend a hand back at the wrist, in place, as far as it is ``free`` (F,), until its fingers are not in the ground,
    but no farther than level: people bend the wrist before the elbow. A hand whose back looks down would not rise so.
    """
    body, ground, frame_rate, positions, rotations = posed
    wrist, hand, room = body.layout.wrist(side), body.layout.spine_count + 5 + 4 * side, ROOM * body.leg_length
    heights = _above(ground, positions[:, wrist + 1])
    if heights.min() >= room:
        return
    fingers, back = positions[:, wrist + 1] - positions[:, wrist], rotations[:, hand] @ [2.0 * side - 1.0, 0.0, 0.0]
    lengths = np.maximum(np.linalg.norm(fingers, axis=1), 1e-9)
    ahead, forearm = fingers / lengths[:, None], normalized(positions[:, wrist] - positions[:, wrist - 1])
    back = normalized(_across(back, ahead))
    own = np.arctan2(-np.sum(forearm * back, axis=1), np.sum(forearm * ahead, axis=1))
    most = np.maximum(np.minimum(np.radians(WRIST.radii[0]) - own, np.arctan2(-ahead[:, 2], back[:, 2])), 1e-3)
    rises = smooth_drops(lacking(heights, room), frame_rate) / lengths
    bends = most * np.tanh(rises / np.maximum(back[:, 2], LEAST_ROLL_GAIN) / most)
    bends *= free * smoothstep(np.clip(1.0 + 2.0 * back[:, 2], 0.0, 1.0))
    bent = np.flatnonzero(bends > 0.0)
    turns = Rotation.from_rotvec(bends[bent, None] * np.cross(ahead, back)[bent]).as_matrix()
    rotations[bent, hand] = turns @ rotations[bent, hand]
    positions[bent, wrist + 1] = positions[bent, wrist] + np.einsum("fij,fj->fi", turns, fingers[bent])


def _raise_hand(side: int, free: FloatArray, posed: _Posed) -> None:
    """Raise a hand, in place, as far as it is ``free`` (F,); its arm bends and swings as it already did."""
    body, ground, frame_rate, positions, rotations = posed
    wrist, room = body.layout.wrist(side), ROOM * body.leg_length
    heights = _above(ground, positions[:, wrist : wrist + 2]).min(axis=1)
    if heights.min() >= room:
        return
    raises = free * smooth_drops(lacking(heights, room), frame_rate)
    shoulders, wrists = positions[:, wrist - 2], positions[:, wrist]
    goals = swung(wrists, shoulders, raises)
    arm = body.layout.spine_count + 3 + 4 * side
    upper, lower = positions[:, wrist - 1] - shoulders, wrists - positions[:, wrist - 1]
    lengths = np.linalg.norm([upper, lower], axis=2)
    line, way = normalized(wrists - shoulders), normalized(goals - shoulders)
    span = np.linalg.norm(goals - shoulders, axis=1)
    span = np.clip(span, np.abs(lengths[0] - lengths[1]) + 1e-3, MAX_EXTENSION * lengths.sum(axis=0))
    hinge = np.minimum(raises, SLIGHT)[:, None] * np.cross(line, rotations[:, arm, :, 0])
    aim = shortest_arc(line, way)
    out = normalized(_across(np.einsum("fij,fj->fi", aim, _across(upper, line) + hinge), way))
    along = (lengths[0] ** 2 - lengths[1] ** 2 + span**2) / (2.0 * span)
    aside = np.sqrt(np.maximum(lengths[0] ** 2 - along**2, 0.0))
    elbows = shoulders + along[:, None] * way + aside[:, None] * out
    placed = shoulders + span[:, None] * way
    raised = np.flatnonzero(raises > 0.0)
    for segment, old, new in ((arm, upper, elbows - shoulders), (arm + 1, lower, placed - elbows)):
        aimed = normalized(np.einsum("fij,fj->fi", aim, old))
        turns = shortest_arc(aimed, normalized(new)) @ aim
        rotations[raised, segment] = turns[raised] @ rotations[raised, segment]
    positions[raised, wrist + 1] += (placed - wrists)[raised]
    positions[raised, wrist - 1], positions[raised, wrist] = elbows[raised], placed[raised]


def _above(ground: Ground, places: FloatArray) -> FloatArray:
    """(...) metres of ``places`` (..., 3) above the ground."""
    return np.asarray(places[..., 2] - ground.height_at(places))


def _raise_elbow(side: int, free: FloatArray, posed: _Posed) -> None:
    """Bring an elbow out of the ground, in place: the upper arm swings out, forearm and hand go along as far as the
    hand is ``free`` (F,); one that stands stays, and the arm turns about the line from shoulder to wrist.
    """
    body, ground, _, positions, rotations = posed
    layout = body.layout
    wrist, arm = layout.wrist(side), layout.spine_count + 3 + 4 * side
    if _above(ground, positions[:, wrist - 1]).min() >= 0.0:
        return
    shoulders = positions[:, wrist - 2]
    out = normalized((shoulders - positions[:, layout.wrist(1 - side) - 2]) * [1.0, 1.0, 0.0])
    ways = _ways_out(positions[:, wrist - 1], shoulders, out, ground)
    upper = positions[:, wrist - 1] - shoulders
    swings = normalized(upper + free[:, None] * ways)
    rotations[:, arm] = shortest_arc(normalized(upper), swings) @ rotations[:, arm]
    positions[:, wrist - 1 : wrist + 2] += (swings * np.linalg.norm(upper, axis=1)[:, None] - upper)[:, None]
    line = normalized(positions[:, wrist] - shoulders)
    for _ in range(TURNS):
        elbows = positions[:, wrist - 1]
        now, then = (
            _across(each - shoulders, line) for each in (elbows, elbows + _ways_out(elbows, shoulders, out, ground))
        )
        turns = (_angles(line, now, then) * _outright(now))[:, None] * line
        _turn_arm(side, body, turns, positions, rotations)


def _across(ways: FloatArray, line: FloatArray) -> FloatArray:
    """What of ``ways`` (F, 3) is across unit vectors ``line`` (F, 3)."""
    return np.asarray(ways - np.sum(ways * line, axis=1, keepdims=True) * line)


def _ways_out(elbows: FloatArray, shoulders: FloatArray, out: FloatArray, ground: Ground) -> FloatArray:
    """(F, 3) the ways of ``elbows`` out of the ground, about their ``shoulders``, all (F, 3): away from where they
    hang, and the deeper they are, the more ``out`` from the body.
    """
    upper = elbows - shoulders
    lengths = np.maximum(np.linalg.norm(upper, axis=1), 1e-9)
    down = -upper[:, 2] / lengths
    deep = np.minimum(np.maximum(-_above(ground, elbows), 0.0) / lengths, down + 1.0)
    level = normalized(upper[:, :2] / lengths[:, None] + OUTWARDS * deep[:, None] * out[:, :2])
    level *= np.sqrt(np.maximum(1.0 - (down - deep) ** 2, 0.0))[:, None]
    ways = lengths[:, None] * np.column_stack([level, deep - down]) - upper
    return np.where(deep[:, None] > 0.0, ways, 0.0)
