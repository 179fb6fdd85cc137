"""Body map: the joints of a skeleton that move the parts of a human body."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from studio.core.body.canonical import BodyPart
from studio.core.body.skeleton import Skeleton
from studio.core.errors import StudioError

__all__ = ["LIMB_PARTS", "BodyMap", "BodyPart"]

LIMB_PARTS: dict[str, tuple[BodyPart, BodyPart, BodyPart]] = {
    "left arm": (BodyPart.LEFT_UPPER_ARM, BodyPart.LEFT_FOREARM, BodyPart.LEFT_HAND),
    "right arm": (BodyPart.RIGHT_UPPER_ARM, BodyPart.RIGHT_FOREARM, BodyPart.RIGHT_HAND),
    "left leg": (BodyPart.LEFT_THIGH, BodyPart.LEFT_SHANK, BodyPart.LEFT_FOOT),
    "right leg": (BodyPart.RIGHT_THIGH, BodyPart.RIGHT_SHANK, BodyPart.RIGHT_FOOT),
}
"""Parts of each limb from the trunk outwards; a body without one of them is no humanoid."""


@dataclass(frozen=True)
class BodyMap:
    """Map from body parts to joints: the joint at the proximal end of each part, and the joints of the spine.

    Neck, head, clavicles and toes may be absent. Raises StudioError if another part is absent or the spine is too
    short.
    """

    parts: Mapping[BodyPart, int]
    spine: tuple[int, ...]
    """All joints from the pelvis up to the joint from which neck and arms hang; at least two."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "parts", MappingProxyType(dict(self.parts)))
        needed = [BodyPart.PELVIS, *(part for limb in LIMB_PARTS.values() for part in limb)]
        missing = [part.label.lower() for part in needed if part not in self.parts]
        if missing:
            raise StudioError(
                f"No joint is mapped to {', '.join(missing)}. Choose one in the inspector, under Body map."
            )
        if len(self.spine) < 2 or self.spine[0] != self.parts[BodyPart.PELVIS]:
            raise StudioError("A body map needs a spine of two joints at least, from the pelvis upwards.")

    def __getitem__(self, part: BodyPart) -> int:
        return self.parts[part]

    def get(self, part: BodyPart) -> int | None:
        """Joint of ``part``; None if the body has none."""
        return self.parts.get(part)

    def with_sides_exchanged(self, names: Collection[str] | None = None) -> "BodyMap":
        """Copy with left and right exchanged, for all parts or for those in ``names``, such as ``THIGH``."""
        other = {"LEFT": "RIGHT", "RIGHT": "LEFT"}
        sides = ((part, joint, *part.name.partition("_")) for part, joint in self.parts.items())
        return BodyMap(
            {
                BodyPart[f"{other[side]}_{name}"] if side in other and (names is None or name in names) else part: joint
                for part, joint, side, _, name in sides
            },
            self.spine,
        )

    def with_descendants(self, skeleton: Skeleton) -> list[int]:
        """Joints of the body and all their descendants, without their ancestors: the root of a file may be far away."""
        mapped = {*self.spine, *self.parts.values()}
        return sorted(mapped.union(*(skeleton.descendants(joint) for joint in mapped)))

    def to_json(self, skeleton: Skeleton) -> dict[str, str]:
        """Names of joints by part: ``{"pelvis": "Hips", "spine_1": "Spine", ..., "head": "Head", ...}``."""
        names = {"pelvis": skeleton.names[self.spine[0]]}
        names |= {f"spine_{k}": skeleton.names[joint] for k, joint in enumerate(self.spine[1:], 1)}
        return names | {
            part.value: skeleton.names[self.parts[part]]
            for part in BodyPart
            if part in self.parts and part is not BodyPart.PELVIS
        }

    @classmethod
    def from_json(cls, skeleton: Skeleton, names: Mapping[str, str]) -> "BodyMap":
        """Body map from joint ``names`` by part; raises StudioError for unknown parts or joints."""
        parts = {part_named(key): skeleton.index(name) for key, name in names.items() if not is_spine(key)}
        spine = sorted((int(key[6:]), skeleton.index(name)) for key, name in names.items() if is_spine(key))
        pelvis = (parts[BodyPart.PELVIS],) if BodyPart.PELVIS in parts else ()
        return cls(parts, pelvis + tuple(joint for _, joint in spine))


def is_spine(key: str) -> bool:
    """True if ``key`` names a vertebra: ``spine_1``, ``spine_2`` ..."""
    return key.startswith("spine_") and key[6:].isdecimal()


def part_named(key: str) -> BodyPart:
    """Body part with the key ``key``. Raises StudioError, which lists the existing keys."""
    try:
        return BodyPart(key)
    except ValueError:
        raise StudioError(f"'{key}' is not a part of a body. Parts are {', '.join(BodyPart)}.") from None
