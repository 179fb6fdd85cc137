"""Recognition of a human body in a skeleton without names, by the shape of a standing figure."""

from itertools import combinations, pairwise

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyPart
from studio.core.body.humanoid import LIMB_PARTS, BodyMap
from studio.core.body.skeleton import Skeleton
from studio.core.rotations import normalized

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

_ALIKE = 0.2
"""Difference of two bones, in parts of the longer or of the mean bone of their limb, up to which they may be a pair."""
_AS_LONG = 0.95
"""Parts of the longest two bones of an arm from which other two may be the upper and the lower one."""
_SEEN_BEND = 0.1
"""Sum of the mean sines by which two knees bend, from which their direction is known."""
_MOST_LEAVES = 120
_STRAIGHT, _PARTS = np.radians(3.0), 2.0
"""Bend of a joint that divides a bone, and the ratio of the parts, at most."""
_UPPER_ARM_TO_FOREARM, _THIGH_TO_SHANK, _ARM_TO_LEG = (0.8, 1.8), (0.7, 1.4), (0.45, 0.9)
"""Least and greatest ratios of lengths, of people and of their skeletons."""
_LEAST_BENT = 3
"""Joints of a limb that bend, as its root, its middle and its end do, where others may only divide it."""
_Pair = tuple[list[int], list[int]]


def body_by_shape(skeleton: Skeleton, points: FloatArray, sides: IntArray | None = None) -> BodyMap | None:
    """Body of a standing figure whose joints are at ``points`` (J, 3), Z up; None if the shape is not human.

    Legs reach lowest, arms widest, the head highest. ``sides`` (J,) are the sides known from names: 1 left, -1 right, 0
    unknown. Without names, the toes show the front (+X without toes), and hips and shoulders are left or right of it.
    """
    pairs = _mirrored_chains(skeleton, points)
    if len(pairs) < 2:
        return None
    legs = _with_longest_feet(points, min(pairs, key=lambda pair: sum(points[chain[-1], 2] for chain in pair)), pairs)
    used = {*legs[0], *legs[1]}
    others = [pair for pair in pairs if not used & {*pair[0], *pair[1]} and _above(points, pair, legs)]
    if not others:
        return None
    arms = max(others, key=lambda pair: float(np.linalg.norm(points[pair[0][-1]] - points[pair[1][-1]])))
    parts: dict[BodyPart, int] = {}
    if not _upright(points, arms, legs):
        return None
    forward = _forward(points, legs)
    sides = np.zeros(len(points), dtype=np.int64) if sides is None else sides
    legs, arms = (_sorted_by_side(points, pair, forward, sides) for pair in (legs, arms))
    hip = _longest(points, legs[0])
    shoulder = _shoulder(points, arms, float(np.linalg.norm(points[legs[0][hip]] - points[legs[1][hip]])))
    for side, leg, arm in zip(("LEFT", "RIGHT"), legs, arms, strict=True):
        parts |= _limb(side, ("THIGH", "SHANK", "FOOT", "TOE"), leg[hip:])
        parts |= _limb(side, ("UPPER_ARM", "FOREARM", "HAND"), arm[shoulder:])
        if shoulder:
            parts[BodyPart[f"{side}_CLAVICLE"]] = arm[0]
    return _with_trunk(skeleton, points, parts)


def moving_body_by_shape(skeleton: Skeleton, rest: FloatArray, points: FloatArray, sides: IntArray) -> BodyMap | None:
    """Body by the shape of its rest pose ``rest`` (J, 3), Z up, and by its motion ``points`` (F, J, 3) in any axes.

    The motion shows which joints only divide a bone and, where names give no side, which knee is left. None if the
    shape is not human or a limb ends before its hand or foot.
    """
    kept = np.flatnonzero(~_dividing(skeleton, points))
    place = {int(joint): new for new, joint in enumerate(kept)}
    above = skeleton.parents.tolist()
    while any(parent >= 0 and parent not in place for parent in above):
        above = [parent if parent < 0 or parent in place else above[parent] for parent in above]
    parents = np.array([place.get(above[joint], -1) for joint in kept.tolist()])
    names = tuple(skeleton.names[joint] for joint in kept.tolist())
    undivided = Skeleton(names, parents, skeleton.offsets[kept], skeleton.end_sites[kept])
    found = body_by_shape(undivided, rest[kept], sides[kept])
    if found is None:
        return None
    if not sides.any() and knees_bend_backwards(found, points[:, kept]):
        found = found.with_sides_exchanged()
    parts = {part: int(kept[joint]) for part, joint in found.parts.items()}
    parts = {part: joint for part, joint in parts.items() if not skeleton.end_sites[joint]}
    if BodyPart.HEAD in parts:
        parts[BodyPart.HEAD] = _turning_end(skeleton, points, parts[BodyPart.HEAD])
    if any(part not in parts for limb in LIMB_PARTS.values() for part in limb):
        return None
    return BodyMap(parts, skeleton.path(parts[BodyPart.PELVIS], int(kept[found.spine[-1]])))


