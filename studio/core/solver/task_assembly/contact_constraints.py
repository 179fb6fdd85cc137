"""Contacts of hands, knees and seat as constraints of a higher priority than all of the user's."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import AnyMorphology, at_frames
from studio.core.captures.contacts import ContactPoint
from studio.core.compact_array import PoseArray
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.kernels import measure_columns as measure
from studio.core.kernels import records
from studio.core.kernels.support.body_settling import place_arms
from studio.core.solver.grounding.body_support import GroundContact, track_of
from studio.core.solver.grounding.contact_blending import release_weight
from studio.core.solver.grounding.contact_settling import ArmStance
from studio.core.solver.grounding.footing import Footing
from studio.core.solver.task_assembly.task_rows import TaskRecords

FloatArray = NDArray[np.float64]

CONTACT_CHAIN = Chain(trunk=1.0, root=1.0)
"""Chain of contacts: trunk and root."""
HAND_CHAIN = Chain(clavicle=0.0, end_segment=1.0)
"""Chain of a hand's orientation in contact: the hand alone."""
CONTACT_ACTIVATION = ActivationCurve(0.0, 0.0, 0.0, 0.0)
"""Activation curve of contacts; their frames are written by ``write_contact_targets``."""


@dataclass(frozen=True, eq=False)
class ContactConstraint:
    """Generated constraint of a contact, and the pose that it keeps."""

    constraint: Constraint
    standing: NDArray[np.bool_]
    """(F,) True in contact."""
    places: FloatArray
    """(F, 3) target positions, metres."""
    turns: FloatArray
    """(F, 3, 3) target rotations."""


def contact_constraints(
    holds: Sequence[GroundContact], footing: Footing, body: AnyMorphology, positions: PoseArray, rotations: PoseArray
) -> list[ContactConstraint]:
    """Constraints that keep all contacts where they are on the grounded body with ``positions`` (F, P, 3) and
    ``rotations``.

    A leg with contacts at knee and foot has one for each: a hip at its limits would rotate the one about the other.
    """
    found = []
    for hold in holds:
        place = track_of(hold.point, body, positions)
        rotation = (
            rotations[:, body.layout.segment_of_part(_part(hold.point, "hand"))]
            if hold.point.member == "hand"
            else None
        )
        rotation_matrices = np.broadcast_to(np.eye(3), (len(place), 3, 3)) if rotation is None else rotation
        point = _body_point(hold.point, body)
        name, standing = f"{hold.point.words} contact", hold.standing
        found.append(
            ContactConstraint(
                PositionConstraint("", name, point, CONTACT_CHAIN, 0, CONTACT_ACTIVATION),
                standing,
                place,
                rotation_matrices,
            )
        )
        if rotation is not None:
            hand = BodyPoint(_part(hold.point, "hand"))
            found.append(
                ContactConstraint(
                    OrientationConstraint("", name, hand, HAND_CHAIN, 0, CONTACT_ACTIVATION),
                    standing,
                    place,
                    rotation_matrices,
                )
            )
        both = standing & (footing.states[hold.point.side] != 0)
        if hold.point.member == "knee" and both.any():
            ankle = BodyPoint(_part(hold.point, "shank"), at_end=True)
            place = positions[:, body.layout.ankle_point(hold.point.side)]
            found.append(
                ContactConstraint(
                    PositionConstraint("", name, ankle, CONTACT_CHAIN, 0, CONTACT_ACTIVATION),
                    both,
                    place,
                    rotation_matrices,
                )
            )
    return found


def _part(point: ContactPoint, bone: str) -> BodyPart:
    """Body part ``bone`` on the side of a contact point."""
    return BodyPart(f"{('left', 'right')[point.side]}_{bone}")


def _body_point(point: ContactPoint, body: AnyMorphology) -> BodyPoint:
    """Point of the body that a contact point holds."""
    if point is ContactPoint.SEAT:
        middle = body.rows[0, measure.HIP_OFFSET : measure.LEG].reshape(2, 3).mean(axis=0)
        return BodyPoint(BodyPart.PELVIS, tuple(middle.tolist()))
    return BodyPoint(_part(point, "forearm" if point.member == "hand" else "thigh"), at_end=True)


def write_contact_targets(rows: TaskRecords, held: Sequence[ContactConstraint], window: slice) -> None:
    """Write the targets of contact constraints in the frames of ``window``; they are the first of the packed tasks."""
    for row, each in enumerate(held):
        rows.positions[row], rows.rotations[row] = each.places[window], each.turns[window]


def release_hands(
    arms: ArmStance,
    holds: Sequence[GroundContact],
    body: AnyMorphology,
    channels: FloatArray,
    frame_rate: float,
    window: slice,
    positions: FloatArray,
    rotations: FloatArray,
) -> None:
    """Blend arms between their constraints and their ground contacts, shortly before a contact and after it.

    ``positions`` (F, P, 3) and ``rotations`` of the window's frames are changed in place.
    """
    layout = body.layout
    wrists, hands = arms.wrists[:, window].copy(), arms.hands[:, window].copy()
    soft_thresholds = np.zeros(wrists.shape[:2])
    for hold in holds:
        if hold.point.member != "hand":
            continue
        side = hold.point.side
        firm = (1.0 - release_weight(hold.standing, frame_rate))[window]
        leaving = (firm > 0.0) & (firm < 1.0)
        soft_thresholds[side, leaving] = arms.soft_thresholds[side, window][leaving]
        own = positions[:, layout.wrist_point(side)]
        wrists[side] = own + firm[:, None] * (wrists[side] - own)
        turned = rotations[:, layout.hand_segment(side)]
        apart = Rotation.from_matrix(hands[side] @ np.swapaxes(turned, 1, 2)).as_rotvec()
        hands[side] = Rotation.from_rotvec(firm[:, None] * apart).as_matrix() @ turned
    bends = np.ascontiguousarray(arms.bends[:, window])
    stance = records.ArmTargets(channels, soft_thresholds, wrists, hands, bends)
    place_arms(at_frames(body.rows, window), stance, positions, rotations)
