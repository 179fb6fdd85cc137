"""Of whom something is asked of a motion: of all who play it, of one performer, or of one clip."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol, TypeVar


@dataclass(frozen=True)
class Scope:
    """Nothing named is all who play the motion; else one performer, or the clip of that id wherever it is played."""

    performer_id: str = ""
    clip_id: str = ""

    def __post_init__(self) -> None:
        if self.performer_id and self.clip_id:
            raise ValueError("A scope names a performer or a clip, not both. A clip already belongs to its performer.")

    @property
    def is_narrow(self) -> bool:
        """Whether it is not all who play the motion."""
        return bool(self.performer_id or self.clip_id)

    def includes(self, performer_id: str, clip_id: str) -> bool:
        """Whether what a performer plays as that clip is meant."""
        if self.clip_id:
            return self.clip_id == clip_id
        return self.performer_id in ("", performer_id)

    def meets(self, other: "Scope") -> bool:
        """Whether there may be somebody whom both mean."""
        alike = ((self.performer_id, other.performer_id), (self.clip_id, other.clip_id))
        return all(not mine or not theirs or mine == theirs for mine, theirs in alike)


EVERYONE = Scope()


class Scoped(Protocol):
    """What has a scope."""

    @property
    def scope(self) -> Scope:
        """Of whom it is asked."""


Item = TypeVar("Item", bound=Scoped)


def meant_for(items: Mapping[str, Item], performer_id: str, clip_id: str) -> dict[str, Item]:
    """Those of ``items`` that mean what a performer plays as a clip, by id."""
    return {key: item for key, item in items.items() if item.scope.includes(performer_id, clip_id)}


def narrowest(items: Mapping[str, Item]) -> dict[str, Item]:
    """Of items about one thing those with the narrowest scope: a clip's before a performer's before everyone's."""
    ranks = {key: (bool(item.scope.clip_id), bool(item.scope.performer_id)) for key, item in items.items()}
    best = max(ranks.values(), default=None)
    return {key: item for key, item in items.items() if ranks[key] == best}
