"""The points of a body that can be picked and constrained, and what constraining each sensibly means."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from studio.core.canonical import BodyLayout, BodyPart
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.solver.request import AdaptedMotion

_ARM = Chain(limb=1.0, clavicle=1.0, trunk=0.3)
_HAND_END = Chain(limb=1.0, end_segment=0.5, clavicle=1.0, trunk=0.3)
_LEG = Chain(limb=1.0, clavicle=0.0)
_TOES = Chain(limb=1.0, end_segment=0.5, clavicle=0.0)
_TRUNK = Chain(limb=0.0, clavicle=0.0, trunk=1.0)
_ROOT = Chain(limb=0.0, clavicle=0.0, trunk=0.0, root=1.0)


@dataclass(frozen=True)
class BodyJoint:
    """A joint that a click can find: canonical index, name, point fixed to the body, chain."""

    index: int
    name: str
    point: BodyPoint
    chain: Chain


@lru_cache
def body_joints(layout: BodyLayout) -> tuple[BodyJoint, ...]:
    """Every joint of a body that can be constrained."""
    joints = [
        BodyJoint(0, "pelvis", BodyPoint(BodyPart.PELVIS), _ROOT),
        BodyJoint(layout.spine_count - 1, "chest", BodyPoint(BodyPart.THORAX), _TRUNK),
        BodyJoint(layout.neck_base, "neck", BodyPoint(BodyPart.THORAX, at_end=True), _TRUNK),
        BodyJoint(layout.head_joint, "head", BodyPoint(BodyPart.NECK, at_end=True), _TRUNK),
        BodyJoint(layout.head_end, "top of head", BodyPoint(BodyPart.HEAD, at_end=True), _TRUNK),
    ]
    for side, word in enumerate(("left", "right")):
        arm = (("clavicle", "shoulder", _TRUNK), ("upper_arm", "elbow", _ARM), ("forearm", "wrist", _ARM))
        leg = (("thigh", "knee", _LEG), ("shank", "ankle", _LEG), ("foot", "ball of foot", _LEG))
        ends = (
            (layout.wrist(side) + 1, "hand", "fingertips", _HAND_END),
            (layout.toe(side) + 1, "toe", "toes", _TOES),
        )
        joints.append(BodyJoint(layout.hip(side), f"{word} hip", BodyPoint(BodyPart(f"{word}_thigh")), _ROOT))
        for first, bones in ((layout.collar(side) + 1, arm), (layout.hip(side) + 1, leg)):
            for step, (part, name, chain) in enumerate(bones):
                point = BodyPoint(BodyPart(f"{word}_{part}"), at_end=True)
                joints.append(BodyJoint(first + step, f"{word} {name}", point, chain))
        for index, part, name, chain in ends:
            point = BodyPoint(BodyPart(f"{word}_{part}"), at_end=True)
            joints.append(BodyJoint(index, f"{word} {name}", point, chain))
    return tuple(joints)


def point_path(motion: AdaptedMotion, point: BodyPoint, rows: slice = slice(None)) -> NDArray[np.float64]:
    """(F, 3) where ``point`` is in the motion's space in each of ``rows``."""
    layout = motion.morphology.layout
    segment = layout.segment(point.part)
    origin = (layout.distal_points() if point.at_end else layout.proximal_points())[segment]
    turned = motion.rotations[rows, segment] @ np.asarray(point.offset)
    return motion.positions[rows, origin] + turned
