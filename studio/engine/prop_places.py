"""Positions of props at a stage time, and edits that move them or attach them to performers."""

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint, Vector
from studio.core.constraints.procedural import ProceduralPlace
from studio.core.curves.keyed import KeyedNumber, KeyedPlace, KeyedTurn
from studio.core.grounds.ground import Ground
from studio.core.rotations import from_euler, from_matrix, multiply, to_matrix
from studio.core.solver.performers.rows import timing_of
from studio.core.stage.project import Project
from studio.core.stage.prop import Carried, InHand, Prop, quarter_turns
from studio.engine.grasps import chest_heading
from studio.engine.posed_performer import PosedPerformer

FloatArray = NDArray[np.float64]

HANDS = (BodyPart.LEFT_HAND, BodyPart.RIGHT_HAND)
HELD_GAP_METRES = 0.3
"""Distance in metres from a body point to the surface of a prop up to which an attached prop stays where it is."""
CARRIED_AHEAD_LEGS, CARRIED_HEIGHT_LEGS = 0.28, 0.2
"""Minimum distance in leg lengths from the root forward to a carried prop, and from the root up to its centre."""

REST_GAP_METRES = 0.01
"""Maximum gap in metres between the ground and a prop that rests on it."""


@dataclass(frozen=True, eq=False)
class PropPose:
    """Prop with its centre at ``place`` (3,) on the stage and its axes as columns of ``axes`` (3, 3), at ``time`` in
    seconds.
    """

    prop: Prop
    place: FloatArray
    axes: FloatArray
    time: float = 0.0
    leg_length: float = 1.0
    """Leg length in metres of the performer that carries the prop."""


def prop_at(project: Project, posed: Mapping[str, PosedPerformer], prop_id: str, time: float) -> PropPose:
    """Pose of a prop at a stage time in seconds; ``posed`` are all performers at that time."""
    from studio.core.solver.performers.prop_tracks import (  # not before it is needed: it loads kernels
        Holder,
        stage_track,
    )

    prop = project.props[prop_id]
    hands = {}
    for key in prop.holders & posed.keys():
        pose = posed[key]
        clips = pose.performer.clips
        known = bool(clips) and all(clip.motion_id in project.motions for clip in clips)  # it is posed as it was
        timing = timing_of(project, pose.performer) if known else None
        hands[key] = Holder(pose.motion, [pose.row], pose.placement, pose.over_time, timing)
    track, hold = stage_track(prop, [time], hands), prop.held_at(time)
    holder = posed.get(hold.performer_id) if hold else None
    leg = holder.motion.body.leg_length if holder else 1.0
    return PropPose(prop, track.positions[0], track.rotations[0], time, leg)


def props_at(project: Project, posed: Mapping[str, PosedPerformer], time: float) -> dict[str, PropPose]:
    """Poses of all props at a stage time in seconds, by id."""
    return {key: prop_at(project, posed, key, time) for key in project.props}


def moved_prop(pose: PropPose, position: FloatArray) -> Prop:
    """Prop with its centre moved to ``position`` (3,) at the time of ``pose``: by a key, another centre, or another
    offset in the hands.

    At the moment of its pick-up, the position before the pick-up is moved.
    """
    prop, way = pose.prop, position - pose.place
    match None if prop.lies_at(pose.time) else prop.held_at(pose.time):
        case InHand() as held:
            x, y, z = (np.array(held.point.offset) + to_matrix(np.array(held.turn)) @ pose.axes.T @ way).tolist()
            return prop.with_hold(held, replace(held, point=replace(held.point, offset=(x, y, z))))
        case Carried() as carried:
            x, y, z = (np.array(carried.offset) + pose.axes.T @ way / pose.leg_length).tolist()
            return prop.with_hold(carried, replace(carried, offset=(x, y, z)))
    x, y, z = position.tolist()
    if isinstance(prop.position, KeyedPlace):
        return replace(prop, position=prop.position.with_key(pose.time, (x, y, z)))
    if isinstance(prop.position, ProceduralPlace):
        return replace(prop, position=prop.position.passing((x, y, z), pose.time))
    return replace(prop, position=(x, y, z))


