"""Scope of a constraint: all performers of a motion, one performer, or one clip."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol, TypeVar


@dataclass(frozen=True)
class Scope:
    """Scope of a constraint or contact: all performers of the motion, one performer, or one clip wherever it plays.

    Both ids are empty for all performers.
    """

    performer_id: str = ""
    clip_id: str = ""

    def __post_init__(self) -> None:
        if self.performer_id and self.clip_id:
            raise ValueError("A scope can be a character or a clip, not both. A clip already belongs to its character.")

    @property
    def is_narrow(self) -> bool:
        """True unless the scope includes all performers of the motion."""
        return bool(self.performer_id or self.clip_id)

    def includes(self, performer_id: str, clip_id: str) -> bool:
        """True if the scope includes the clip ``clip_id`` as played by the performer."""
        if self.clip_id:
            return self.clip_id == clip_id
        return self.performer_id in ("", performer_id)

    def meets(self, other: "Scope") -> bool:
        """True if both scopes may include the same performer and clip."""
        alike = ((self.performer_id, other.performer_id), (self.clip_id, other.clip_id))
        return all(not mine or not theirs or mine == theirs for mine, theirs in alike)


EVERYONE = Scope()


class Scoped(Protocol):
    """Object with a scope."""

    @property
    def scope(self) -> Scope:
        """Performers or clip to which the object applies."""


Item = TypeVar("Item", bound=Scoped)


def in_scope_of(items: Mapping[str, Item], performer_id: str, clip_id: str) -> dict[str, Item]:
    """``items``, by id, whose scope includes a performer and a clip."""
    return {key: item for key, item in items.items() if item.scope.includes(performer_id, clip_id)}


def narrowest_scoped(items: Mapping[str, Item]) -> dict[str, Item]:
    """Items with the narrowest scope for each subject: a clip's before a performer's before everyone's."""
    ranks = {key: (bool(item.scope.clip_id), bool(item.scope.performer_id)) for key, item in items.items()}
    best = max(ranks.values(), default=None)
    return {key: item for key, item in items.items() if ranks[key] == best}
