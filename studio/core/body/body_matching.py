"""Recognition of a human body in a skeleton: names propose joints, then topology, bone lengths and symmetry decide."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise, product

import numpy as np
from numpy.typing import NDArray

from studio.core.body.humanoid import LIMB_PARTS, BodyMap, BodyPart
from studio.core.body.skeleton import Skeleton

FloatArray = NDArray[np.float64]
Candidates = Mapping[BodyPart, Sequence[int]]

MOST_BONE_VARIATION, MOST_LOOSE_BONE_VARIATION = 0.03, 0.2
"""Greatest standard deviation of the length of a bone relative to its mean, and the same for suits whose
joints drift.
"""
_MOST_ASYMMETRY = 0.25
"""Logarithm of the ratio of left to right from which two bones are no pair."""
_SHORTEST_BONE = 0.25
"""Least length of a limb's shorter bone, as a fraction of its longer one."""
_SHORTEST_CLAVICLE = 0.02
"""Fraction of the upper arm's length: a joint nearer to a shoulder counts as one more axis of the shoulder."""


@dataclass(frozen=True)
class _Limb:
    """Candidate for a limb: its joints, bone lengths and cost."""

    joints: tuple[int, ...]
    lengths: FloatArray
    """Lengths (2,) of its two bones."""
    cost: float


@dataclass(frozen=True)
class BodyMatch:
    """Result of the search for a body: its map, or the parts that were not found."""

    body_map: BodyMap | None
    missing: tuple[str, ...]
    """Names of the parts that were not found, such as ``left arm`` or ``spine``."""
    parts: int
    """Number of parts that were found."""


