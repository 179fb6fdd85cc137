"""New constraints of every kind, whose targets are the current pose of a performer at the playhead."""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from studio.core.body.canonical import BodyPart
from studio.core.captures.contacts import ContactPoint
from studio.core.constraints.area import AreaConstraint
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import BodyPoint, Chain, Constraint, Vector
from studio.core.constraints.carried_over import other_side
from studio.core.constraints.clear import ClearConstraint
from studio.core.constraints.distance import DistanceConstraint
from studio.core.constraints.fitted_activation import LONGEST_SIDE_SECONDS, LimbPath, fitted_activation, free_frames
from studio.core.constraints.kinds import CONSTRAINT_KINDS
from studio.core.constraints.look_at import EYES_POINT, LookAtConstraint
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.parallel import ParallelConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.rail import RailConstraint
from studio.core.constraints.upright import UprightConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.curves.retiming import speed_at
from studio.core.names import free_name
from studio.core.normalized.mirror import mirrored_contacts
from studio.core.rotations import from_matrix
from studio.core.solver.request import AdaptedMotion
from studio.core.solver.task_assembly.points import limb_of
from studio.core.stage.project import Project
from studio.engine.posed_performer import PosedPerformer
from studio.engine.target_context import TargetContext
from studio.viewport.body_points import BodyJoint, point_path
from studio.viewport.camera import FloatArray

LOOK_AT_DISTANCE = 2.0
"""Distance in metres from the eyes to the target of a new look-at constraint."""
UPRIGHT_TOLERANCE_RADIANS = math.radians(5.0)
"""Maximum tilt in radians of a new upright constraint."""
NEW_TABLE_SIZE = (0.8, 0.8)
"""Sides in metres of the top of a new table; it stands on the ground and reaches up to the point."""
MIN_TABLE_HEIGHT_METRES = 0.1
MIN_PATH_METRES = 0.01
"""Length in metres of a path below which a new rail points forward instead of along the path."""
NEXT_SEGMENT = {
    "clavicle": "upper_arm", "upper_arm": "forearm", "forearm": "hand",
    "thigh": "shank", "shank": "foot", "thorax": "neck", "neck": "head",
}  # fmt: skip
"""Segment that rotates about the far end of a segment."""
UPPER_SEGMENT = {"forearm": "upper_arm", "hand": "upper_arm", "shank": "thigh", "foot": "thigh", "toe": "thigh"}
"""First segment of the limb to which a segment belongs."""
_HEAD = Chain(limb=1.0, end_segment=1.0, clavicle=0.0, trunk=0.3)
_WHOLE_BODY = Chain(limb=0.0, clavicle=0.0, trunk=1.0, root=1.0, free_arms=1.0, free_legs=1.0)


