"""Joint names of other programs for exported files: ``resources/joint_names``."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

from studio.core.body.canonical import BodyPart
from studio.core.body.finger_joints import Digit, FingerJoint, find_fingers
from studio.core.captures.capture import Capture
from studio.core.errors import StudioError
from studio.resources_folder import resources_folder

_SIDES = ({"side": "left", "Side": "Left", "s": "l", "S": "L"}, {"side": "right", "Side": "Right", "s": "r", "S": "R"})


@dataclass(frozen=True)
class JointNaming:
    """Joint names of one group of programs: for each part, each finger joint, and each vertebra above the pelvis."""

    name: str
    parts: Mapping[BodyPart, str]
    spine: tuple[str, ...]
    """Names of vertebrae from below; the last contains a number and names all that follow."""
    fingers: Mapping[FingerJoint, str]

    def vertebra(self, index: int) -> str:
        """Name of the spine joint at ``index``; 1 is just above the pelvis."""
        pattern = self.spine[min(index, len(self.spine)) - 1]
        return pattern.format(n=index - 1, nn=f"{index:02}", nnn=f"{index:03}")


@lru_cache(maxsize=1)
def joint_namings() -> Mapping[str, JointNaming]:
    """All naming tables by their key."""
    files = sorted((resources_folder() / "joint_names").glob("*.json"), key=lambda path: path.stem)
    return {path.stem: _naming(json.loads(path.read_text(encoding="utf-8"))) for path in files}


def with_joint_names(capture: Capture, key: str) -> Capture:
    """Capture with the joint names of one table; joints that are neither body parts nor fingers keep theirs.

    Raises StudioError if there is no such table, or no body map.
    """
    namings = joint_namings()
    if key not in namings:
        raise StudioError(f"There are no joint names called '{key}'. Choose {', '.join(namings)}.")
    body = capture.body_map
    if body is None:
        raise StudioError(f"'{capture.name}' has no body map, so its joints cannot be given other names.")
    given = {joint: namings[key].parts[part] for part, joint in body.parts.items() if part in namings[key].parts}
    given |= {joint: namings[key].vertebra(index) for index, joint in enumerate(body.spine) if index}
    fingers = find_fingers(capture.skeleton, body)
    given |= {joint: namings[key].fingers[finger] for finger, joint in fingers.items()}
    taken = set(given.values())
    names = []
    for joint, own in enumerate(capture.skeleton.names):
        name = given.get(joint, own)
        while joint not in given and name in taken:
            name += "_"
        taken.add(name)
        names.append(name)
    return replace(capture, skeleton=replace(capture.skeleton, names=tuple(names)))


def _naming(record: Mapping[str, Mapping[str, str]]) -> JointNaming:
    parts = {
        BodyPart(key.format(**side)): name.format(**side) for key, name in record["parts"].items() for side in _SIDES
    }
    fingers = {
        FingerJoint(side, digit, index): name.format(**words)
        for side, words in enumerate(_SIDES)
        for digit in Digit
        for index, name in enumerate(record["fingers"][digit])
    }
    return JointNaming(str(record["name"]), parts, tuple(record["spine"]), fingers)
