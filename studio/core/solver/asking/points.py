"""Where the points of constraints stand in the arrays of a body, and how freely a chain moves their limbs."""

from functools import cache, lru_cache

from studio.core.body.canonical import BodyLayout, BodyPart
from studio.core.constraints.base import CLAVICLES, TRUNK, BodyPoint, Chain, limb_bones


@lru_cache(maxsize=1024)
def point_indices(point: BodyPoint, layout: BodyLayout) -> tuple[int, int]:
    """(index of the point an offset counts from, index of the segment in whose axes it stands)."""
    segment = layout.segment(point.part)
    ends = layout.distal_points() if point.at_end else layout.proximal_points()
    return ends[segment], segment


@cache
def limb_of(part: BodyPart) -> int:
    """0, 1 left and right arm, 2, 3 legs, -1 for what is on no limb."""
    side, _, bone = part.value.partition("_")
    if bone in ("upper_arm", "forearm", "hand"):
        return 0 if side == "left" else 1
    if bone in ("thigh", "shank", "foot", "toe"):
        return 2 if side == "left" else 3
    return -1


@lru_cache(maxsize=1024)
def freedoms_of(part: BodyPart, chain: Chain) -> tuple[bool, tuple[float, ...], float]:
    """Whether a chain helps the limb of a part by what carries it, the weights of its bones, and how free it is."""
    limb = limb_of(part)
    if limb < 0:
        return False, (), chain.limb
    carriers, bones = (*TRUNK, CLAVICLES[limb]) if limb < 2 else TRUNK, limb_bones(part)
    parts = tuple(chain.weight(bone) for bone in bones)
    helped = chain.root > 0.0 or any(chain.weight(carrier) > 0.0 for carrier in carriers)
    return helped, parts, max(parts[:1] if part == bones[0] else parts)
