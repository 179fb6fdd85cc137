"""Indices of constraint points in the arrays of a body, and the weights of their limbs in a chain."""

from functools import cache, lru_cache

from studio.core.body.canonical import BodyLayout, BodyPart
from studio.core.constraints.base import CLAVICLES, TRUNK_PARTS, BodyPoint, Chain, limb_bones


@lru_cache(maxsize=1024)
def point_indices(point: BodyPoint, layout: BodyLayout) -> tuple[int, int]:
    """(origin point of a constraint point's offset, segment whose axes it uses)."""
    segment = layout.segment_of_part(point.part)
    ends = layout.distal_points() if point.at_end else layout.proximal_points()
    return ends[segment], segment


@cache
def limb_of(part: BodyPart) -> int:
    """Limb of a body part: 0, 1 left and right arm, 2, 3 legs, -1 none."""
    side, _, bone = part.value.partition("_")
    if bone in ("upper_arm", "forearm", "hand"):
        return 0 if side == "left" else 1
    if bone in ("thigh", "shank", "foot", "toe"):
        return 2 if side == "left" else 3
    return -1


@lru_cache(maxsize=1024)
def limb_weights(part: BodyPart, chain: Chain) -> tuple[bool, tuple[float, ...], float]:
    """(True if the chain moves joints beside the limb of a part, weights of its bones, weight of the limb)."""
    limb = limb_of(part)
    if limb < 0:
        return False, (), chain.limb
    parents, bones = (*TRUNK_PARTS, CLAVICLES[limb]) if limb < 2 else TRUNK_PARTS, limb_bones(part)
    parts = tuple(chain.weight(bone) for bone in bones)
    helped = chain.root > 0.0 or any(chain.weight(parent) > 0.0 for parent in parents)
    return helped, parts, max(parts[:1] if part == bones[0] else parts)
