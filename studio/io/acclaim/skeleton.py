"""ASF files: bones by direction and length, their axes of rotation, and their hierarchy.

Format: Acclaim's skeleton file as Lander describes it (Game Developer, January 1998): a bone rotates by C M C^-1 in its
parent, with C from its ``axis`` and M from the angles of the motion, the first about a fixed axis applied first.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.core.body.skeleton import Skeleton
from studio.core.errors import StudioError
from studio.core.rotations import IDENTITY_QUATERNION, from_euler
from studio.io.numbers import number
from studio.io.referenced_files import read_bytes

FloatArray = NDArray[np.float64]

ASF_ROOT_NAME = "root"
ANGLE_UNIT_IS_DEGREES = {"deg": True, "degree": True, "degrees": True, "rad": False, "radian": False, "radians": False}
"""True for the words of an ASF or AMC file that mean degrees, False for those that mean radians."""
_CHANNELS = ("tx", "ty", "tz", "rx", "ry", "rz", "l")
_MOST_BONES = 4096
_LARGEST = 1 << 24


@dataclass(frozen=True)
class AsfSkeleton:
    """Joints of an ASF file in its own units and axes: each bone begins at the joint with its name."""

    skeleton: Skeleton
    """Skeleton with the ends of bones as end sites; with all rotations zero the body stands as the file defines it."""
    axes: FloatArray
    """Rotations C (J, 4) of the axes of motion of each joint."""
    channels: tuple[tuple[str, ...], ...]
    """Numbers that an AMC file has for each joint, in its order: ``tx`` to ``tz``, ``rx`` to ``rz``, ``l``."""
    degrees: bool
    """True if angles are in degrees unless the motion states another unit."""


@dataclass(frozen=True)
class _Line:
    """Words of one line, and its position in the file: ``07.asf, line 12``."""

    where: str
    words: list[str]

    def numbers(self, count: int) -> list[float]:
        """The ``count`` numbers after the keyword; raises StudioError."""
        if len(self.words) <= count:
            raise StudioError(f"{self.where}: '{self.words[0]}' needs {count} numbers. Correct that line.")
        return [number(word, self.where) for word in self.words[1 : count + 1]]


@dataclass
class _Bone:
    """Bone of an ASF file."""

    where: str
    name: str = ""
    end: FloatArray = field(default_factory=lambda: np.zeros(3))
    """Vector from its begin to its end."""
    axes: FloatArray = field(default_factory=lambda: IDENTITY_QUATERNION)
    channels: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Joint:
    """Begin or end of ``bone`` in the skeleton that is being built."""

    bone: _Bone
    parent: int
    offset: FloatArray
    is_end: bool


def read_asf(path: Path) -> AsfSkeleton:
    """Skeleton in the file at ``path``. Raises StudioError with file, line and what to do."""
    sections = _sections(path.name, read_bytes(path, _LARGEST).decode("utf-8-sig", "replace"))
    degrees = _in_degrees(sections.get("units", []))
    root = _root(path.name, sections.get("root"), degrees)
    bones = {bone.name: bone for bone in (root, *_bones(sections.get("bonedata", []), degrees))}
    parents = _parents(path.name, sections.get("hierarchy"), bones)
    return _joined(root, bones, parents, degrees)


def _sections(name: str, text: str) -> dict[str, list[_Line]]:
    """Lines of each section by its keyword in lower case; the rest of the keyword's line is the first one."""
    sections: dict[str, list[_Line]] = {}
    own: list[_Line] = []
    for index, line in enumerate(text.splitlines(), 1):
        words = line.partition("#")[0].split()
        if not words:
            continue
        if words[0].startswith(":"):
            own = sections.setdefault(words[0][1:].lower(), [])
            words = words[1:]
        if words:
            own.append(_Line(f"{name}, line {index}", words))
    return sections


def _in_degrees(lines: list[_Line]) -> bool:
    said = [line.words[1].lower() for line in lines if line.words[0].lower() == "angle" and len(line.words) > 1]
    return ANGLE_UNIT_IS_DEGREES.get(said[0], True) if said else True


def _root(name: str, lines: list[_Line] | None, degrees: bool) -> _Bone:
    if lines is None:
        raise StudioError(f"{name}: it has no :root section. Choose a complete ASF file.")
    root = _Bone(f"{name}, :root", ASF_ROOT_NAME)
    order, turn = "XYZ", [0.0, 0.0, 0.0]
    root.channels = ("tx", "ty", "tz", "rx", "ry", "rz")
    for line in lines:
        match line.words[0].lower():
            case "order":
                root.channels = _named_channels(line)
            case "axis":
                order = _order(line, line.words[1:])
            case "orientation":
                turn = line.numbers(3)
    root.axes = _turned(order, turn, degrees)
    return root


