"""HIERARCHY block of a BVH file: joints, offsets and channels, read word by word without recursion."""

import re
from dataclasses import dataclass, field

from studio.core.errors import StudioError
from studio.io.numbers import glued_words, number, separated_numbers

_MOST_JOINTS = 4096
_KINDS = {
    "position": ("position", "pos", "translation"),
    "rotation": ("rotation", "rot"),
    "scale": ("scale", "scaling"),
}
_CHANNELS = {
    f"{axis}{word}".lower(): f"{axis}{kind}" for axis in "XYZ" for kind, words in _KINDS.items() for word in words
}
_OFFSET = re.compile(r"\s*OFFSET(?=[\s\d.+-])", re.IGNORECASE)
_KEYWORDS = {"ROOT", "JOINT", "END", "OFFSET", "CHANNELS", "MOTION", "{", "}"}


def _parted(offset: str) -> str:
    """OFFSET line with a blank before each of its numbers."""
    return separated_numbers(re.sub(r"(?<=T)(?=[\d.+-])", " ", offset, count=1, flags=re.IGNORECASE))


@dataclass
class Hierarchy:
    """Joints of a BVH file in its order, offsets in its units, channels in the order of its numbers."""

    names: list[str] = field(default_factory=list)
    parents: list[int] = field(default_factory=list)
    offsets: list[tuple[float, float, float]] = field(default_factory=list)
    channels: list[tuple[str, ...]] = field(default_factory=list)
    end_sites: list[bool] = field(default_factory=list)
    places: list[str] = field(default_factory=list)
    """File and line of each joint, for messages."""
    repairs: list[str] = field(default_factory=list)


class _Words:
    """Words of the file with their lines, from HIERARCHY up to MOTION."""

    def __init__(self, name: str, lines: list[str]) -> None:
        self.name = name
        self.glued = [at for at, line in enumerate(lines, 1) if _OFFSET.match(line) and _parted(line) != line]
        """Lines of offsets whose numbers have no blank between them."""
        whole = (_parted(line) if at in self.glued else line for at, line in enumerate(lines, 1))
        spaced = (line.replace("{", " { ").replace("}", " } ") for line in whole)
        self._words = [(word, at) for at, line in enumerate(spaced, 1) for word in line.split()]
        self._next = 0
        self._last_line = len(lines)

    def __bool__(self) -> bool:
        return self._next < len(self._words)

    @property
    def where(self) -> str:
        """File and line of the next word."""
        line = self._words[self._next][1] if self else self._last_line
        return f"{self.name}, line {line}"

    def peek(self) -> str:
        return self._words[self._next][0] if self else ""

    def take(self, expected: str) -> str:
        if not self:
            raise StudioError(f"{self.where}: the file ends where {expected} should stand. It seems to be cut off.")
        self._next += 1
        return self._words[self._next - 1][0]

    def take_number(self, expected: str) -> float:
        where = self.where
        return number(self.take(expected), where)

    def take_name(self) -> str:
        """Name of a joint: all words up to the brace, since names may contain spaces; on its own line, any word but a
        brace.
        """
        words: list[str] = []
        line = self._words[self._next - 1][1]
        while self and self.peek() not in ("{", "}"):
            if self._words[self._next][1] > line and words and self.peek().upper() in _KEYWORDS:
                break
            words.append(self.take("a name"))
        return " ".join(words)


def read_hierarchy(name: str, lines: list[str]) -> Hierarchy:
    """Joints declared by ``lines``, from the first line of the file ``name`` up to MOTION."""
    words = _Words(name, lines)
    hierarchy = Hierarchy(repairs=glued_words(name, words.glued))
    if words.take("HIERARCHY").lstrip("\ufeff").upper() != "HIERARCHY":
        raise StudioError(f"{name}, line 1: a BVH file begins with HIERARCHY, this one does not. Choose a BVH file.")
    open_joints: list[int] = []
    while words:
        where = words.where
        match words.take("a joint").upper():
            case "ROOT" | "JOINT" as kind:
                open_joints.append(_begin_joint(hierarchy, words, open_joints, kind, where))
            case "END" | "ENDSITE":
                open_joints.append(_begin_end_site(hierarchy, words, open_joints, where))
            case "OFFSET":
                _read_offset(hierarchy, words, _innermost(open_joints, "OFFSET", where))
            case "CHANNELS":
                _read_channels(hierarchy, words, _innermost(open_joints, "CHANNELS", where), where)
            case "}":
                _innermost(open_joints, "}", where)
                open_joints.pop()
            case other:
                raise StudioError(f"{where}: '{other[:40]}' is not expected here. Correct that line.")
    if not hierarchy.names:
        raise StudioError(f"{words.where}: no ROOT joint is declared. Choose a complete BVH file.")
    if open_joints:
        joint = hierarchy.names[open_joints[-1]]
        place = hierarchy.places[open_joints[-1]]
        hierarchy.repairs.append(f"{place}: the brace of joint '{joint}' is never closed; it was closed before MOTION.")
    _make_names_unique(hierarchy)
    _join_roots(hierarchy)
    return hierarchy


