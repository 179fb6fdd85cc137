"""The jobs that ``bench`` measures, each as it is done in the studio: whole clips, one character, one core."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.cli.adaptation import MOTION_ID, ReadyCapture
from studio.core.canonical import BodyPart
from studio.core.character import Character
from studio.core.character_skeleton import character_poses, character_skeleton
from studio.core.constraints.activation import ActivationCurve
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.position import PositionConstraint
from studio.core.contacts import ContactInterval
from studio.core.kinematics import joint_world
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.normalize import normalize
from studio.core.normalized.realize import realize
from studio.core.skin import skin_vertices
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.io.importing import load_capture

FRAMES = 1200
"""Length of the clip that is adapted; the aim of 16 ms is for so many frames."""
AIM = 16_000.0 / FRAMES
"""Microseconds a frame for two feet and two wrists."""

ARM, ARM_AND_TRUNK = Chain(), Chain(trunk=1.0)


@dataclass(frozen=True)
class Case:
    """One job: ``work`` does it ``count`` times in one call; ``reference`` is microseconds for one of them."""

    name: str
    work: Callable[[], object]
    count: int
    reference: float | None = None
    reference_is: str = ""


def make_cases(path: Path, ready: ReadyCapture, character: Character) -> list[Case]:
    """All cases on one capture and one character."""
    motion, contacts = long_motion(ready)
    body = character.morphology
    feet = adapt(AdaptRequest(motion, body, contacts))
    near = (wrist_target(feet, 0, 0.8, ARM), wrist_target(feet, 1, 0.8, ARM))
    far = (wrist_target(feet, 1, 1.6, ARM_AND_TRUNK),)

    def adapting(*constraints: PositionConstraint) -> Callable[[], object]:
        request = AdaptRequest(motion, body, contacts, constraints)
        return lambda: adapt(request)

    skeleton, poses = character_skeleton(body), character_poses(feet)
    pose = feet.positions[0].copy(), feet.rotations[0].copy()
    return [
        Case("retarget a posture", lambda: realize(motion, body), FRAMES, 21.0, "Pronost 2009"),
        Case("retarget, feet held on the ground", adapting(), FRAMES),
        Case("feet, and one reachable wrist", adapting(near[1]), FRAMES, 34.0, "Pronost 2009, one limb"),
        Case("two feet and two wrist targets", adapting(*near), FRAMES, AIM, "aim: 16 ms for 1,200 frames"),
        Case("feet, and an unreachable wrist with trunk", adapting(*far), FRAMES, 115.0, "Pronost 2009, at worst"),
        Case("forward kinematics alone", lambda: joint_world(skeleton, poses), FRAMES),
        Case("skin of one character", lambda: skin_vertices(character.skin, character.build, body, *pose), 1),
        Case(f"import of {path.name}", lambda: load_capture(path), 1),
        Case(f"normalise {path.name}", lambda: normalize(ready.capture), 1),
    ]


def long_motion(ready: ReadyCapture) -> tuple[NormalizedMotion, tuple[ContactInterval, ...]]:
    """The capture played forwards and backwards in turn until there are ``FRAMES``, with its contacts."""
    first, count = ready.capture.first_frame, ready.capture.frame_count
    forward = np.arange(first, count)
    there_and_back = np.concatenate([forward, forward[-2:0:-1]])
    order = np.resize(there_and_back, FRAMES)
    motion = ready.motion
    longer = NormalizedMotion(motion.name, motion.frame_rate, motion.channels[order], motion.spine_places)
    contacts = [
        ContactInterval(MOTION_ID, point, start, stop)
        for point in dict.fromkeys(each.point for each in ready.contacts)
        for start, stop in _spans(_standing(ready, point)[order])
    ]
    return longer, tuple(contacts)


def wrist_target(adapted: AdaptedMotion, side: int, reach: float, chain: Chain) -> PositionConstraint:
    """A wrist held all the time at ``reach`` arm lengths before the middle of where its shoulder is."""
    layout = adapted.morphology.layout
    shoulder = np.median(adapted.positions[:, layout.collar(side) + 1], axis=0)
    wrist = np.median(adapted.positions[:, layout.wrist(side)], axis=0)
    direction = (wrist - shoulder) / np.linalg.norm(wrist - shoulder)
    target = shoulder + reach * adapted.morphology.arm[side].sum() * direction
    part = (BodyPart.LEFT_FOREARM, BodyPart.RIGHT_FOREARM)[side]
    always = ActivationCurve(0.0, 0.0, 1e6, 1e6)
    place = (float(target[0]), float(target[1]), float(target[2]))
    return PositionConstraint(MOTION_ID, part.label, BodyPoint(part, at_end=True), chain, side, always, target=place)


def _standing(ready: ReadyCapture, point: object) -> NDArray[np.bool_]:
    standing = np.zeros(ready.capture.frame_count, dtype=bool)
    for each in ready.contacts:
        if each.point is point:
            standing[each.first : each.last + 1] = True
    return standing


def _spans(mask: NDArray[np.bool_]) -> list[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    return [(int(start), int(stop) - 1) for start, stop in zip(edges[::2], edges[1::2], strict=True)]