def _bones(lines: list[_Line], degrees: bool) -> Iterator[_Bone]:
    bone: _Bone | None = None
    direction, length = np.zeros(3), 0.0
    for line in lines:
        word = line.words[0].lower()
        if word == "begin":
            bone, direction, length = _Bone(line.where), np.zeros(3), 0.0
        elif bone is None:
            raise StudioError(
                f"{line.where}: '{line.words[0][:40]}' stands outside every bone. Correct the lines above."
            )
        elif word == "end":
            if not bone.name:
                raise StudioError(f"{bone.where}: this bone has no name. Add one.")
            reach = float(np.linalg.norm(direction))
            bone.end = length * direction / reach if reach > 0.0 else np.zeros(3)
            yield bone
            bone = None
        elif word == "name" and len(line.words) > 1:
            bone.name = line.words[1]
        elif word == "direction":
            direction = np.array(line.numbers(3))
        elif word == "length":
            length = line.numbers(1)[0]
        elif word == "axis":
            bone.axes = _turned(_order(line, line.words[4:]), line.numbers(3), degrees)
        elif word == "dof":
            bone.channels = _named_channels(line)
    if bone is not None:
        raise StudioError(f"{bone.where}: the file ends before this bone does. It is cut off; copy it again.")


def _order(line: _Line, words: list[str]) -> str:
    order = words[0].upper() if words else "XYZ"
    if sorted(order) != ["X", "Y", "Z"]:
        raise StudioError(
            f"{line.where}: '{order[:20]}' is not an order of three axes, such as XYZ. Correct that line."
        )
    return order


def _turned(order: str, angles: list[float], degrees: bool) -> FloatArray:
    """Rotation by ``angles`` about the fixed axes x, y and z, applied in ``order``."""
    turns = np.array([angles["XYZ".index(axis)] for axis in reversed(order)])
    return from_euler(order[::-1], np.radians(turns) if degrees else turns)


def _named_channels(line: _Line) -> tuple[str, ...]:
    channels = tuple(word.lower() for word in line.words[1:])
    for channel in channels:
        if channel not in _CHANNELS or channels.count(channel) > 1:
            raise StudioError(
                f"{line.where}: a bone moves by {', '.join(_CHANNELS)}, each once, not by '{channel[:20]}'. Correct it."
            )
    return channels


def _parents(name: str, lines: list[_Line] | None, bones: dict[str, _Bone]) -> dict[str, str]:
    """Parent of each bone below the root; raises StudioError if they do not form one tree."""
    parents: dict[str, str] = {}
    for line in lines or []:
        if line.words[0].lower() in ("begin", "end") and len(line.words) == 1:
            continue
        for word in line.words:
            if word not in bones:
                raise StudioError(f"{line.where}: there is no bone called '{word[:40]}'. Correct that line.")
        for child in line.words[1:]:
            if child in parents or child == ASF_ROOT_NAME:
                raise StudioError(f"{line.where}: '{child[:40]}' is parented a second time. Correct that line.")
            parents[child] = line.words[0]
    if not parents:
        raise StudioError(f"{name}: its :hierarchy names no bone. Choose a complete ASF file.")
    return parents


def _joined(root: _Bone, bones: dict[str, _Bone], parents: dict[str, str], degrees: bool) -> AsfSkeleton:
    """Joints below the root in depth-first order, with an end after each bone that has no children."""
    children: dict[str, list[str]] = {}
    for child, parent in parents.items():
        children.setdefault(parent, []).append(child)
    joints: list[_Joint] = []
    waiting = [_Joint(root, -1, np.zeros(3), False)]
    while waiting:
        joint = waiting.pop()
        index = len(joints)
        bone = joint.bone
        if index >= 2 * _MOST_BONES:
            raise StudioError(f"{bone.where}: it has more than {_MOST_BONES} child bones. Check the file.")
        joints.append(joint)
        if joint.is_end:
            continue
        waiting += [_Joint(bones[child], index, bone.end, False) for child in reversed(children.get(bone.name, []))]
        if bone.name not in children and bone.end.any():
            waiting.append(_Joint(bone, index, bone.end, True))
    skeleton = Skeleton(
        tuple(f"{joint.bone.name}_end" if joint.is_end else joint.bone.name for joint in joints),
        np.array([joint.parent for joint in joints]),
        np.array([joint.offset for joint in joints]),
        np.array([joint.is_end for joint in joints]),
    )
    axes = np.array([IDENTITY_QUATERNION if joint.is_end else joint.bone.axes for joint in joints])
    return AsfSkeleton(skeleton, axes, tuple(() if joint.is_end else joint.bone.channels for joint in joints), degrees)