def has_human_limbs(skeleton: Skeleton, body: BodyMap) -> bool:
    """True if the bones of arms and legs of ``body`` have human ratios of their lengths."""

    def length(part: str, end: str) -> float:
        """Length of the bones of both sides from one part to another."""
        paths = [
            skeleton.path(body[BodyPart[f"{side}_{part}"]], body[BodyPart[f"{side}_{end}"]])
            for side in ("LEFT", "RIGHT")
        ]
        return sum(float(np.linalg.norm(skeleton.offsets[joint])) for _, *below in paths for joint in below)

    upper_arm, forearm = length("UPPER_ARM", "FOREARM"), length("FOREARM", "HAND")
    thigh, shank = length("THIGH", "SHANK"), length("SHANK", "FOOT")
    ratios = (
        (upper_arm, forearm, _UPPER_ARM_TO_FOREARM),
        (thigh, shank, _THIGH_TO_SHANK),
        (upper_arm + forearm, thigh + shank, _ARM_TO_LEG),
    )
    return all(least * whole <= bone <= most * whole for bone, whole, (least, most) in ratios)


def _turning_end(skeleton: Skeleton, points: FloatArray, joint: int) -> int:
    """Last joint, from ``joint`` outwards, that rotates relative to its parent: the head, above a neck of several
    joints.
    """
    while len(skeleton.children[joint]) == 1 and len(skeleton.children[below := skeleton.children[joint][0]]) == 1:
        end = skeleton.children[below][0]
        near, far = normalized(points[:, below] - points[:, joint]), normalized(points[:, end] - points[:, below])
        if np.ptp(np.arccos(np.clip(np.einsum("fi,fi->f", near, far), -1.0, 1.0))) < _STRAIGHT:
            break
        joint = below
    return joint


def _dividing(skeleton: Skeleton, points: FloatArray) -> NDArray[np.bool_]:
    """Mask (J,) of joints that only divide the bone of a limb: they stay straight while other joints of the
    limb bend.
    """
    dividing = np.zeros(skeleton.joint_count, dtype=bool)
    for leaf in range(skeleton.joint_count):
        chain = [leaf]
        while (parent := int(skeleton.parents[chain[0]])) >= 0 and len(skeleton.children[parent]) == 1:
            chain.insert(0, parent)
        if skeleton.children[leaf] or parent < 0 or len(chain) < 3:
            continue
        bones = np.diff(points[:, [parent, *chain]], axis=1)
        lengths = np.linalg.norm(bones, axis=2).mean(axis=0)
        along = np.einsum("fbi,fbi->fb", normalized(bones[:, :-1]), normalized(bones[:, 1:]))
        alike = np.maximum(lengths[:-1], lengths[1:]) < _PARTS * np.minimum(lengths[:-1], lengths[1:])
        straight = along.min(axis=0) > np.cos(_STRAIGHT)
        if np.count_nonzero(~straight) >= _LEAST_BENT:
            dividing[np.array(chain[:-2], dtype=int)] = (straight & alike)[:-1]
            if straight[-1] and alike[-1]:
                dividing[chain[-2]] = _divides_the_last_bone(points, [j for j in chain[:-2] if not dividing[j]], chain)
    return dividing


def _divides_the_last_bone(points: FloatArray, bent: list[int], chain: list[int]) -> bool:
    """True if the last two bones of a limb together match the length of the bone before better than the first of them.

    A hand that stays in line with its forearm does not divide it. ``bent`` are the joints of ``chain`` before it.
    """
    if len(bent) < 2:
        return False
    upper, lower = bent[-2:]
    before, near, far = (
        float(np.linalg.norm(points[:, end] - points[:, start], axis=1).mean())
        for start, end in ((upper, lower), (lower, chain[-2]), (lower, chain[-1]))
    )
    if min(before, near, far) <= 0.0:  # joints in one place
        return False
    return bool(abs(np.log(far / before)) < abs(np.log(near / before)))


def _mirrored_chains(skeleton: Skeleton, points: FloatArray) -> list[_Pair]:
    """Pairs of chains of at least three joints, with similar bones, from their common ancestor outwards."""
    leaves = [joint for joint in range(skeleton.joint_count) if not skeleton.children[joint]]
    pairs = []
    for one, other in combinations(leaves[:_MOST_LEAVES], 2):
        root = skeleton.common_ancestor(one, other)
        chains = list(skeleton.path(root, one))[1:], list(skeleton.path(root, other))[1:]
        if len(chains[0]) != len(chains[1]) or len(chains[0]) < 3:
            continue
        lengths = [[float(np.linalg.norm(points[b] - points[a])) for a, b in pairwise([root, *c])] for c in chains]
        mean = float(np.mean(lengths))
        if all(abs(a - b) <= _ALIKE * max(a, b, mean) for a, b in zip(*lengths, strict=True)):
            pairs.append(chains)
    return pairs


def _above(points: FloatArray, arms: _Pair, legs: _Pair) -> bool:
    return bool(min(points[chain[0], 2] for chain in arms) > max(points[chain[0], 2] for chain in legs))