@dataclass(frozen=True)
class NewConstraintContext:
    """Context of a new constraint: a performer at the playhead, and the joint picked on it, if any."""

    moment: TargetContext
    joint: BodyJoint | None
    fits_activation: bool = True
    """True if the constraint is active only while the point stays still; False for the whole clip."""

    @property
    def project(self) -> Project:
        """Current project."""
        return self.moment.project

    @property
    def pose(self) -> PosedPerformer:
        """Pose of the performer at the playhead."""
        return self.moment.pose

    @property
    def picked(self) -> BodyJoint:
        """Picked joint; only for kinds that need one."""
        assert self.joint is not None
        return self.joint

    def place(self, point: BodyPoint) -> FloatArray:
        """(3,) position of a body point, motion space."""
        return self.pose.points_in_clip(point_path(self.pose.motion, point, slice(self.pose.row, self.pose.row + 1))[0])

    def rotation(self, part: BodyPart) -> FloatArray:
        """(3, 3) rotation of a segment, motion space."""
        return self.pose.rotation_in_clip(part)

    @cached_property
    def span(self) -> tuple[float, float]:
        """Start and end of the clip in seconds of its motion."""
        clip = self.pose.clip
        assert clip is not None
        rate = self.project.frame_rate_of(clip)
        return clip.first / rate, clip.last / rate

    def between_stances(self, part: BodyPart, now: float) -> tuple[float, float]:
        """Time range in seconds of the motion from the end of the limb's last stance (or the start of the clip) to the
        start of the next.

        A stance at ``now`` counts as part of the motion around it, because the target is there. In another stance the
        limb is held by its contact: if the constraint faded in meanwhile, the limb would jump when it is released.
        """
        clip, project = self.pose.clip, self.project
        assert clip is not None
        rate = project.frame_rate_of(clip)
        contacts = project.contacts_for(self.moment.performer_id, clip).values()
        stands = np.zeros(clip.last + 1, dtype=bool)
        for contact in mirrored_contacts(tuple(contacts)) if self.pose.mirrored else contacts:
            if isinstance(contact.point, ContactPoint) and _is_on(part, contact.point):
                stands[max(contact.first, 0) : contact.last + 1] = True
        frame = min(round(now * rate), clip.last)
        back, on = free_frames(stands[clip.first :], frame - clip.first)
        begin, end = self.span
        return max(begin, (frame - back) / rate), min(end, (frame + on) / rate)

    @cached_property
    def frames_around(self) -> tuple[AdaptedMotion, slice, FloatArray]:
        """Motion over time, its frames around the playhead, and their times (F,) in seconds of the clip's motion."""
        motion, clip = self.pose.over_time, self.pose.clip
        assert clip is not None
        rate, speed = self.project.frame_rate_of(clip), float(speed_at(clip.speed, self.pose.seconds))
        row, reach = self.pose.frame - motion.first_frame, round(LONGEST_SIDE_SECONDS * motion.frame_rate / speed)
        rows = slice(max(row - reach, 0), max(min(row + reach + 1, motion.frame_count), 0))
        since = (np.arange(rows.start, rows.stop) - row) / motion.frame_rate
        return motion, rows, clip.motion_seconds(clip.stage_seconds(self.pose.seconds, rate) + since, rate)

    def points(self, point: BodyPoint) -> FloatArray:
        """(F, 3) positions of a body point in ``frames_around``."""
        motion, rows, _ = self.frames_around
        return point_path(motion, point, rows)

    def rotations(self, part: BodyPart) -> FloatArray:
        """(F, 3, 3) rotations of a segment in ``frames_around``."""
        motion, rows, _ = self.frames_around
        return motion.rotations[rows, motion.morphology.layout.segment_of_part(part)]

    def freedom(self, part: BodyPart) -> FloatArray:
        """(F,) factor from 0 to 1 by which contacts release the limb of a segment in ``frames_around``."""
        from studio.core.solver.grounding.body_support import limb_freedom  # not before it is needed: it loads SciPy

        motion, rows, _ = self.frames_around
        frames = slice(rows.start + motion.first_frame, rows.stop + motion.first_frame)
        return limb_freedom(motion.contacts, limb_of(part), frames.stop, motion.frame_rate)[frames]

    def limb(self, point: BodyPoint) -> LimbPath | None:
        """Path of a point on a forearm, hand, shank or foot, blended to its current position; None for other points."""
        side, bone = _side_and_bone(point.part)
        if bone not in UPPER_SEGMENT:
            return None
        upper, end = BodyPart(f"{side}{UPPER_SEGMENT[bone]}"), self.points(point)
        now = int(np.argmin(np.abs(self.frames_around[2] - self.pose.seconds)))
        return LimbPath(self.points(BodyPoint(upper)), self.points(BodyPoint(upper, at_end=True)), end, end[now])

    def common(
        self, name: str, point: BodyPoint, chain: Chain, moving: FloatArray | None = None, *, limb: bool = False
    ) -> dict[str, Any]:
        """Fields that all kinds share: lowest priority, and an activation around the playhead.

        ``moving`` (F, D), metres or radians in ``frames_around``, are the values that the constraint keeps as they are
        now; without them it is always active. The values of the position of a ``limb`` follow its path.
        """
        motion_id = self.pose.motion_id or ""
        existing = self.project.constraints_of(motion_id).values()
        begin, end = self.span
        now = min(max(self.pose.seconds, begin), end)
        activation = ActivationCurve(begin, begin, end, end)
        if moving is not None and self.fits_activation:
            between = self.between_stances(point.part, now)
            path = self.limb(point) if limb else None
            freedom = self.freedom(point.part)
            activation = fitted_activation(self.frames_around[2], moving, now, *between, path, freedom)
        return {
            "motion_id": motion_id,
            "name": free_name(name, {one.name for one in existing}),
            "point": point,
            "chain": chain,
            "priority": max((one.priority for one in existing), default=-1) + 1,
            "activation": activation,
        }