class BodySearch:
    """Search for a body in a skeleton, by some world positions (F, J, 3) of its joints in any unit."""

    def __init__(self, skeleton: Skeleton, positions: FloatArray, most_variation: float = MOST_BONE_VARIATION) -> None:
        self.skeleton = skeleton
        self.positions = positions
        self.most_variation = most_variation

    def best_match(self, candidates: Candidates) -> BodyMatch:
        """Best body whose joints are among ``candidates``, which list joints for each part, the likeliest first."""
        arms = self._pair(candidates, "left arm", "right arm")
        legs = self._pair(candidates, "left leg", "right leg")
        missing = [limb for limb in LIMB_PARTS if not (arms if "arm" in limb else legs)]
        if not (arms and legs):
            return BodyMatch(None, tuple(missing), 0)
        parts = dict(zip(LIMB_PARTS["left arm"] + LIMB_PARTS["right arm"], arms, strict=True))
        parts |= dict(zip(LIMB_PARTS["left leg"] + LIMB_PARTS["right leg"], legs, strict=True))
        return self._whole(candidates, parts)

    def match_around_limbs(self, limbs: Mapping[BodyPart, int], candidates: Candidates) -> BodyMatch:
        """Body with the given ``limbs``, whose bones may have any length but must be connected.

        Trunk, head and toes are taken from ``candidates``.
        """
        broken = [
            limb
            for limb, parts in LIMB_PARTS.items()
            if any(len(self.skeleton.path(limbs[a], limbs[b])) < 2 for a, b in pairwise(parts))
        ]
        return BodyMatch(None, tuple(broken), 0) if broken else self._whole(candidates, dict(limbs))

    def _whole(self, candidates: Candidates, parts: dict[BodyPart, int]) -> BodyMatch:
        """Body made of the limbs in ``parts`` and of the other joints that fit them."""
        spine = self._trunk(candidates, parts)
        if len(spine) < 2:
            return BodyMatch(None, ("spine",), 0)
        self._toes(candidates, parts)
        return BodyMatch(BodyMap(parts, spine), (), len(parts))

    def _pair(self, candidates: Candidates, left: str, right: str) -> tuple[int, ...]:
        """Left and right limb with the most similar bones; empty if there is no such pair."""
        best: tuple[float, tuple[int, ...]] = (np.inf, ())
        for one, other in product(self._limbs(candidates, left), self._limbs(candidates, right)):
            asymmetry = float(np.abs(np.log(one.lengths / other.lengths)).max())
            cost = one.cost + other.cost + asymmetry
            if asymmetry < _MOST_ASYMMETRY and cost < best[0] and not set(one.joints) & set(other.joints):
                best = (cost, one.joints + other.joints)
        return best[1]

    def _limbs(self, candidates: Candidates, limb: str) -> Iterator[_Limb]:
        for joints in product(*(candidates.get(part, ())[:6] for part in LIMB_PARTS[limb])):
            ways = [self.skeleton.path(a, b) for a, b in pairwise(joints)]
            if any(len(way) < 2 for way in ways):
                continue
            bones = [self._bone(a, b) for a, b in pairwise(joints)]
            lengths = np.array([length for length, _ in bones])
            variation = max(share for _, share in bones)
            if lengths.min() > _SHORTEST_BONE * lengths.max() and variation < self.most_variation:
                detours = sum(len(way) - 2 for way in ways)
                yield _Limb(joints, lengths, 5.0 * variation + 0.05 * detours)

    def _bone(self, start: int, end: int) -> tuple[float, float]:
        """Mean length of a bone, and its relative standard deviation."""
        lengths = np.linalg.norm(self.positions[:, end] - self.positions[:, start], axis=1)
        mean = float(lengths.mean())
        return mean, float(lengths.std() / mean) if mean > 0.0 else np.inf

    def _trunk(self, candidates: Candidates, parts: dict[BodyPart, int]) -> tuple[int, ...]:
        """Joints of the spine; pelvis, neck, head and clavicles are added to ``parts``."""
        arms = parts[BodyPart.LEFT_UPPER_ARM], parts[BodyPart.RIGHT_UPPER_ARM]
        chest = self.skeleton.common_ancestor(*arms)
        heads = self._heads(candidates, arms, chest)
        if heads and not self.skeleton.path(chest, heads[0]):
            chest = self.skeleton.common_ancestor(chest, heads[0])
        pelvis = self.skeleton.common_ancestor(parts[BodyPart.LEFT_THIGH], parts[BodyPart.RIGHT_THIGH], chest)
        named = [joint for joint in candidates.get(BodyPart.PELVIS, ())[:1] if self.skeleton.path(joint, pelvis)]
        parts[BodyPart.PELVIS] = pelvis if not named or pelvis != chest else named[0]
        clavicles = BodyPart.LEFT_CLAVICLE, BodyPart.RIGHT_CLAVICLE
        elbows = parts[BodyPart.LEFT_FOREARM], parts[BodyPart.RIGHT_FOREARM]
        for arm, elbow, clavicle in zip(arms, elbows, clavicles, strict=True):
            way = self.skeleton.path(chest, arm)
            if len(way) > 2 and self._bone(way[1], arm)[0] > _SHORTEST_CLAVICLE * self._bone(arm, elbow)[0]:
                parts[clavicle] = way[1]
        if heads:
            parts[BodyPart.HEAD] = heads[0]
            way = self.skeleton.path(chest, heads[0])
            if len(way) > 2:
                parts[BodyPart.NECK] = way[1]
        return self.skeleton.path(parts[BodyPart.PELVIS], chest)

    def _heads(self, candidates: Candidates, arms: tuple[int, int], chest: int) -> list[int]:
        """Deepest joint called head that hangs from the chest and is no part of an arm, in a list; empty if there is
        none.

        The tip of another such joint is passed over, unless no joint is called neck and the other one is the neck.
        """
        below_arms = {*arms, *self.skeleton.descendants(arms[0]), *self.skeleton.descendants(arms[1])}
        heads = [joint for joint in candidates.get(BodyPart.HEAD, ()) if joint not in below_arms]
        order = sorted(heads, key=lambda joint: (not self.skeleton.children[joint], -self.skeleton.depths[joint]))
        if order and not candidates.get(BodyPart.NECK) and len(self.skeleton.path(chest, order[0])) == 2:
            order = [joint for joint in self.skeleton.children[order[0]] if joint in heads] or order
        return order[:1]

    def _toes(self, candidates: Candidates, parts: dict[BodyPart, int]) -> None:
        for foot, toe in (
            (BodyPart.LEFT_FOOT, BodyPart.LEFT_TOE),
            (BodyPart.RIGHT_FOOT, BodyPart.RIGHT_TOE),
        ):
            for joint in candidates.get(toe, ()):
                if len(self.skeleton.path(parts[foot], joint)) > 1 and self._is_toe(parts[foot], joint):
                    parts[toe] = joint
                    break

    def _is_toe(self, foot: int, toe: int) -> bool:
        """True if ``toe`` lies a bone length away from the ankle ``foot`` and is no heel joint that carries the whole
        foot.
        """
        length, variation = self._bone(foot, toe)
        ends = [self._bone(toe, end)[0] for end in self.skeleton.descendants(toe)]
        return variation < self.most_variation and length > 0.5 * max(ends, default=0.0)