def _upright(points: FloatArray, arms: _Pair, legs: _Pair) -> bool:
    """True if the shoulders are above the hips. Those of an animal are in front of them."""
    trunk = sum(points[chain[0]] for chain in arms) - sum(points[chain[0]] for chain in legs)
    return bool(trunk[2] > np.linalg.norm(trunk[:2]))


def _forward(points: FloatArray, legs: _Pair) -> FloatArray:
    toes = sum((points[chain[-1]] - points[chain[_longest(points, chain) + 2]] for chain in legs), np.zeros(3))
    toes[2] = 0.0
    return toes if np.linalg.norm(toes) > 1e-6 else np.array([1.0, 0.0, 0.0])


def knees_bend_backwards(body_map: BodyMap, points: FloatArray) -> bool:
    """True if the knees of ``points`` (F, J, 3), in any axes, bend as if left and right were exchanged."""
    left = points[:, body_map[BodyPart.LEFT_THIGH]] - points[:, body_map[BodyPart.RIGHT_THIGH]]
    bends = 0.0
    for side in ("LEFT", "RIGHT"):
        hip, knee, ankle = (points[:, body_map[BodyPart[f"{side}_{part}"]]] for part in ("THIGH", "SHANK", "FOOT"))
        bend = np.cross(normalized(knee - hip), normalized(ankle - knee))
        bends += float(np.einsum("fi,fi->f", bend, normalized(left)).mean())
    return bends < -_SEEN_BEND


def _sorted_by_side(points: FloatArray, pair: _Pair, forward: FloatArray, sides: IntArray) -> _Pair:
    """Pair of limbs with the left one first."""
    left = np.array([-forward[1], forward[0], 0.0])
    one, other = pair
    named = int(sides[one].sum() - sides[other].sum())
    roots = points[one[_longest(points, one)]] - points[other[_longest(points, other)]]
    return (one, other) if (named or roots @ left) > 0 else (other, one)


def _longest(points: FloatArray, chain: list[int]) -> int:
    """Index in a chain at which its two longest consecutive bones begin."""
    return int(np.argmax(_two_bones(points, chain)))


def _two_bones(points: FloatArray, chain: list[int]) -> FloatArray:
    """(n - 2,) lengths of each two consecutive bones of a chain of n joints."""
    bones = np.linalg.norm(np.diff(points[chain], axis=0), axis=1)
    return np.asarray(bones[:-1] + bones[1:])


def _shoulder(points: FloatArray, arms: _Pair, hips: float) -> int:
    """Index in both arms at which their longest bones begin; of equally long ones the first as far apart as
    the hips.
    """
    both = _two_bones(points, arms[0])
    apart = np.linalg.norm(points[arms[0]] - points[arms[1]], axis=1)[: len(both)]
    fitting = np.flatnonzero((both >= _AS_LONG * both.max()) & (apart >= hips))
    return int(fitting[0]) if len(fitting) else int(np.argmax(both))


def _with_longest_feet(points: FloatArray, legs: _Pair, pairs: list[_Pair]) -> _Pair:
    """Pair with the bones of ``legs`` and the longest feet among ``pairs``: those with toes and not heels."""
    ankle = _longest(points, legs[0]) + 2
    same = [pair for pair in pairs if all(a[: ankle + 1] == b[: ankle + 1] for a, b in zip(pair, legs, strict=True))]
    return max(same, key=lambda pair: float(np.linalg.norm(points[pair[0][-1]] - points[pair[0][ankle]])))


def _limb(side: str, names: tuple[str, ...], chain: list[int]) -> dict[BodyPart, int]:
    return {BodyPart[f"{side}_{name}"]: joint for name, joint in zip(names, chain, strict=False)}


def _with_trunk(skeleton: Skeleton, points: FloatArray, parts: dict[BodyPart, int]) -> BodyMap | None:
    chest = skeleton.common_ancestor(parts[BodyPart.LEFT_UPPER_ARM], parts[BodyPart.RIGHT_UPPER_ARM])
    pelvis = skeleton.common_ancestor(parts[BodyPart.LEFT_THIGH], parts[BodyPart.RIGHT_THIGH], chest)
    spine = skeleton.path(pelvis, chest)
    if len(spine) < 2:
        return None
    limbs = {*parts.values()}
    for limb in list(limbs):
        limbs |= set(skeleton.descendants(limb))
    heads = [joint for joint in skeleton.descendants(chest) if joint not in limbs and not skeleton.children[joint]]
    if heads:
        crown = max(heads, key=lambda joint: points[joint, 2])
        way = [joint for joint in skeleton.path(chest, crown)[1:] if not skeleton.end_sites[joint]] or [crown]
        parts[BodyPart.HEAD] = way[min(1, len(way) - 1)]
        if len(way) > 1:
            parts[BodyPart.NECK] = way[0]
    parts[BodyPart.PELVIS] = pelvis
    return BodyMap(parts, spine)