def resized_prop(pose: PropPose, size: Vector, ground: Ground) -> Prop:
    """Prop with another size in metres: one that rests on the ground still does, any other keeps its centre."""
    prop, extent = replace(pose.prop, size=size), np.abs(pose.axes[2]) / 2.0
    gap = float(pose.place[2] - extent @ np.array(pose.prop.size) - ground.height_at(pose.place))
    rise = float(extent @ (np.array(size) - np.array(pose.prop.size)))
    return raised_prop(prop, rise) if prop.lies_at(pose.time) and abs(gap) < REST_GAP_METRES else prop


def raised_prop(prop: Prop, rise: float) -> Prop:
    """Prop whose own position, with all keys, is ``rise`` metres higher."""
    position = prop.position
    if isinstance(position, KeyedPlace):
        values = tuple((x, y, z + rise) for x, y, z in position.values)
        return replace(prop, position=replace(position, values=values))
    if isinstance(position, ProceduralPlace):
        x, y, z = position.centre
        return replace(prop, position=replace(position, centre=(x, y, z + rise)))
    x, y, z = position
    return replace(prop, position=(x, y, z + rise))


def turned_prop(pose: PropPose, rotation: FloatArray) -> Prop:
    """Prop rotated about its centre by ``rotation`` (3, 3), stage space.

    A rotation about Z changes the heading, so that a keyed heading may exceed a full turn; any other rotation changes
    the tilt.
    """
    prop, level = pose.prop, is_about_z(rotation)
    angle = math.atan2(rotation[1, 0], rotation[0, 0])
    held = None if prop.lies_at(pose.time) else prop.held_at(pose.time)
    if isinstance(held, InHand):
        turn = multiply(np.array(held.turn), from_matrix(pose.axes.T @ rotation @ pose.axes))
        return prop.with_hold(held, replace(held, turn=tuple(turn.tolist())))
    headed = pose.axes @ tilt_of(pose).T
    x, y, z, w = from_matrix(headed.T @ rotation @ pose.axes).tolist()
    if isinstance(held, Carried) and level:
        return prop.with_hold(held, replace(held, heading=wrapped_angle(held.heading + angle)))
    if isinstance(held, Carried):
        return prop.with_hold(held, replace(held, tilt=(x, y, z, w)))
    if level:
        return replace(prop, heading=further_heading(prop.heading, angle, pose.time))
    if isinstance(prop.tilt, KeyedTurn):
        return replace(prop, tilt=prop.tilt.with_key(pose.time, (x, y, z, w)))
    if isinstance(prop.heading, KeyedNumber):
        return replace(prop, tilt=KeyedTurn((pose.time,), ((x, y, z, w),)))
    return replace(prop, tilt=(x, y, z, w))


def further_heading(heading: float | KeyedNumber, angle: float, time: float) -> float | KeyedNumber:
    """Heading increased by ``angle`` in radians; if it is keyed, by a key at ``time``."""
    if isinstance(heading, KeyedNumber):
        return heading.with_key(time, float(heading.at([time])[0, 0]) + angle)
    return wrapped_angle(heading + angle)


def is_about_z(rotation: FloatArray) -> bool:
    """True if a rotation matrix (3, 3) is about Z."""
    return bool(rotation[2, 2] > 1.0 - 1e-12)


def tilt_of(pose: PropPose) -> FloatArray:
    """Tilt (3, 3) of a prop, which is applied before its heading; the identity for a prop attached to a hand, which has
    no heading.
    """
    prop = pose.prop
    held = None if prop.lies_at(pose.time) else prop.held_at(pose.time)
    if isinstance(held, InHand):
        return np.eye(3)
    if isinstance(held, Carried):
        return to_matrix(np.array(held.tilt))
    if isinstance(prop.tilt, KeyedTurn):
        return np.asarray(prop.tilt.at([pose.time])[0])
    return to_matrix(np.array(prop.tilt))


def heading_of(pose: PropPose) -> float:
    """Heading of a prop in radians about Z, applied after its tilt."""
    headed = pose.axes @ tilt_of(pose).T
    return math.atan2(headed[1, 0], headed[0, 0])


def wrapped_angle(angle: float) -> float:
    """Equivalent angle between -pi and pi."""
    return math.remainder(angle, 2.0 * math.pi)


