"""Warnings about a capture: impossible motion or proportions, caused by a wrong file or a wrong body map."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from studio.core.body.hand_end import SHORTEST_HAND_METRES, hand_reach, has_hand_length
from studio.core.body.humanoid import LIMB_PARTS, BodyMap, BodyPart
from studio.core.body.kinematics import joint_positions
from studio.core.body.morphology import Morphology
from studio.core.body.skeleton import Skeleton
from studio.core.captures.capture import Capture
from studio.core.captures.contacts import spans_of
from studio.core.markers.jumps import marker_jumps
from studio.core.markers.trial import label_without_subject
from studio.core.rotations import normalized
from studio.core.sharing import Shared

FloatArray = NDArray[np.float64]

FASTEST_LIMB_SPEED = 25.0
"""Greatest speed in metres per second of hands and feet relative to the hips; the fastest kicks have about 20."""
LONGEST_ROOT_STEP, FASTEST_ROOT_SPEED = 0.08, 6.0
"""Jump of the hips: metres in one frame, and metres per second above three times their usual speed."""
FASTEST_RUN_SPEED = 12.5
"""Greatest speed in metres per second of the hips in a run."""
SHORTEST_JUMP_METRES, ROOT_JUMP_ACCELERATION = 0.06, 60.0
"""Sudden step of the hips, at any speed: metres, and metres per second squared, by which it differs from the steps
before and after it. Runs, kicks and back flips at 30 to 120 Hz have up to 4 cm and 400 m/s2, but never both beyond
these values.
"""
WHOLE_TURN, LEAST_MOVEMENT_DEGREES = 2.0 * np.pi, 0.1
"""Greatest rotation of all joints, and least rotation of the most moving one, in degrees, of a take whose angles were
radians and read as degrees.
"""
HOVERING_TAKE_HEIGHT = 0.06
"""Height in metres above the floor below which the lowest joint of a hovering take never comes."""
STRETCHED_BONE_METRES, STRETCHED_FRAMES_FRACTION = 0.005, 0.1
"""Change in metres of the length of a bone, and fraction of the frames with such a change, from which it is reported.
"""
ODD_PAIR_FRACTION = 0.2
"""Difference of left and right bones, as a fraction of the longer one, from which they are reported."""
TALLEST_BODY_METRES, SMALLEST_BODY_METRES, LEG_STATURE_FRACTION = 2.3, 0.7, 0.491
"""Statures in metres of the tallest and the smallest walking body, and length of the legs as a fraction of the stature.
"""
LONGEST_BONE_METRES = 100.0
"""Greatest plausible distance in metres between a joint and its parent."""
GREATEST_THIGH_RATIO, FARTHEST_HIP_FRACTION = 2.0, 0.75
"""Greatest ratio of thigh to shank, or the reverse; and greatest distance of a hip from the pelvis, as a fraction of
the leg length.
"""
BACKWARD_FOOT_FRACTION = -0.3
"""Forward component of a foot, perpendicular to its shank, as a fraction of its length, below which it points
backwards.
"""
_SHOWN, _NAMED = 4, 3


@dataclass(frozen=True)
class Remark:
    """Warning about a capture: a sentence, and the (first, last) frames concerned; no frames if it holds throughout."""

    words: str
    spans: tuple[tuple[int, int], ...] = ()

    @property
    def sentence(self) -> str:
        """Text of the warning, followed by its frames."""
        if not self.spans:
            return self.words
        shown = [f"{a}" if a == b else f"{a} to {b}" for a, b in self.spans[:_SHOWN]]
        more = f" and {len(self.spans) - _SHOWN} more" if len(self.spans) > _SHOWN else ""
        word = "Frame" if len(self.spans) == 1 and self.spans[0][0] == self.spans[0][1] else "Frames"
        return f"{self.words} {word} {', '.join(shown)}{more}."


def _remarks_on(capture: Capture) -> tuple[Remark, ...]:
    if capture.body_map is None:
        return (*_leaps(capture), *_far_joints(capture))
    positions = joint_positions(capture.skeleton, capture.poses)
    found = [
        *_leaps(capture),
        *_far_joints(capture),
        *_stiff(capture),
        *_odd_build(capture, capture.body_map, positions),
        *_stretches(capture.skeleton, capture.body_map, positions[capture.first_frame :]),
        *_jumps(capture, positions[:, capture.body_map.spine[0]]),
        *_rushes(capture, capture.body_map, positions),
        *_hovers(capture, capture.body_map, positions),
    ]
    return tuple(found)


remarks_on: Shared[Capture, tuple[Remark, ...]] = Shared(_remarks_on)
"""Warnings about a capture; for a capture without a body map, only those about impossible markers and bones."""


def body_remarks(body: Morphology) -> tuple[Remark, ...]:
    """Warnings about a body's measures in a character's file."""
    found = []
    longest = float(np.abs(body.packed).max())
    if longest > LONGEST_BONE_METRES:
        found.append(Remark(f"It has a bone that is {longest:.0f} m long. Check the unit, or the file."))
    if body.stature > TALLEST_BODY_METRES:
        found.append(Remark(f"It is {body.stature:.2f} m tall. Check the unit."))
    for name, lengths in (("legs", body.leg), ("arms", body.arm)):
        if (np.abs(lengths[0] - lengths[1]) > ODD_PAIR_FRACTION * lengths.max(axis=0)).any():
            found.append(Remark(f"Its {name} are not a pair: joints may be taken for one another."))
    shares = body.leg[:, 0] / np.maximum(body.leg[:, 1], 1e-9)
    away = float(np.linalg.norm(body.hip_offset, axis=1).max())
    if (
        shares.max() > GREATEST_THIGH_RATIO
        or shares.min() < 1.0 / GREATEST_THIGH_RATIO
        or away > FARTHEST_HIP_FRACTION * body.leg_length
    ):
        found.append(Remark("Its legs are not in order: pelvis, hips, knees and ankles are not where a person's are."))
    return tuple(found)


def _leaps(capture: Capture) -> list[Remark]:
    """Warnings about markers that jump; the worst are named."""
    if capture.markers is None:
        return []
    found = sorted(marker_jumps(capture.markers.trial).items(), key=lambda item: -item[1][1])
    remarks = [
        Remark(
            f"The marker {label_without_subject(label)} jumps by up to {100.0 * worst:.0f} cm in a frame.",
            _frames(far, 0),
        )
        for label, (far, worst) in found[:_NAMED]
    ]
    if len(found) > _NAMED:
        names = ", ".join(label_without_subject(label) for label, _ in found[_NAMED:])
        remarks.append(Remark(f"So do {names}.", _frames(np.any([far for _, (far, _) in found[_NAMED:]], axis=0), 0)))
    return remarks


def _far_joints(capture: Capture) -> list[Remark]:
    """Warnings about joints that are impossibly far from their parents; the farthest are named."""
    still = np.linalg.norm(capture.skeleton.offsets[1:], axis=1)
    moved = np.linalg.norm(capture.poses.local_translations[:, 1:], axis=2).max(axis=0, initial=0.0)
    lengths = np.maximum(still, moved)
    order = np.argsort(-lengths, kind="stable")
    return [
        Remark(
            f"The joint {capture.skeleton.names[1 + place]} is {lengths[place]:.0f} m away from its parent. Check the"
            " unit, or the file."
        )
        for place in order[:_NAMED]
        if lengths[place] > LONGEST_BONE_METRES
    ]


def _odd_build(capture: Capture, body: BodyMap, positions: FloatArray) -> list[Remark]:
    """Warnings about impossible proportions: giant legs, limbs of different lengths, and hands with a far end."""
    seen = positions[capture.first_frame :: max(1, capture.frame_count // 256)]

    def bones(limb: str) -> FloatArray:
        joints = [body[part] for part in LIMB_PARTS[limb]]
        return np.array(
            [float(np.median(np.linalg.norm(seen[:, b] - seen[:, a], axis=1))) for a, b in pairwise(joints)]
        )

    found = []
    for limb in ("arm", "leg"):
        left, right = bones(f"left {limb}"), bones(f"right {limb}")
        odd = np.abs(left - right) > ODD_PAIR_FRACTION * np.maximum(left, right)
        if odd.any():
            part = LIMB_PARTS[f"left {limb}"][int(np.argmax(odd))].label.lower().removeprefix("left ")
            lengths = " and ".join(f"{100.0 * float(side[np.argmax(odd)]):.0f}" for side in (left, right))
            words = f"The left and the right {part} are {lengths} cm long: labels or joints may be swapped."
            found.append(Remark(words))
    found += [Remark(words) for side in ("left", "right") for words in _far_hand(capture, body, side, seen)]
    if _feet_point_back(capture, body, seen):
        found.append(Remark("The feet point backwards: left and right may be swapped."))
    stature = float(bones("left leg").sum()) / LEG_STATURE_FRACTION
    if not SMALLEST_BODY_METRES <= stature <= TALLEST_BODY_METRES:
        found.append(Remark(f"By its legs the body is {stature:.1f} m tall. Check the unit."))
    return found


def _far_hand(capture: Capture, body: BodyMap, side: str, positions: FloatArray) -> list[str]:
    """Warning that the end of a hand is too far from its wrist; empty if it is not."""
    wrist = body.parts.get(BodyPart(f"{side}_hand"))
    if wrist is None:
        return []
    reach = hand_reach(capture.skeleton, wrist, positions)
    far = float(np.median(np.linalg.norm(reach, axis=1)))
    forearm = positions[:, wrist] - positions[:, body[BodyPart(f"{side}_forearm")]]
    if far < SHORTEST_HAND_METRES or has_hand_length(reach, forearm).any():
        return []
    return [f"The {side} hand ends {100.0 * far:.0f} cm from its wrist. A hand of usual length is used instead."]


def _stretches(skeleton: Skeleton, body: BodyMap, positions: FloatArray) -> list[Remark]:
    """Warning about the bone with the greatest change of length; empty if bones of constant length would pose the body
    alike.
    """
    bones = _mapped_bones(skeleton, body)
    lengths = np.array([np.linalg.norm(positions[:, b] - positions[:, a], axis=1) for _, a, b in bones])
    off = np.quantile(
        np.abs(lengths - np.median(lengths, axis=1, keepdims=True)), 1.0 - STRETCHED_FRAMES_FRACTION, axis=1
    )
    worst = int(np.argmax(off))
    if off[worst] < STRETCHED_BONE_METRES:
        return []
    words = f"The {bones[worst][0]} changes its length by {1000.0 * off[worst]:.0f} mm and more."
    return [
        Remark(
            f"{words} Bones of characters have a constant length, so their joints differ from the capture by as much."
        )
    ]


def _mapped_bones(skeleton: Skeleton, body: BodyMap) -> list[tuple[str, int, int]]:
    """Bones between mapped joints, each as its name, first joint and last joint.

    Trunk and neck also bend between mapped joints, so their bones count only if the joints are parent and child.
    """
    pelvis, thorax, parts = body.spine[0], body.spine[-1], body.parts
    bones = [("trunk", below, above) for below, above in pairwise(body.spine)]
    neck = [joint for part in (BodyPart.NECK, BodyPart.HEAD) if (joint := parts.get(part)) is not None]
    bones += [("neck", below, above) for below, above in pairwise((thorax, *neck))]
    bones = [bone for bone in bones if skeleton.parents[bone[2]] == bone[1]]
    for side in ("left", "right"):
        for carrier, limb in (
            (thorax, ("clavicle", "upper_arm", "forearm", "hand")),
            (pelvis, ("thigh", "shank", "foot", "toe")),
        ):
            there = [part for name in limb if (part := BodyPart(f"{side}_{name}")) in parts]
            bones.append((f"way to the {there[0].label.lower()}", carrier, parts[there[0]]))
            bones += [(part.label.lower(), parts[part], parts[end]) for part, end in pairwise(there)]
    return bones


def _feet_point_back(capture: Capture, body: BodyMap, positions: FloatArray) -> bool:
    """True if both feet point well behind their ankles most of the time, relative to the facing of hips and trunk.

    A foot in line with its shank has no direction of its own.
    """
    across = positions[:, body[BodyPart.LEFT_THIGH]] - positions[:, body[BodyPart.RIGHT_THIGH]]
    forward = normalized(np.cross(across, positions[:, body.spine[-1]] - positions[:, body.spine[0]]))
    for side in ("left", "right"):
        knee, foot = body[BodyPart(f"{side}_shank")], body[BodyPart(f"{side}_foot")]
        beyond = capture.skeleton.descendants(foot)
        if not beyond:
            return False
        way = normalized(positions[:, beyond].mean(axis=1) - positions[:, foot])
        shank = normalized(positions[:, foot] - positions[:, knee])
        bent = way - np.einsum("fi,fi->f", way, shank)[:, None] * shank
        if float(np.median(np.einsum("fi,fi->f", bent, forward))) > BACKWARD_FOOT_FRACTION:
            return False
    return True


def _jumps(capture: Capture, root: FloatArray) -> list[Remark]:
    """Warnings about jumps of the hips: fast frames that begin or end at once, unlike in a run, and sudden steps."""
    steps = np.diff(root, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    speeds = lengths * capture.frame_rate
    fast = (lengths > LONGEST_ROOT_STEP) & (
        speeds > FASTEST_ROOT_SPEED + 3.0 * (np.median(speeds) if len(speeds) else 0.0)
    )
    far = _sudden(steps, capture.frame_rate)
    unlike = np.linalg.norm(np.diff(steps, axis=0), axis=1) > max(
        SHORTEST_JUMP_METRES, ROOT_JUMP_ACCELERATION / capture.frame_rate**2
    )
    for first, last in spans_of(fast):
        far[first : last + 1] |= speeds[first : last + 1] > FASTEST_RUN_SPEED
        far[first : last + 1] |= unlike[max(first - 1, 0) : first].any() or unlike[last : last + 1].any()
    far[: capture.first_frame] = False
    if not far.any():
        return []
    worst = 100.0 * float(lengths[far].max())
    return [Remark(f"The hips jump by up to {worst:.0f} cm in a frame.", _frames(far, 1))]


def _sudden(steps: FloatArray, frame_rate: float) -> NDArray[np.bool_]:
    """Mask (F-1,) of the ``steps`` (F-1, 3) that differ much from both neighbours, or from the only one at an end."""
    if len(steps) < 2:
        return np.zeros(len(steps), dtype=bool)
    unlike = np.linalg.norm(np.diff(steps, axis=0), axis=1)
    least = np.minimum(np.append(unlike, unlike[-1]), np.append(unlike[0], unlike))
    found: NDArray[np.bool_] = least > max(SHORTEST_JUMP_METRES, ROOT_JUMP_ACCELERATION / frame_rate**2)
    return found


def _stiff(capture: Capture) -> list[Remark]:
    """Warning about a body that hardly bends, as if its angles were meant as radians."""
    cosines = np.abs(capture.poses.local_rotations[capture.first_frame :, 1:, 3])
    angles = np.degrees(2.0 * np.arccos(np.minimum(cosines, 1.0)))
    most = float(angles.max(initial=0.0))
    if most > WHOLE_TURN or float(np.ptp(angles, axis=0).max(initial=0.0)) < LEAST_MOVEMENT_DEGREES:
        return []
    return [Remark(f"No joint turns by more than {most:.1f} degrees: the angles of the file may be radians.")]


def _rushes(capture: Capture, body: BodyMap, positions: FloatArray) -> list[Remark]:
    """Warning about hands and feet that move faster, relative to the hips, than those of any person."""
    found = []
    root = positions[:, body.spine[0]]
    for part in (BodyPart.LEFT_HAND, BodyPart.RIGHT_HAND, BodyPart.LEFT_FOOT, BodyPart.RIGHT_FOOT):
        speeds = np.linalg.norm(np.diff(positions[:, body[part]] - root, axis=0), axis=1) * capture.frame_rate
        fast = speeds > FASTEST_LIMB_SPEED
        fast[: capture.first_frame] = False
        if fast.any():
            words = f"The {part.label.lower()} moves at up to {float(speeds[fast].max()):.0f} m/s, as no person's does."
            found.append(Remark(words, _frames(fast, 1)))
    return found


def _hovers(capture: Capture, body: BodyMap, positions: FloatArray) -> list[Remark]:
    feet = [body[part] for part in (BodyPart.LEFT_FOOT, BodyPart.RIGHT_FOOT)]
    below = sorted({*feet, *(joint for foot in feet for joint in capture.skeleton.descendants(foot))})
    ankle = positions[capture.first_frame :, feet, 2].min(axis=1) - capture.floor
    lowest = positions[capture.first_frame :, below, 2].min(axis=1) - capture.floor
    over = float(lowest.min())
    if over < HOVERING_TAKE_HEIGHT or (len(below) == len(feet) and float(ankle.min()) < 2.5 * HOVERING_TAKE_HEIGHT):
        return []
    return [
        Remark(f"The capture floats: its feet are {100.0 * over:.0f} cm above the floor at least. Check the floor.")
    ]


def _frames(odd: NDArray[np.bool_], later: int) -> tuple[tuple[int, int], ...]:
    """Spans (first, last) of the frames in the mask ``odd``, shifted by ``later`` because steps lie between frames."""
    spans: Sequence[tuple[int, int]] = spans_of(odd)
    return tuple((first + later, last + later) for first, last in spans)
