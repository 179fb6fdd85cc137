"""Body maps of skeletons, found by the naming tables in ``resources/body_maps``."""

import json
import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.core.body.body_matching import MOST_BONE_VARIATION, MOST_LOOSE_BONE_VARIATION, BodyMatch, BodySearch
from studio.core.body.humanoid import LIMB_PARTS, BodyMap, BodyPart, is_spine, part_named
from studio.core.body.skeleton import Skeleton
from studio.core.errors import StudioError
from studio.core.rotations import normalized
from studio.io.json_text import read_json
from studio.resources_folder import resources_folder

FloatArray = NDArray[np.float64]

_SIDES = (
    {"side": "left", "Side": "Left", "s": "l", "S": "L", "j": "左"},
    {"side": "right", "Side": "Right", "s": "r", "S": "R", "j": "右"},
)
_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[^\W\d_A-Z]+|\d+")
_NUMBER_BEHIND = re.compile(r"[_.]\d+$")
_SIDE_WORDS = dict.fromkeys(("left", "l", "lft", "lf", "lt"), "left") | dict.fromkeys(
    ("right", "r", "rgt", "rt"), "right"
)
_NOISE = {"jnt", "joint", "bone", "bind", "def", "org", "skin", "stretch", "fk", "x", "c", "m"}
"""Words by which riggers tell deforming joints from their controls, and the middle of the body."""
_IN_LINE = np.cos(np.radians(20.0))
"""Cosine of the bend up to which a joint of a limb only divides its bone."""
_SHARED = 0.9
"""Fraction of the names that share a beginning which says nothing."""


@dataclass(frozen=True)
class NamingFamily:
    """Names that one group of programs gives to the joints of each part, the likeliest first."""

    name: str
    names: Mapping[BodyPart, tuple[str, ...]]


@dataclass(frozen=True)
class FoundBody:
    """Result of a search for a body: its map, the naming family by which it was found, and the missing parts."""

    body_map: BodyMap | None
    family: str
    missing: tuple[str, ...]


@lru_cache(maxsize=1)
def naming_families() -> tuple[NamingFamily, ...]:
    """All tables in ``resources/body_maps``, the most common first."""
    files = sorted((resources_folder() / "body_maps").glob("*.json"), key=lambda path: path.name)
    return tuple(_family(json.loads(path.read_text(encoding="utf-8"))) for path in files)


def find_body(skeleton: Skeleton, positions: FloatArray, chosen: Mapping[str, str] | None = None) -> FoundBody:
    """Body in ``skeleton``, found by names and by some world positions (F, J, 3) of its motion, in any unit.

    ``chosen`` names joints for parts (as in ``BodyMap.to_json``) that need no search; an empty name is for a part that
    the body lacks. If all limbs are chosen their bones are not checked. Raises StudioError if a chosen part or joint
    does not exist, or if the chosen ones do not make a body.
    """
    fixed = _fixed(skeleton, chosen or {})
    family, best = _best_match(skeleton, positions, fixed)
    if best.body_map is None:
        if fixed:
            raise _chosen_are_no_body(best)
        return FoundBody(None, "", best.missing)
    return FoundBody(_overruled(best.body_map, skeleton, chosen or {}, fixed), family, ())


def _best_match(skeleton: Skeleton, positions: FloatArray, fixed: dict[BodyPart, list[int]]) -> tuple[str, BodyMatch]:
    """Body found, and the family of its names; bones may change length only if no body has constant ones."""
    by_name = _joints_by_name(skeleton, positions)
    every = _candidates(_all_families(), by_name) | fixed
    limbs = {part: fixed.get(part) for parts in LIMB_PARTS.values() for part in parts}
    if all(limbs.values()):
        known = {part: joints[0] for part, joints in limbs.items() if joints}
        return "the chosen joints", BodySearch(skeleton, positions).match_around_limbs(known, every)
    for most in (MOST_BONE_VARIATION, MOST_LOOSE_BONE_VARIATION):
        search = BodySearch(skeleton, positions, most)
        tries = [(family.name, search.best_match(_candidates(family, by_name) | fixed)) for family in naming_families()]
        tries.append(("names of several families", search.best_match(every)))
        family, best = max(tries, key=lambda tried: (tried[1].parts, -len(tried[1].missing)))
        if best.body_map is not None:
            break
    return family, best


def find_preset(skeleton: Skeleton, positions: FloatArray, family: NamingFamily) -> BodyMap:
    """Body map whose joints have the names of ``family``. Raises StudioError, which lists the limbs without joints."""
    candidates = _candidates(family, _joints_by_name(skeleton, positions))
    match = BodySearch(skeleton, positions, MOST_LOOSE_BONE_VARIATION).best_match(candidates)
    if match.body_map is None:
        raise StudioError(
            f"The names of {family.name} show no {' and no '.join(match.missing)}. Choose another preset or joints."
        )
    return match.body_map


