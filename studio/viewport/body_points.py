"""Points of a body that can be picked and constrained, each with a default IK chain."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyLayout, BodyPart
from studio.core.constraints.base import BodyPoint, Chain, Vector
from studio.core.solver.request import AdaptedMotion
from studio.engine.point_names import POINT_NAMES
from studio.engine.posed_performer import PosedPerformer

_ARM = Chain(limb=1.0, clavicle=1.0, trunk=0.4, root=0.2)
_HAND_END = Chain(limb=1.0, end_segment=0.5, clavicle=1.0, trunk=0.4, root=0.2)
_LEG = Chain(limb=1.0, clavicle=0.0, root=0.6)
_TOES = Chain(limb=1.0, end_segment=0.5, clavicle=0.0, root=0.6)
_TRUNK = Chain(limb=0.0, clavicle=0.0, trunk=1.0)
_ROOT = Chain(limb=0.0, clavicle=0.0, trunk=0.0, root=1.0)
_CHAINS = {
    "pelvis": _ROOT, "thigh": _ROOT, "clavicle": _TRUNK,
    "upper_arm": _ARM, "forearm": _ARM, "hand": _HAND_END,
    "shank": _LEG, "foot": _LEG, "toe": _TOES,
}  # fmt: skip


@dataclass(frozen=True)
class BodyJoint:
    """Pickable joint: index in the canonical skeleton, name, point fixed to the body, and default IK chain."""

    index: int
    name: str
    point: BodyPoint
    chain: Chain


@lru_cache
def body_joints(layout: BodyLayout) -> tuple[BodyJoint, ...]:
    """Joints of a body that can be constrained; instead of the waist, the chest is picked."""
    near, far = layout.proximal_points(), layout.distal_points()
    joints = []
    for (part, at_end), name in POINT_NAMES.items():
        if part is BodyPart.ABDOMEN:
            continue
        index = int((far if at_end else near)[layout.segment_of_part(part)])
        joints.append(BodyJoint(index, name, BodyPoint(part, at_end=at_end), _chain(part, at_end)))
    return tuple(joints)


def skin_point(layout: BodyLayout, part: BodyPart, offset: Vector, at_end: bool) -> BodyJoint:
    """Point on the skin of a segment, at ``offset`` in metres from the segment's origin or, with ``at_end``, from its
    far end.
    """
    ends = layout.distal_points() if at_end else layout.proximal_points()
    point = BodyPoint(part, offset, at_end)
    return BodyJoint(int(ends[layout.segment_of_part(part)]), f"{part.label.lower()} skin", point, _chain(part, at_end))


def place_of_joint(pose: PosedPerformer, joint: BodyJoint) -> NDArray[np.float64]:
    """(3,) position of a picked joint or point on the stage."""
    return pose.placement.to_stage(point_path(pose.motion, joint.point, slice(pose.row, pose.row + 1))[0])


def _chain(part: BodyPart, at_end: bool) -> Chain:
    bone = part.value.partition("_")[2] or part.value
    return _LEG if (bone, at_end) == ("thigh", True) else _CHAINS.get(bone, _TRUNK)


def point_path(
    motion: AdaptedMotion, point: BodyPoint, rows: slice | NDArray[np.intp] = slice(None)
) -> NDArray[np.float64]:
    """(F, 3) positions of ``point`` in the frames ``rows``, in motion space."""
    layout = motion.morphology.layout
    segment = layout.segment_of_part(point.part)
    origin = (layout.distal_points() if point.at_end else layout.proximal_points())[segment]
    turned = motion.rotations[rows, segment] @ np.asarray(point.offset)
    path: NDArray[np.float64] = motion.positions[rows, origin] + turned
    return path
