"""Areas for the points of a whole body, each with the thickness of the body there as its margin."""

from dataclasses import replace

import numpy as np

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.mesh.volume import PART_CAPSULES, BodyVolume

ARM_CHAIN, LEG_CHAIN, TRUNK_CHAIN = Chain(trunk=0.3), Chain(root=1.0), Chain(trunk=0.5, root=1.0)
TRUNK_ROWS = PART_CAPSULES["hips"][0], PART_CAPSULES["trunk"][0], PART_CAPSULES["trunk"][2]
"""Capsules of one side of the trunk, from the lowest to the highest."""
HAND_SHARE = 0.77
"""Margin of a wrist in hand lengths: the hand hangs from it, and a second point on one limb would pull against it."""
JOINT_SHARE = 1.4
"""Margin of elbow and knee in radii of the body's volume there, which are means around the bone, narrower than what
follows on either side.
"""
NECK_SHARE = 1.3
"""Margin of the neck in radii of the head, which leans over it."""


def areas_of(area: AreaConstraint, body: Morphology, volume: BodyVolume) -> tuple[AreaConstraint, ...]:
    """Areas of the points of a body that keeps out of ``area`` as a whole. Legs have room under a table."""
    parts = [part for part in _points(body, volume) if not (part[2] is LEG_CHAIN and area.shape is AreaShape.TABLE)]
    return tuple(
        replace(
            area,
            point=point,
            chain=chain,
            whole=False,
            margin=area.margin + thickness,
            shape=_shape_for(chain, area.shape),
        )
        for point, thickness, chain in parts
    )


def _points(body: Morphology, volume: BodyVolume) -> list[tuple[BodyPoint, float, Chain]]:
    """Points of a body, the metres around them that its skin takes up, and the chains that keep them away."""
    hands, (elbow, *_) = np.linalg.norm(body.hand, axis=1), volume.girths.tolist()
    knee, head = (float(volume.radii[PART_CAPSULES[part][0], 1]) for part in ("thigh", "head"))
    fronts = [
        (volume.places[row, :, 0] + volume.radii[row]).tolist()
        for row in PART_CAPSULES["hips"] + PART_CAPSULES["trunk"]
    ]
    low, middle, top = (max(fronts[row]) for row in (0, 2, 4))
    limbs = [
        limb
        for side, hand in zip(("left", "right"), hands.tolist(), strict=True)
        for limb in (
            (BodyPoint(BodyPart(f"{side}_forearm"), at_end=True), HAND_SHARE * hand, ARM_CHAIN),
            (BodyPoint(BodyPart(f"{side}_upper_arm"), at_end=True), JOINT_SHARE * elbow, ARM_CHAIN),
            (BodyPoint(BodyPart(f"{side}_thigh"), at_end=True), JOINT_SHARE * knee, LEG_CHAIN),
        )
    ]
    return [
        *limbs,
        (BodyPoint(BodyPart.PELVIS), float(max(low, middle)), TRUNK_CHAIN),
        (BodyPoint(BodyPart.THORAX), float(max(middle, top)), TRUNK_CHAIN),
        (BodyPoint(BodyPart.NECK), NECK_SHARE * head, TRUNK_CHAIN),
    ]


def _shape_for(chain: Chain, shape: AreaShape) -> AreaShape:
    """Shape that a chain stays out of: a trunk leaves a table aside, as a box."""
    return AreaShape.BOX if shape is AreaShape.TABLE and chain is TRUNK_CHAIN else shape
