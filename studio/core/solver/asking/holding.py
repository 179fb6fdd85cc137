"""Hands, knees and seat that stand, as constraints above all of the user's: these yield to them as to standing feet."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import AnyMorphology, at_frames
from studio.core.captures.contacts import ContactPoint
from studio.core.constraints.activation import ActivationCurve
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.kernels import layout as at
from studio.core.kernels import records
from studio.core.kernels.support.body_settling import place_arms
from studio.core.single import PoseArray
from studio.core.solver.asking.rows import Rows
from studio.core.solver.standing.blends import freedom
from studio.core.solver.standing.carrying import Hold, track_of
from studio.core.solver.standing.footing import Footing
from studio.core.solver.standing.settling import Arms

FloatArray = NDArray[np.float64]

FREE = Chain(trunk=1.0, root=1.0)
TURNED = Chain(clavicle=0.0, end_segment=1.0)
ALWAYS = ActivationCurve(0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class Held:
    """A generated constraint, where it stands (F,), and the places (F, 3) and turns (F, 3, 3) that it keeps."""

    constraint: Constraint
    standing: NDArray[np.bool_]
    places: FloatArray
    turns: FloatArray


def held_points(
    holds: Sequence[Hold], footing: Footing, body: AnyMorphology, positions: PoseArray, rotations: PoseArray
) -> list[Held]:
    """What keeps all that stands where a body on the ground has it, ``positions`` (F, P, 3), ``rotations``.

    A leg that stands on its knee and its foot keeps both: a hip at its limits would turn the one about the other.
    """
    found = []
    for hold in holds:
        place = track_of(hold.point, body, positions)
        turn = rotations[:, body.layout.segment(_part(hold.point, "hand"))] if hold.point.member == "hand" else None
        turns = np.broadcast_to(np.eye(3), (len(place), 3, 3)) if turn is None else turn
        point = _body_point(hold.point, body)
        name, standing = f"{hold.point.words} contact", hold.standing
        found.append(Held(PositionConstraint("", name, point, FREE, 0, ALWAYS), standing, place, turns))
        if turn is not None:
            hand = BodyPoint(_part(hold.point, "hand"))
            found.append(Held(OrientationConstraint("", name, hand, TURNED, 0, ALWAYS), standing, place, turns))
        both = standing & (footing.states[hold.point.side] != 0)
        if hold.point.member == "knee" and both.any():
            ankle = BodyPoint(_part(hold.point, "shank"), at_end=True)
            place = positions[:, body.layout.ankle(hold.point.side)]
            found.append(Held(PositionConstraint("", name, ankle, FREE, 0, ALWAYS), both, place, turns))
    return found


def _part(point: ContactPoint, bone: str) -> BodyPart:
    return BodyPart(f"{('left', 'right')[point.side]}_{bone}")


def _body_point(point: ContactPoint, body: AnyMorphology) -> BodyPoint:
    if point is ContactPoint.SEAT:
        middle = body.rows[0, at.M_HIP_OFFSET : at.M_LEG].reshape(2, 3).mean(axis=0)
        return BodyPoint(BodyPart.PELVIS, tuple(middle.tolist()))
    return BodyPoint(_part(point, "forearm" if point.member == "hand" else "thigh"), at_end=True)


def place_held(rows: Rows, held: Sequence[Held], window: slice) -> None:
    """Give the first of packed constraints, those of ``held``, their target at every frame.

    ``window`` are the frames of the answer.
    """
    for row, each in enumerate(held):
        rows.places[row], rows.turns[row] = each.places[window], each.turns[window]


def release_hands(
    arms: Arms,
    holds: Sequence[Hold],
    body: AnyMorphology,
    channels: FloatArray,
    frame_rate: float,
    window: slice,
    positions: FloatArray,
    rotations: FloatArray,
) -> None:
    """Arms that are about to stand, or have just stood, between where constraints put them and where they would stand.

    ``positions`` (F, P, 3) and ``rotations`` of the window's frames, in place.
    """
    layout = body.layout
    wrists, hands = arms.wrists[:, window].copy(), arms.hands[:, window].copy()
    soft_thresholds = np.zeros(wrists.shape[:2])
    for hold in holds:
        if hold.point.member != "hand":
            continue
        side = hold.point.side
        firm = (1.0 - freedom(hold.standing, frame_rate))[window]
        leaving = (firm > 0.0) & (firm < 1.0)
        soft_thresholds[side, leaving] = arms.soft_thresholds[side, window][leaving]
        own = positions[:, layout.wrist(side)]
        wrists[side] = own + firm[:, None] * (wrists[side] - own)
        turned = rotations[:, layout.spine_count + 5 + 4 * side]
        apart = Rotation.from_matrix(hands[side] @ np.swapaxes(turned, 1, 2)).as_rotvec()
        hands[side] = Rotation.from_rotvec(firm[:, None] * apart).as_matrix() @ turned
    bends = np.ascontiguousarray(arms.bends[:, window])
    stance = records.ArmTargets(channels, soft_thresholds, wrists, hands, bends)
    place_arms(at_frames(body.rows, window), stance, positions, rotations)
