"""Layer: a clip that plays on a part of the body, over the clips of the performer's row."""

import math
from dataclasses import dataclass
from enum import StrEnum

from studio.core.stage.clip import Clip


class Region(StrEnum):
    """Part of the body that a layer moves; the legs include the hips."""

    WHOLE = "whole body"
    UPPER_BODY = "upper body"
    TRUNK = "trunk"
    HEAD = "head"
    ARMS = "arms"
    LEFT_ARM = "left arm"
    RIGHT_ARM = "right arm"
    LEGS = "legs"

    @property
    def label(self) -> str:
        """Label for the user, such as ``Upper body``; ``Torso`` for the trunk."""
        return "Torso" if self is Region.TRUNK else self.capitalize()

    @property
    def parts(self) -> frozenset["Region"]:
        """Elementary regions of which this region consists."""
        match self:
            case Region.WHOLE:
                return Region.UPPER_BODY.parts | {Region.LEGS}
            case Region.UPPER_BODY:
                return frozenset((Region.TRUNK, Region.HEAD, Region.LEFT_ARM, Region.RIGHT_ARM))
            case Region.ARMS:
                return frozenset((Region.LEFT_ARM, Region.RIGHT_ARM))
        return frozenset((self,))


@dataclass(frozen=True)
class Layer:
    """Clip that plays over a performer's row of clips, with ``weight`` on a ``region`` of the body.

    ``fade_in`` and ``fade_out`` are in seconds; 0 lets a fade take as long as low joint accelerations need.
    ``additive`` adds the difference of the clip from its frame ``reference`` (-1 for its first frame) to the motion
    below.
    """

    clip: Clip
    region: Region = Region.UPPER_BODY
    weight: float = 1.0
    fade_in: float = 0.0
    fade_out: float = 0.0
    additive: bool = False
    reference: int = -1

    def __post_init__(self) -> None:
        object.__setattr__(self, "region", Region(self.region))
        if not (math.isfinite(self.weight) and 0.0 <= self.weight <= 1.0):
            raise ValueError(f"The weight of a layer must be between 0 and 1, not {self.weight}.")
        if not all(math.isfinite(seconds) and seconds >= 0.0 for seconds in (self.fade_in, self.fade_out)):
            raise ValueError("The fades of a layer must be 0 (automatic) or more seconds.")
        if self.reference < -1:
            raise ValueError(f"The reference frame of a layer must be a frame of its motion, not {self.reference}.")
