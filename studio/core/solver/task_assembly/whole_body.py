"""Areas that a whole body keeps out of: one area for each of several points, with the body's thickness there as
margin.
"""

from dataclasses import replace

import numpy as np

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.mesh.volume import PART_CAPSULES, BodyVolume

ARM_CHAIN, LEG_CHAIN, TRUNK_CHAIN = Chain(trunk=0.3), Chain(root=1.0), Chain(trunk=0.5, root=1.0)
"""Chains that keep arms, legs and trunk out of an area."""
TRUNK_ROWS = PART_CAPSULES["hips"][0], PART_CAPSULES["trunk"][0], PART_CAPSULES["trunk"][2]
"""Capsules of one side of the trunk, from the lowest to the highest."""
HAND_MARGIN_FACTOR = 0.77
"""Margin of a wrist in hand lengths. It stands in for the hand: a second constrained point on one limb would conflict
with the first.
"""
JOINT_MARGIN_FACTOR = 1.4
"""Margin of elbow and knee in radii of the body's volume there. The radii are means around the bone, narrower than the
limb on either side.
"""
NECK_MARGIN_FACTOR = 1.3
"""Margin of the neck in radii of the head, which overhangs it."""


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
    """(point, thickness, chain) of each constrained point of a body: metres of flesh around it, and the chain that
    keeps it out.
    """
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
            (BodyPoint(BodyPart(f"{side}_forearm"), at_end=True), HAND_MARGIN_FACTOR * hand, ARM_CHAIN),
            (BodyPoint(BodyPart(f"{side}_upper_arm"), at_end=True), JOINT_MARGIN_FACTOR * elbow, ARM_CHAIN),
            (BodyPoint(BodyPart(f"{side}_thigh"), at_end=True), JOINT_MARGIN_FACTOR * knee, LEG_CHAIN),
        )
    ]
    return [
        *limbs,
        (BodyPoint(BodyPart.PELVIS), float(max(low, middle)), TRUNK_CHAIN),
        (BodyPoint(BodyPart.THORAX), float(max(middle, top)), TRUNK_CHAIN),
        (BodyPoint(BodyPart.NECK), NECK_MARGIN_FACTOR * head, TRUNK_CHAIN),
    ]


def _shape_for(chain: Chain, shape: AreaShape) -> AreaShape:
    """Shape that a chain keeps out of: a box instead of a table for the trunk, which is pushed sideways."""
    return AreaShape.BOX if shape is AreaShape.TABLE and chain is TRUNK_CHAIN else shape