def read_body_map(path: Path) -> dict[str, str]:
    """Names of joints by part in a file, as in ``BodyMap.to_json``. Raises StudioError if the file holds something
    else.
    """
    names = read_json(path)
    if not isinstance(names, dict) or not all(isinstance(name, str) for name in names.values()):
        raise StudioError(f'{path}: a body map is a record of joints by part, {{"pelvis": "Hips", ...}}.')
    return names


def loose_feet(skeleton: Skeleton) -> dict[int, int]:
    """Shank of each foot that is not its child, by foot; empty for most files.

    Rigs for inverse kinematics keep feet below the root.
    """
    return _loose_ends(skeleton, "left leg", "right leg")


def loose_hands(skeleton: Skeleton) -> dict[int, int]:
    """Forearm of each hand that is not its child, by the hand."""
    return _loose_ends(skeleton, "left arm", "right arm")


def _loose_ends(skeleton: Skeleton, *limbs: str) -> dict[int, int]:
    candidates = _candidates(_all_families(), _joints_by_name(skeleton))
    ends: dict[int, int] = {}
    for limb in limbs:
        root, middle, end = (next(iter(candidates[part]), -1) for part in LIMB_PARTS[limb])
        if min(root, middle, end) < 0 or len(skeleton.path(root, middle)) < 2:
            continue
        if skeleton.path(middle, end) or (skeleton.path(end, root) and end != 0):
            continue
        ends[end] = middle
    return ends if len(ends) == len(limbs) else {}


def named_sides(skeleton: Skeleton) -> NDArray[np.int64]:
    """Sides (J,) of joints by their names: 1 left, -1 right, 0 neither."""
    places = {"left": 1, "right": -1}
    found = (
        next((_sided(part) for part in spellings if _sided(part)[:1] != " "), "") for spellings in _spellings(skeleton)
    )
    return np.array([places.get(words.partition(" ")[0], 0) for words in found])


def similar_joints(skeleton: Skeleton, limb: str) -> list[str]:
    """Names of joints that might belong to ``limb`` (``left arm``), as suggestions when it was not found."""
    parts = LIMB_PARTS.get(limb, (BodyPart.PELVIS, BodyPart.HEAD))
    words = {_plain(word) for part in parts for word in _all_families().names[part]}
    side = limb.split()[0]
    near = [
        name
        for name, end_site in zip(skeleton.names, skeleton.end_sites, strict=True)
        if not end_site and (_plain(name) in words or side in _plain(name))
    ]
    return near[:4]


def _family(table: dict[str, object]) -> NamingFamily:
    names: dict[BodyPart, tuple[str, ...]] = {}
    parts = table["parts"]
    assert isinstance(parts, dict)
    for part, words in parts.items():
        for side in _SIDES if "{side}" in part else _SIDES[:1]:
            names[BodyPart(part.format(**side))] = tuple(word.format(**side) for word in words)
    return NamingFamily(str(table["name"]), names)


@lru_cache(maxsize=1)
def _all_families() -> NamingFamily:
    names: dict[BodyPart, tuple[str, ...]] = {}
    for family in naming_families():
        for part, words in family.names.items():
            names[part] = (*names.get(part, ()), *(word for word in words if word not in names.get(part, ())))
    return NamingFamily("all", names)


@lru_cache(maxsize=4096)  # the words of all tables are asked for in every file
def _plain(name: str) -> str:
    return re.sub(r"[\W_]+", "", name).casefold()


@lru_cache(maxsize=4096)
def _sided(name: str, order: int = 1) -> str:
    """Normalised name, the same for ``thigh.L``, ``L_Thigh``, ``LeftThigh`` and ``left_thigh_jnt``: ``left thigh``.

    An ``order`` of -1 reverses the words.
    """
    words = [word.casefold() for word in _WORD.findall(name)]
    sides = {_SIDE_WORDS[word] for word in words if word in _SIDE_WORDS}
    rest = "".join([word for word in words if word not in _SIDE_WORDS and word not in _NOISE][::order])
    return f"{next(iter(sides), '')} {rest}" if len(sides) < 2 else ""


def _reversed(name: str) -> str:
    """Normalised name with its words reversed, so that ``arm_upper_L`` equals ``upper_arm.L``."""
    return _sided(name, -1)


