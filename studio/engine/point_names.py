"""Labels of body points, for every view."""

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
"""Every place that can be chosen: (part, whether its far end) and its name."""


def point_words(point: BodyPoint) -> str:
    """Label of a point: ``right wrist``; an origin or end without a name of its own has the name of its part."""
    plain = point.part.label.lower() + (" end" if point.at_end else "")
    return POINT_NAMES.get((point.part, point.at_end), plain)
