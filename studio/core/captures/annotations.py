"""Annotations of a motion: its contacts, constraints and labels."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Self

from studio.core.captures.contacts import ContactInterval
from studio.core.constraints.base import Constraint


@dataclass(frozen=True)
class Label:
    """Named range of a motion: frames ``first`` to ``last``, both included."""

    name: str
    first: int
    last: int
    motion_id: str = ""

    def __post_init__(self) -> None:
        if not 0 <= self.first <= self.last:
            raise ValueError(f"A label runs from a frame to a later one, not from {self.first} to {self.last}.")


def labels_in_range(labels: Iterable[Label], first: int, last: int) -> tuple[Label, ...]:
    """Labels cut to the frames ``first`` to ``last``, which are then counted from ``first``."""
    return tuple(
        replace(each, first=max(each.first, first) - first, last=min(each.last, last) - first)
        for each in labels
        if each.first <= last and each.last >= first
    )


@dataclass(frozen=True)
class Annotations:
    """Contacts, constraints and labels of one motion; ``contacts`` is None if they are unknown."""

    contacts: tuple[ContactInterval, ...] | None = None
    constraints: tuple[Constraint, ...] = ()
    labels: tuple[Label, ...] = ()

    def of_motion(self, motion_id: str) -> Self:
        """Copy whose annotations refer to the motion ``motion_id``."""
        contacts = self.contacts and tuple(replace(each, motion_id=motion_id) for each in self.contacts)
        constraints = tuple(replace(each, motion_id=motion_id) for each in self.constraints)
        labels = tuple(replace(each, motion_id=motion_id) for each in self.labels)
        return replace(self, contacts=contacts, constraints=constraints, labels=labels)