def _is_on(part: BodyPart, point: ContactPoint) -> bool:
    """True if a contact holds a segment: a foot contact its leg, a hand contact its arm."""
    segments = ("upper_arm", "forearm", "hand") if point.member == "hand" else ("thigh", "shank", "foot", "toe")
    side = ("left", "right")[point.side] if point.limb >= 0 else ""
    return part in {f"{side}_{segment}" for segment in segments}


def constraint_here(here: NewConstraintContext, kind: str) -> Constraint:
    """New constraint of ``kind`` whose target is the current pose."""
    make = CONSTRAINT_KINDS[kind].make
    assert make is not None  # a kind without one has no action
    return here.moment.as_played(make(here))


def new_position(here: NewConstraintContext) -> Constraint:
    """Position constraint at the joint's current position."""
    joint = here.picked
    place = _vector(here.place(joint.point))
    # Bodies of other measures are elsewhere in the middle of a walk: each has its own place, as long as that is known.
    target = here.moment.own_place(joint.point, place, here.pose.seconds) or place
    common = here.common(joint.name.capitalize(), joint.point, joint.chain, here.points(joint.point), limb=True)
    return PositionConstraint(**common, target=target)


def new_orientation(here: NewConstraintContext) -> Constraint:
    """Orientation constraint with the segment's current rotation."""
    from scipy.spatial.transform import Rotation  # late: it takes longer than a window

    joint = here.picked
    part = turned_part(joint.point)
    target = tuple(from_matrix(here.rotation(part)).tolist())
    chain = _HEAD if part in (BodyPart.HEAD, BodyPart.NECK) else replace(joint.chain, end_segment=1.0)
    turns = here.rotations(part)
    now = int(np.argmin(np.abs(here.frames_around[2] - here.pose.seconds)))
    moving = Rotation.from_matrix(turns[now].T @ turns).as_rotvec()
    return OrientationConstraint(
        **here.common(f"{part.label.capitalize()} orientation", BodyPoint(part), chain, moving), target=target
    )


def new_look_at(here: NewConstraintContext) -> Constraint:
    """Look-at constraint with a target ``LOOK_AT_DISTANCE`` ahead."""
    target = here.place(EYES_POINT) + LOOK_AT_DISTANCE * here.rotation(EYES_POINT.part)[:, 0]
    gazes = here.rotations(EYES_POINT.part)[:, :, 0]
    return LookAtConstraint(**here.common("Look at", EYES_POINT, _HEAD, gazes), target=_vector(target))


def new_upright(here: NewConstraintContext) -> Constraint:
    """Upright constraint for the axis of the segment that points up now."""
    part = turned_part(here.picked.point)
    chain = _HEAD if part in (BodyPart.HEAD, BodyPart.NECK) else replace(here.picked.chain, end_segment=1.0)
    common = here.common(f"{part.label.capitalize()} upright", BodyPoint(part), chain)
    return UprightConstraint(**common, axis=_vector(here.rotation(part)[2]), cone=UPRIGHT_TOLERANCE_RADIANS)