def with_fixed_position(pose: PropPose, *, keyed: bool) -> Prop:
    """Prop whose own position is the current one: constant, or ``keyed`` with a first key."""
    x, y, z = pose.place.tolist()
    position: Vector | KeyedPlace = (x, y, z)
    around = heading_of(pose)
    heading: float | KeyedNumber = around
    tilt = from_matrix(to_matrix(from_euler("Z", np.array([around]))).T @ pose.axes)
    if keyed:
        position, heading = KeyedPlace((pose.time,), ((x, y, z),)), KeyedNumber((pose.time,), (around,))
    return replace(pose.prop, position=position, heading=heading, tilt=tuple(tilt.tolist()), held=None, later=())


def hold_in_hand(pose: PropPose, performer_id: str, point: BodyPoint, holder: PosedPerformer) -> InHand:
    """Hold that attaches a prop to a body point in its current orientation; on a hand, at the middle of the palm.

    On a foot, the seat or another part it keeps its offset from the point; if it is too far away, it is moved
    there.
    """
    motion, row, layout = holder.motion, holder.row, holder.motion.morphology.layout
    from studio.core.solver.task_assembly.points import point_indices  # loads kernels

    origin, segment = point_indices(point, layout)
    axes = motion.rotations[row, segment]
    if point.part in HANDS:
        far, _ = point_indices(replace(point, at_end=not point.at_end), layout)
        offset = (motion.positions[row, far] - motion.positions[row, origin]) / 2
    else:
        offset = holder.placement.to_motion(pose.place) - motion.positions[row, origin]
        if np.linalg.norm(offset) > HELD_GAP_METRES + max(pose.prop.size) / 2:
            offset = np.zeros(3)
    x, y, z = (axes.T @ offset).tolist()
    turn = from_matrix((holder.placement.rotation @ axes).T @ pose.axes)
    return InHand(performer_id, replace(point, offset=(x, y, z)), tuple(turn.tolist()))


def hold_between_hands(
    prop: Prop, performer_id: str, holder: PosedPerformer, *, heading: float | None = None, lift: float | None = None
) -> Carried:
    """Hold that carries a prop in both hands: between them if they are in front of the body, else at a fixed offset in
    front of the root.

    With a ``heading`` (radians on the stage) the prop faces the nearest of four quarter turns from the chest's heading.
    With a ``lift`` it follows the hands of the motion, that many metres above their middle.
    """
    from studio.core.solver.performers.prop_tracks import carried_track  # loads kernels

    motion, held = holder.over_time, Carried(performer_id)
    known, body = motion.unconstrained or motion, motion.body
    turned = 0 if heading is None else quarter_turns(heading - chest_heading(holder))
    if lift is not None:
        held = replace(held, offset=(0.0, 0.0, lift / body.leg_length))
    else:
        track = carried_track(held, known.positions[:], known.rotations[:], body)
        ways = np.einsum("fji,fj->fi", track.rotations, track.positions - known.positions[:, 0]) / body.leg_length
        ahead, _, up = ways.mean(axis=0).tolist()
        needed = CARRIED_AHEAD_LEGS + prop.size[turned % 2] / 2 / body.leg_length
        if ahead < needed:
            held = replace(held, offset=(needed, 0.0, max(CARRIED_HEIGHT_LEGS, up)), steady=True)
    return replace(held, heading=wrapped_angle(turned * math.pi / 2))


def takes_lower(prop: Prop, giver: Carried, taker: Carried) -> bool:
    """True if the receiver's hands grip the same sides as the giver's, and so must be below them.

    A giver that took the prop below other hands gives it to hands in the middle.
    """
    giving, taking = (quarter_turns(each.heading) for each in (giver, taker))
    handed = sum(one.end == after.begin for one, after in itertools.pairwise(prop.holds))
    return giving % 2 == taking % 2 and handed % 2 == 0


def wrists_from(pose: PropPose, holder: PosedPerformer) -> float:
    """Distance in metres from the surface of a prop to the farther wrist of a performer."""
    layout = holder.motion.morphology.layout
    wrists = np.stack([holder.points[layout.wrist_point(side)] for side in range(2)])
    inside = np.abs((wrists - pose.place) @ pose.axes) - np.array(pose.prop.size) / 2
    return float(np.linalg.norm(np.maximum(inside, 0.0), axis=1).max())
