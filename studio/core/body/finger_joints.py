"""Joints of fingers, found below the hands of a skeleton by the words in their names."""

import re
from collections.abc import Mapping
from enum import StrEnum
from typing import NamedTuple

from studio.core.body.canonical import BodyPart
from studio.core.body.humanoid import BodyMap
from studio.core.body.skeleton import Skeleton


class Digit(StrEnum):
    """Finger of a hand."""

    THUMB = "thumb"
    INDEX = "index"
    MIDDLE = "middle"
    RING = "ring"
    LITTLE = "little"


class FingerJoint(NamedTuple):
    """Joint of a finger, identified independently of any skeleton."""

    side: int
    """0 is left, 1 is right."""
    digit: Digit
    place: int
    """Rank of the joint in its finger: 0 is next to the palm, 2 is the last that bends."""

    @property
    def cell(self) -> tuple[int, int, int]:
        """Index in arrays with the axes side, digit and joint."""
        return self.side, tuple(Digit).index(self.digit), self.place


JOINTS_PER_FINGER = 3
_WORDS = {
    Digit.THUMB: r"thumb|親指",
    Digit.INDEX: r"index|人差?指",
    Digit.MIDDLE: r"mid|中指",
    Digit.RING: r"(?<!st)(?<!sp)ring|薬指",
    Digit.LITTLE: r"pink(y|ie)|little|小指",
}
_NUMBERED = re.compile(r"(?:finger|digit|phalangeal|carpometacarpal)[ _-]?(\d)")
"""Fingers by number: Biped counts from 0, MakeHuman, Rokoko and H-Anim from 1."""
_IN_PALM = re.compile(r"^(?!.*phalangeal).*(carpal|in_?hand)")
"""Names of metacarpal joints, at which only the thumb bends."""


def find_fingers(skeleton: Skeleton, body: BodyMap) -> dict[FingerJoint, int]:
    """Joint of ``skeleton`` for each finger joint that is found; metacarpal bones and finger tips are left out."""
    found: dict[FingerJoint, int] = {}
    for side, part in enumerate((BodyPart.LEFT_HAND, BodyPart.RIGHT_HAND)):
        for digit, chain in _chains(skeleton, body[part]).items():
            found |= {FingerJoint(side, digit, index): joint for index, joint in enumerate(chain)}
    digits = list(Digit)
    return dict(sorted(found.items(), key=lambda item: (item[0].side, digits.index(item[0].digit), item[0].place)))


def _chains(skeleton: Skeleton, hand: int) -> Mapping[Digit, list[int]]:
    """Joints of each finger from the palm outwards, at most ``JOINTS_PER_FINGER``."""
    below: list[int] = [hand]
    for joint, parent in enumerate(skeleton.parents.tolist()):
        if parent in below and not skeleton.end_sites[joint]:
            below.append(joint)
    names = {joint: skeleton.names[joint].lower() for joint in below[1:]}
    numbers = {joint: int(match[1]) for joint, name in names.items() if (match := _NUMBERED.search(name))}
    first = min(numbers.values(), default=0)
    digits = list(Digit)
    chains: dict[Digit, list[int]] = {}
    for joint, name in names.items():
        words = {match.start(): each for each, word in _WORDS.items() if (match := re.search(word, name))}
        digit = words[min(words)] if words else None  # ``ring_middle`` is a ring finger
        if digit is None and joint in numbers and numbers[joint] - first < len(digits):
            digit = digits[numbers[joint] - first]
        if digit is None or (digit is not Digit.THUMB and _IN_PALM.search(name)):
            continue
        chain = chains.setdefault(digit, [])
        if not chain or chain[-1] in skeleton.path(hand, joint):
            chain.append(joint)
    return {digit: _without_palm(skeleton, chain)[:JOINTS_PER_FINGER] for digit, chain in chains.items()}


def _without_palm(skeleton: Skeleton, chain: list[int]) -> list[int]:
    """Chain of a finger without its metacarpal bone.

    It has one if it has more joints than a finger has, and only the first bears no number.
    """
    unnumbered = [not re.search(r"\d", skeleton.names[joint]) for joint in chain]
    return chain[1:] if len(chain) > JOINTS_PER_FINGER and unnumbered[0] and not any(unnumbered[1:]) else chain