def new_parallel(here: NewConstraintContext) -> Constraint:
    """Parallel constraint that keeps the current angle to the segment of the other side; to the pelvis for a central
    segment, to the thorax for the pelvis.
    """
    part = turned_part(here.picked.point)
    other = other_side(part)
    if other is part:
        other = BodyPart.PELVIS if part is not BodyPart.PELVIS else BodyPart.THORAX
    chain = _HEAD if part in (BodyPart.HEAD, BodyPart.NECK) else replace(here.picked.chain, end_segment=1.0)
    axis = _vector(here.rotation(part).T @ here.rotation(other)[:, 0])
    common = here.common(f"{part.label.capitalize()} parallel", BodyPoint(part), chain)
    return ParallelConstraint(**common, axis=axis, other=BodyPoint(other))


def new_distance(here: NewConstraintContext) -> Constraint:
    """Distance constraint with the current distance of both wrists; for another joint, with zero distance to its
    current position.
    """
    joint = here.picked
    begin, other = here.place(joint.point), opposite_hand(joint.point)
    name = "Hand distance" if other else f"{joint.name.capitalize()} distance"
    moving = here.points(joint.point)
    if other is not None:
        moving = np.linalg.norm(here.points(other) - moving, axis=1, keepdims=True)
    common = here.common(name, joint.point, joint.chain, moving)
    if other is None:
        return DistanceConstraint(**common, other=_vector(begin), distance=0.0)
    return DistanceConstraint(**common, other=other, distance=float(np.linalg.norm(here.place(other) - begin)))


def new_balance(here: NewConstraintContext) -> Constraint:
    """Balance constraint that keeps the captured path of the centre of mass."""
    return BalanceConstraint(**here.common("Balance", BodyPoint(BodyPart.PELVIS), _WHOLE_BODY))


def new_area(here: NewConstraintContext) -> Constraint:
    """Volume constraint with a table under the joint."""
    joint = here.picked
    x, y, top = here.place(joint.point)
    floor = float(here.project.ground.height_at(here.pose.clip_placement.to_stage((x, y, 0.0))))
    height = max(float(top) - floor, MIN_TABLE_HEIGHT_METRES)
    return AreaConstraint(
        **here.common(f"Table under {joint.name}", joint.point, joint.chain),
        centre=(float(x), float(y), floor + height / 2),
        size=(*NEW_TABLE_SIZE, height),
    )


def new_rail(here: NewConstraintContext) -> Constraint:
    """Rail constraint along the joint's path around the playhead."""
    joint = here.picked
    path = here.points(joint.point)
    moved = path[-1] - path[0] if len(path) else np.zeros(3)
    direction = moved if float(np.linalg.norm(moved)) > MIN_PATH_METRES else np.eye(3)[0]
    common = here.common(f"{joint.name.capitalize()} on rail", joint.point, joint.chain)
    return RailConstraint(**common, centre=_vector(here.place(joint.point)), direction=_vector(direction))


def new_clear(here: NewConstraintContext) -> Constraint:
    """Arm clearance constraint for both arms."""
    return ClearConstraint(**here.common("Arm clearance", BodyPoint(BodyPart.THORAX), Chain()))


def turned_part(point: BodyPoint) -> BodyPart:
    """Segment that rotates at a joint: at the wrist the hand."""
    side, bone = _side_and_bone(point.part)
    next_bone = NEXT_SEGMENT.get(bone) if point.at_end else None
    return BodyPart(f"{side}{next_bone}") if next_bone else point.part


def opposite_hand(point: BodyPoint) -> BodyPoint | None:
    """Same point of the other hand; None unless the point is on a hand or wrist."""
    side, bone = _side_and_bone(point.part)
    if bone not in ("forearm", "hand") or not point.at_end:
        return None
    return replace(point, part=BodyPart(f"{'right_' if side == 'left_' else 'left_'}{bone}"))


def _side_and_bone(part: BodyPart) -> tuple[str, str]:
    """Side and bone of a part, for example ``left_`` and ``upper_arm``; the side is empty for a central part."""
    for side in ("left_", "right_"):
        if part.startswith(side):
            return side, part.removeprefix(side)
    return "", part.value


def _vector(position: FloatArray) -> Vector:
    x, y, z = (float(number) for number in position)
    return x, y, z
