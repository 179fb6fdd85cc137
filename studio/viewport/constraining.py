"""A new position constraint from a picked joint: where the joint is now, round the playhead."""

from studio.core.constraints.activation import ActivationCurve
from studio.core.constraints.position import PositionConstraint
from studio.core.project import Project
from studio.viewport.body_points import BodyJoint, point_path
from studio.viewport.performance import Posed

HOLD, RAMP = 0.1, 0.3
"""Seconds held on either side of the playhead, and eased beyond."""


def constraint_here(project: Project, pose: Posed, joint: BodyJoint) -> PositionConstraint:
    """A constraint that keeps ``joint`` where ``pose`` has it: full near the playhead, last in priority."""
    clip = pose.performer.clips[0]
    begin, end = (frame / pose.motion.frame_rate for frame in (clip.first, clip.last))
    now = min(max(pose.seconds, begin), end)
    start, full, full_end, last = (
        min(max(now + step, begin), end) for step in (-HOLD - RAMP, -HOLD, HOLD, HOLD + RAMP)
    )
    row = slice(pose.row, pose.row + 1)
    existing = project.constraints_of(clip.motion_id).values()
    return PositionConstraint(
        motion_id=clip.motion_id,
        name=_free_name(joint.name.capitalize(), {one.name for one in existing}),
        point=joint.point,
        chain=joint.chain,
        priority=max((one.priority for one in existing), default=-1) + 1,
        activation=ActivationCurve(start, full, full_end, last),
        target=tuple(point_path(pose.motion, joint.point, row)[0].tolist()),
    )


def _free_name(name: str, taken: set[str]) -> str:
    number, free = 1, name
    while free in taken:
        number += 1
        free = f"{name} {number}"
    return free