def _joints_by_name(skeleton: Skeleton, positions: FloatArray | None = None) -> dict[str, list[int]]:
    """Joints by plain name, by the part after a prefix (``Character1_Hips``), by side and name; the most certain first.

    Last by the name without its number (``lThigh_042``, ``upperarm01.L``), of several in a limb the first, and others
    that do not lie in line with it in ``positions`` (F, J, 3): two joints of one name.
    """
    of_joints = [(joint, each) for joint, each in enumerate(_spellings(skeleton)) if not skeleton.end_sites[joint]]
    most = max(len(spellings) for _, spellings in of_joints)
    spelt = [(each[rank], joint) for rank in range(most) for joint, each in of_joints if rank < len(each)]
    keys = [(key(name), joint) for key in (_plain, _sided, _reversed) for name, joint in spelt]
    by_name: dict[str, list[int]] = {}
    for key, joint in keys:
        if joint not in by_name.setdefault(key, []):
            by_name[key].append(joint)
    numbered: dict[str, list[int]] = {}
    for name, joint in spelt:
        plain = _plain(name), _sided(name)
        for key in {_numberless(name, _plain), _numberless(name, _sided)}.difference(plain):
            above = numbered.setdefault(key, [])
            below = any(skeleton.path(upper, joint) for upper in (*by_name.get(key, ()), *above))
            of_limb = _sided(name)[:1] != " "
            if not below or (positions is not None and not (of_limb and _divides(skeleton, positions, joint))):
                above.append(joint)
    for key, joints in numbered.items():
        by_name[key] = list(dict.fromkeys([*by_name.get(key, []), *joints]))
    return by_name


def _divides(skeleton: Skeleton, positions: FloatArray, joint: int) -> bool:
    """True if a joint lies in line with its parent and the joints after it in all frames of ``positions`` (F, J, 3)."""
    before = normalized(positions[:, joint] - positions[:, skeleton.parents[joint]])
    after = normalized(positions[:, list(skeleton.children[joint])] - positions[:, joint, None])
    return bool((np.einsum("fi,fci->fc", before, after) > _IN_LINE).all())


def _numberless(name: str, key: Callable[[str], str]) -> str:
    """Key of a name without its final number, before or behind its side."""
    return re.sub(r"(part|seg|segment|section|piece)?\d+$", "", key(name)).rstrip()


def _spellings(skeleton: Skeleton) -> list[tuple[str, ...]]:
    """Spellings of each joint: its name, then without the prefix and the number that most names have, then suffixes of
    that.
    """
    named = [name for name, end_site in zip(skeleton.names, skeleton.end_sites, strict=True) if not end_site]
    beginning = _shared_beginning(named)
    numbered = sum(bool(_NUMBER_BEHIND.search(name)) for name in named) >= _SHARED * len(named)
    bare = [name.removeprefix(beginning) or name for name in skeleton.names]
    bare = [_NUMBER_BEHIND.sub("", name) for name in bare] if numbered else bare
    return [(name, short, *_suffixes(short)) for name, short in zip(skeleton.names, bare, strict=True)]


def _shared_beginning(names: list[str]) -> str:
    """Longest prefix, ``Bob:mixamorig``, shared by nine tenths of the names; empty if there is none."""
    beginnings = Counter(name[:length] for name in names for length in range(len(name) + 1))
    return max((each for each, count in beginnings.items() if count >= _SHARED * len(names)), key=len)


def _suffixes(name: str) -> Iterator[str]:
    """Suffixes of a name after its first three separators, and after ``mixamorig`` and the like without one."""
    for separator in list(re.finditer(r"[:_ .|-]", name))[:3]:
        yield name[separator.end() :]
    if run_in := re.match(r"mixamorig\d*|bip\d+|character\d+", name, re.IGNORECASE):
        yield name[run_in.end() :]


def _candidates(family: NamingFamily, by_name: dict[str, list[int]]) -> dict[BodyPart, list[int]]:
    candidates: dict[BodyPart, list[int]] = {}
    for part, words in family.names.items():
        joints = [joint for key in (_plain, _sided) for word in words for joint in by_name.get(key(word), [])]
        candidates[part] = list(dict.fromkeys(joints))
    return candidates


def _fixed(skeleton: Skeleton, chosen: Mapping[str, str]) -> dict[BodyPart, list[int]]:
    said = {part_named(key): name for key, name in chosen.items() if not is_spine(key)}
    return {part: [skeleton.index(name)] if name else [] for part, name in said.items()}


def _overruled(
    found: BodyMap, skeleton: Skeleton, chosen: Mapping[str, str], fixed: Mapping[BodyPart, list[int]]
) -> BodyMap:
    """Body map ``found`` with the user's choices put in, also where topology would decide otherwise."""
    if not chosen:
        return found
    parts = {part: joint for part, joint in found.parts.items() if part not in fixed}
    parts |= {part: joints[0] for part, joints in fixed.items() if joints}
    given = sorted((int(key[6:]), skeleton.index(name)) for key, name in chosen.items() if is_spine(key))
    chest = given[-1][1] if given else found.spine[-1]
    pelvis = parts.get(BodyPart.PELVIS, chest)  # without one, ``BodyMap`` says so
    return BodyMap(parts, (pelvis, *(joint for _, joint in given)) if given else skeleton.path(pelvis, chest))


def _chosen_are_no_body(best: BodyMatch) -> StudioError:
    return StudioError(
        f"With the chosen joints, no {' and no '.join(best.missing)} was found: the bones "
        "must hang below each other and be alike on both sides. Choose others in the inspector, under Body map."
    )
