"""Conditions of a transition, and the input from which a performer evaluates them in a frame."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

from studio.core.plausible import PLACE_RANGE, TIME_RANGE
from studio.core.stage.behaviour_target import DistanceMeasure


@dataclass(frozen=True)
class ConditionInput:
    """Input of a performer's conditions in one frame of the stage.

    ``step``: seconds since the previous frame. ``gaps``: the measured distances that ``Behaviour.gaps_from`` lists; a
    distance that is missing, for lack of a partner, fulfils no condition. ``clip_ended``: True if the state's clip has
    played its last frame. ``events`` and ``keys``: names of the events and of the pressed keys since the previous
    frame.
    """

    step: float = 0.0
    gaps: Mapping[DistanceMeasure, float] = field(default_factory=dict)
    clip_ended: bool = False
    events: frozenset[str] = frozenset()
    keys: frozenset[str] = frozenset()


@dataclass(frozen=True)
class DistanceCondition:
    """Condition that the distance ``gap`` is less than ``distance``, or greater if ``closer`` is False."""

    kind: ClassVar[str] = "distance"
    gap: DistanceMeasure = DistanceMeasure()
    distance: float = 1.0
    closer: bool = True

    def __post_init__(self) -> None:
        if not (math.isfinite(self.distance) and self.distance >= 0.0):
            raise ValueError(f"The distance must be 0 or more, not {self.distance}.")
        PLACE_RANGE.check(self.distance)

    def is_met(self, senses: ConditionInput, seconds: float) -> bool:
        """True if the distance is below or above the limit in this frame; False if it was not measured."""
        apart = senses.gaps.get(self.gap)
        return apart is not None and (apart < self.distance if self.closer else apart > self.distance)


@dataclass(frozen=True)
class TimeCondition:
    """Condition that the state has lasted for ``seconds``."""

    kind: ClassVar[str] = "time"
    seconds: float = 1.0

    def __post_init__(self) -> None:
        if not (math.isfinite(self.seconds) and self.seconds >= 0.0):
            raise ValueError(f"The time must be 0 or more seconds, not {self.seconds}.")
        TIME_RANGE.check(self.seconds)

    def is_met(self, senses: ConditionInput, seconds: float) -> bool:
        """True if the condition is fulfilled ``seconds`` after the state began."""
        return seconds >= self.seconds


@dataclass(frozen=True)
class ClipEndCondition:
    """Condition that the state's clip has played once to its end, also if it loops."""

    kind: ClassVar[str] = "clip_end"

    def is_met(self, senses: ConditionInput, seconds: float) -> bool:
        """True if the state's clip has ended by this frame."""
        return senses.clip_ended


@dataclass(frozen=True)
class EventCondition:
    """Condition that the event named ``event`` was received from the partner or from outside.

    A partner sends the event of its state when that state begins.
    """

    kind: ClassVar[str] = "event"
    event: str

    def __post_init__(self) -> None:
        object.__setattr__(self, "event", self.event.strip())
        if not self.event:
            raise ValueError("An event needs a name, such as 'attack'.")

    def is_met(self, senses: ConditionInput, seconds: float) -> bool:
        """True if the event was received since the previous frame."""
        return self.event in senses.events


@dataclass(frozen=True)
class KeyCondition:
    """Condition that a key of the keyboard was pressed: a capital letter, a digit, or a name such as Space."""

    kind: ClassVar[str] = "key"
    key: str

    def __post_init__(self) -> None:
        key = self.key.strip()
        object.__setattr__(self, "key", key.upper() if len(key) == 1 else key)
        if not key:
            raise ValueError("A key is a letter, a digit, or a name such as Space.")

    def is_met(self, senses: ConditionInput, seconds: float) -> bool:
        """True if the key was pressed since the previous frame."""
        return self.key in senses.keys


Condition = DistanceCondition | TimeCondition | ClipEndCondition | EventCondition | KeyCondition
