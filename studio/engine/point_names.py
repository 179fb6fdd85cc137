"""Names of body points for the user."""

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint

_CENTRE = {
    ("pelvis", False): "pelvis",
    ("abdomen", False): "waist",
    ("thorax", False): "chest",
    ("thorax", True): "neck",
    ("neck", True): "head",
    ("head", True): "top of head",
}
_SIDE = {
    ("clavicle", True): "shoulder",
    ("upper_arm", True): "elbow",
    ("forearm", True): "wrist",
    ("hand", True): "fingertips",
    ("thigh", False): "hip",
    ("thigh", True): "knee",
    ("shank", True): "ankle",
    ("foot", True): "ball of foot",
    ("toe", True): "toes",
}
POINT_NAMES: dict[tuple[BodyPart, bool], str] = {
    **{(BodyPart(part), at_end): name for (part, at_end), name in _CENTRE.items()},
    **{
        (BodyPart(f"{side}_{part}"), at_end): f"{side} {name}"
        for side in ("left", "right")
        for (part, at_end), name in _SIDE.items()
    },
}
"""Name of every body point that can be chosen, by part and True for its far end."""


def point_words(point: BodyPoint) -> str:
    """Name of a body point: ``right wrist``; a point without its own name has that of its part."""
    plain = point.part.label.lower() + (" end" if point.at_end else "")
    return POINT_NAMES.get((point.part, point.at_end), plain)
