"""Labels of clips: ranges of frames of a take in which a limb strikes or grasps."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from enum import IntEnum, StrEnum
from operator import index
from typing import Any, Self

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology
from studio.core.constraints.base import BodyPoint


class Limb(IntEnum):
    """Limb that hits; the value is the index of the limb in all arrays with an element for each limb."""

    LEFT_ARM = 0
    RIGHT_ARM = 1
    LEFT_LEG = 2
    RIGHT_LEG = 3

    @property
    def words(self) -> str:
        """Name in words, such as ``left arm``."""
        return self.name.lower().replace("_", " ")

    @property
    def is_arm(self) -> bool:
        """True for the arms."""
        return self < Limb.LEFT_LEG

    @property
    def side(self) -> int:
        """Index of the side: 0 left, 1 right."""
        return self % 2


class Kind(StrEnum):
    """Purpose of a clip (P09 section 3.3.1); ``NONE`` marks a proposal that was rejected."""

    PUNCH = "punch"
    KICK = "kick"
    WARD_OFF = "ward off"
    GRASP = "grasp"
    NONE = "no strike"
    """Proposal that is no strike: it is stored so that it is not proposed again, and is never found."""


class HitSegment(StrEnum):
    """Part of the limb that meets the target."""

    FIST = "fist"
    ELBOW = "elbow"
    BALL = "ball of the foot"
    HEEL = "heel"
    KNEE = "knee"


HIT_SEGMENTS = {True: (HitSegment.FIST, HitSegment.ELBOW), False: (HitSegment.BALL, HitSegment.HEEL, HitSegment.KNEE)}
"""Parts with which an arm can hit (key True), and a leg (key False)."""


def hit_point(limb: Limb, segment: HitSegment, body: Morphology) -> BodyPoint:
    """Point of ``body`` with which a limb hits the target; for a fist, the middle of the hand."""
    side = ("left", "right")[limb.side]
    match segment:
        case HitSegment.FIST:
            x, y, z = (0.5 * body.hand[limb.side]).tolist()
            return BodyPoint(BodyPart(f"{side}_hand"), (x, y, z))
        case HitSegment.ELBOW:
            return BodyPoint(BodyPart(f"{side}_forearm"))
        case HitSegment.BALL:
            return BodyPoint(BodyPart(f"{side}_foot"), at_end=True)
        case HitSegment.HEEL:
            below = (-float(body.heel_length[limb.side]), 0.0, -0.5 * float(body.ankle_height[limb.side]))
            return BodyPoint(BodyPart(f"{side}_foot"), below)
        case HitSegment.KNEE:
            return BodyPoint(BodyPart(f"{side}_shank"))


@dataclass(frozen=True)
class ClipLabel:
    """Label of the frames ``first`` to ``last`` of a motion, both included, in which ``limb`` hits at frame ``hit``.

    Raises ValueError if the frames are not in order or the limb has no such segment.
    """

    first: int
    last: int
    hit: int
    limb: Limb
    kind: Kind
    segment: HitSegment
    tags: tuple[str, ...] = ()
    confirmed: bool = False
    """True if a person confirmed the label, False if it was only proposed."""

    def __post_init__(self) -> None:
        for name, kind in (("limb", Limb), ("kind", Kind), ("segment", HitSegment)):
            object.__setattr__(self, name, kind(getattr(self, name)))
        if not 0 <= self.first < self.hit <= self.last:
            raise ValueError(f"A clip hits between its frames: {self.first}, {self.hit}, {self.last} are not in order.")
        if self.segment not in HIT_SEGMENTS[self.limb.is_arm]:
            raise ValueError(f"The {self.limb.words} has no {self.segment}.")

    def to_json(self) -> dict[str, Any]:
        """The label as a JSON object."""
        return asdict(self)

    @classmethod
    def from_json(cls, record: Mapping[str, Any]) -> Self:
        """Label in a JSON ``record``. Raises KeyError, TypeError or ValueError if it is not the record of a label."""
        first, last, hit, limb = (index(record[name]) for name in ("first", "last", "hit", "limb"))
        kind, segment = Kind(record["kind"]), HitSegment(record["segment"])
        return cls(
            first, last, hit, Limb(limb), kind, segment, tuple(map(str, record["tags"])), record["confirmed"] is True
        )
