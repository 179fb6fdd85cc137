"""One moving body as a BVH file of this program or that: names, axes, units, channels and spelling as each has them.

Written apart from the studio's own writer, so that the two cannot be wrong together.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import Rotation

from studio.core.body.humanoid import BodyMap
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.captures.capture import Capture
from tests.builders import BODY_MAP, make_capture, make_poses, make_skeleton

EXTRAS = {"Eye": "Head", "Twist": "LeftForeArm", "Thumb1": "LeftHand", "Thumb2": "Thumb1", "Sword": "RightHand"}
"""Joints that play no part of the body, by the joint they hang from."""
FILE_TO_WORLD = {
    "Y": np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]),
    "Z": np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
}
SIDED = ("Shoulder", "Arm", "ForeArm", "Hand", "UpLeg", "Leg", "Foot", "ToeBase")


@dataclass(frozen=True)
class Exporter:
    """Spelling of BVH by one program."""

    names: Mapping[str, str]
    order: str = "ZXY"
    unit: float = 0.01
    up: str = "Y"
    all_positions: bool = False
    from_offsets: bool = False
    above: str = ""
    """A joint above the hips that never moves."""
    channels_above: bool = True
    travels: bool = True
    """True if the first joint has positions."""
    scales: str = ""
    """Names of each joint's channels of scale."""
    rotations_first: bool = False
    ends: bool = True
    number: str = "{:.8f}"
    indent: str = "\t"
    line: str = "\n"
    end: str = ""
    changes: Mapping[str, str] = field(default_factory=dict)
    """Words replaced in the finished text."""


def sided(words: str, pattern: str = "{Side}{word}", trunk: str = "Hips Spine Chest Neck Head") -> dict[str, str]:
    """Names of trunk and limbs; ``words`` are those of shoulder, arm, forearm, hand, thigh, shank, foot, toe."""
    names = dict(zip(("Hips", "Spine", "Chest", "Neck", "Head"), trunk.split(), strict=True))
    for side in ("Left", "Right"):
        spelled = {"Side": side, "side": side.lower(), "S": side[0], "s": side[0].lower()}
        for own, word in zip(SIDED, words.split(), strict=True):
            names[side + own] = pattern.format(word=word, **spelled)
    return names


def body() -> tuple[Skeleton, PoseSequence]:
    """``make_skeleton`` with fingers, an eye, a twist bone and a prop, all moving."""
    plain = make_skeleton()
    names, parents, offsets = list(plain.names), plain.parents.tolist(), plain.offsets.tolist()
    for extra, carrier in EXTRAS.items():
        parents.append(names.index(carrier))
        names.append(extra)
        offsets.append([0.03, 0.02, 0.01])
    ends = np.array([name.endswith("End") for name in names])
    skeleton = Skeleton(tuple(names), np.array(parents), np.array(offsets), ends)
    return skeleton, make_poses(skeleton, 40)


def with_extras() -> Capture:
    """A capture of a body with fingers, an eye, a twist bone and a prop."""
    skeleton, poses = body()
    return make_capture(
        skeleton=skeleton,
        poses=poses,
        body_map=BodyMap.from_json(skeleton, BODY_MAP),
        reference_rotations=np.tile([0.0, 0.0, 0.0, 1.0], (skeleton.joint_count, 1)),
    )


def exported(program: Exporter) -> str:
    """``body`` as ``program`` writes it."""
    skeleton, poses = body()
    turn = FILE_TO_WORLD[program.up].T
    columns: list[np.ndarray] = []
    lines = ["HIERARCHY"]
    if program.above:
        channels = f"CHANNELS 6 {_positions()} {_rotations('ZXY')}" if program.channels_above else "CHANNELS 0"
        lines += [f"ROOT {program.above}", "{", "OFFSET 0 0 0", channels]
        columns += [np.zeros((poses.frame_count, 6))] if program.channels_above else []

    def write(joint: int) -> None:
        name = skeleton.names[joint]
        if skeleton.end_sites[joint] and not program.ends:
            return
        offset = turn @ skeleton.offsets[joint] / program.unit
        numbers = " ".join(map(program.number.format, offset))
        kind = "JOINT" if joint or program.above else "ROOT"
        head = "End Site" if skeleton.end_sites[joint] else f"{kind} {program.names.get(name, name)}"
        lines.extend([head, "{", f"OFFSET {numbers}"])
        if not skeleton.end_sites[joint]:
            lines.append(_channels(joint, program))
            columns.append(_columns(joint, poses, skeleton, program, turn))
        for child in skeleton.children[joint]:
            write(child)
        lines.append("}")

    write(0)
    lines += ["}"] if program.above else []
    lines += ["MOTION", f"Frames: {poses.frame_count}", f"Frame Time: {1 / 60:.8f}"]
    lines += [" ".join(map(program.number.format, row)) for row in np.concatenate(columns, axis=1)]
    depth, text = 0, ""
    for line in lines:
        depth -= line == "}"
        text += program.indent * depth + line + program.line
        depth += line == "{"
    for old, new in program.changes.items():
        text = text.replace(old, new)
    return text + program.end


def _positions() -> str:
    return "Xposition Yposition Zposition"


def _rotations(order: str) -> str:
    return " ".join(f"{axis}rotation" for axis in order)


def _has_positions(joint: int, program: Exporter) -> bool:
    return program.all_positions or (joint == 0 and program.travels)


def _channels(joint: int, program: Exporter) -> str:
    words = [_rotations(program.order)]
    if _has_positions(joint, program):
        words.insert(1 if program.rotations_first else 0, _positions())
    words += [" ".join(f"{axis}{program.scales}" for axis in "XYZ")] if program.scales else []
    return f"CHANNELS {3 * len(words)} {' '.join(words)}"


def _columns(joint: int, poses: PoseSequence, skeleton: Skeleton, program: Exporter, turn: np.ndarray) -> np.ndarray:
    rotations = turn @ Rotation.from_quat(poses.local_rotations[:, joint]).as_matrix() @ turn.T
    blocks = [Rotation.from_matrix(rotations).as_euler(program.order, degrees=True)]
    if _has_positions(joint, program):
        places = poses.local_translations[:, joint]
        if program.from_offsets and joint:
            places = places - skeleton.offsets[joint]
        blocks.insert(1 if program.rotations_first else 0, places @ turn.T / program.unit)
    blocks += [np.ones_like(blocks[0])] if program.scales else []
    return np.concatenate(blocks, axis=1)