def _innermost(open_joints: list[int], word: str, where: str) -> int:
    if not open_joints:
        raise StudioError(f"{where}: {word} stands outside every joint. Correct the braces above it.")
    return open_joints[-1]


def _begin_joint(hierarchy: Hierarchy, words: _Words, open_joints: list[int], kind: str, where: str) -> int:
    if kind == "ROOT" and open_joints:
        raise StudioError(f"{where}: a root stands inside a joint. Correct the braces above it.")
    name = words.take_name()
    if not name:
        name = f"joint{len(hierarchy.names)}"
        hierarchy.repairs.append(f"{where}: this joint has no name; it was called '{name}'.")
    return _begin(hierarchy, words, name, open_joints, False, where)


def _begin_end_site(hierarchy: Hierarchy, words: _Words, open_joints: list[int], where: str) -> int:
    parent = _innermost(open_joints, "End Site", where)
    words.take_name()
    return _begin(hierarchy, words, f"{hierarchy.names[parent]}_end", open_joints, True, where)


def _begin(hierarchy: Hierarchy, words: _Words, name: str, open_joints: list[int], end_site: bool, where: str) -> int:
    if len(hierarchy.names) >= _MOST_JOINTS:
        raise StudioError(f"{where}: more than {_MOST_JOINTS} joints are declared. That is not a body; check the file.")
    if words.peek() != "{":
        raise StudioError(f"{words.where}: '{{' is missing after joint '{name[:40]}'. Correct that line.")
    words.take("'{'")
    hierarchy.names.append(name)
    hierarchy.parents.append(open_joints[-1] if open_joints else -1)
    hierarchy.offsets.append((0.0, 0.0, 0.0))
    hierarchy.channels.append(())
    hierarchy.end_sites.append(end_site)
    hierarchy.places.append(where)
    return len(hierarchy.names) - 1


def _read_offset(hierarchy: Hierarchy, words: _Words, joint: int) -> None:
    x, y, z = (words.take_number("three numbers of an OFFSET") for _ in range(3))
    hierarchy.offsets[joint] = (x, y, z)


def _read_channels(hierarchy: Hierarchy, words: _Words, joint: int, where: str) -> None:
    name = hierarchy.names[joint]
    count = words.take_number("the number of channels")
    if count not in range(10):
        raise StudioError(f"{where}: joint '{name}' declares {count:g} channels; a joint has 0 to 9. Correct it.")
    channels: list[str] = []
    for _ in range(int(count)):
        at, word = words.where, words.take("a channel")
        channel = _CHANNELS.get(word.lower().replace("_", ""))
        if channel is None:
            raise StudioError(
                f"{at}: '{word[:40]}' is not a channel. Channels are Xposition, Xrotation and so on for Y and Z."
            )
        if channel in channels:
            raise StudioError(f"{at}: joint '{name}' declares {channel} twice. Correct that line.")
        channels.append(channel)
    hierarchy.channels[joint] = tuple(channels)


def _join_roots(hierarchy: Hierarchy) -> None:
    """Put several roots, which programs write for props beside a body, below one root that never moves."""
    others = [joint for joint, parent in enumerate(hierarchy.parents) if parent < 0][1:]
    if not others:
        return
    for joint in others:
        name, place = hierarchy.names[joint], hierarchy.places[joint]
        hierarchy.repairs.append(f"{place}: '{name}' is another root; it was kept beside the first.")
    world = "World"
    while world in hierarchy.names:
        world += "_"
    hierarchy.names.insert(0, world)
    hierarchy.parents = [-1, *(parent + 1 for parent in hierarchy.parents)]
    hierarchy.offsets.insert(0, (0.0, 0.0, 0.0))
    hierarchy.channels.insert(0, ())
    hierarchy.end_sites.insert(0, False)
    hierarchy.places.insert(0, hierarchy.places[0])


def _make_names_unique(hierarchy: Hierarchy) -> None:
    taken: set[str] = set()
    reserved = set(hierarchy.names)
    for joint, name in enumerate(hierarchy.names):
        unique, number_ = name, 2
        while unique in taken or (unique != name and unique in reserved):
            unique, number_ = f"{name}_{number_}", number_ + 1
        taken.add(unique)
        if unique != name:
            hierarchy.names[joint] = unique
            if not hierarchy.end_sites[joint]:
                place = hierarchy.places[joint]
                hierarchy.repairs.append(f"{place}: a second joint is called '{name}'; it was renamed '{unique}'.")
