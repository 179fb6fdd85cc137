"""Indices of constrained points in the arrays of a body, and the weights of their limbs in a chain."""

from functools import cache, lru_cache

from studio.core.body.canonical import BodyLayout, BodyPart
from studio.core.constraints.base import CLAVICLES, TRUNK_PARTS, BodyPoint, Chain, limb_bones


@lru_cache(maxsize=1024)
def point_indices(point: BodyPoint, layout: BodyLayout) -> tuple[int, int]:
    """(index of the body point from which a constrained point is offset, index of the segment with the offset's
    axes).
    """
    segment = layout.segment_of_part(point.part)
    ends = layout.distal_points() if point.at_end else layout.proximal_points()
    return ends[segment], segment


@cache
def limb_of(part: BodyPart) -> int:
    """Index of the limb of a body part: 0 and 1 left and right arm, 2 and 3 left and right leg, -1 for none."""
    side, _, bone = part.value.partition("_")
    if bone in ("upper_arm", "forearm", "hand"):
        return 0 if side == "left" else 1
    if bone in ("thigh", "shank", "foot", "toe"):
        return 2 if side == "left" else 3
    return -1


@lru_cache(maxsize=1024)
def limb_weights(part: BodyPart, chain: Chain) -> tuple[bool, tuple[float, ...], float]:
    """(assisted, weights of the limb's bones, weight of the limb) of a part's limb in a chain.

    ``assisted`` is true if the chain moves joints beside that limb.
    """
    limb = limb_of(part)
    if limb < 0:
        return False, (), chain.limb
    parents, bones = (*TRUNK_PARTS, CLAVICLES[limb]) if limb < 2 else TRUNK_PARTS, limb_bones(part)
    parts = tuple(chain.weight(bone) for bone in bones)
    helped = chain.root > 0.0 or any(chain.weight(parent) > 0.0 for parent in parents)
    return helped, parts, max(parts[:1] if part == bones[0] else parts)
