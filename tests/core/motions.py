"""Motions made by formula: bodies that sway at random, and one that walks."""

from dataclasses import replace

import numpy as np

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.captures.capture import Capture
from studio.core.captures.contacts import ContactInterval, ContactPoint
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.kernels import measure_columns as measure
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.normalize import normalize_capture
from studio.core.rotations import multiply, rotate, to_matrix
from studio.core.solver.request import AdaptedMotion
from tests.builders import make_capture, make_skeleton

RATE = 60.0
HINGES = {
    "LeftForeArm": (0.0, 0.0, -1.0),
    "RightForeArm": (0.0, 0.0, 1.0),
    "LeftLeg": (0, 1.0, 0),
    "RightLeg": (0, 1.0, 0),
}
"""Axes about which elbows bend forward and knees back, in the axes of ``make_skeleton``."""
ALWAYS = ActivationCurve(-1.0, -1.0, 100.0, 100.0)


def about(axis: object, angles: object) -> np.ndarray:
    """Quaternions (..., 4) turning by ``angles`` (...) about one axis."""
    half = np.asarray(angles, dtype=float)[..., None] / 2
    return np.concatenate([np.sin(half) * np.asarray(axis, dtype=float), np.cos(half)], axis=-1)


def from_vectors(vectors: np.ndarray) -> np.ndarray:
    """Quaternions (..., 4) of rotation vectors (..., 3)."""
    angle = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.concatenate([vectors * np.sinc(angle / (2 * np.pi)) / 2, np.cos(angle / 2)], axis=-1)


def random_rotations(random: np.random.Generator, *shape: int) -> np.ndarray:
    """Matrices (..., 3, 3) all over the sphere."""
    quaternions = random.normal(size=(*shape, 4))
    return to_matrix(quaternions / np.linalg.norm(quaternions, axis=-1, keepdims=True))


def swaying(
    seed: int = 0, frames: int = 40, amplitude: float = 0.6, hinged: bool = False, lift: float = 0.0
) -> Capture:
    """Every joint turns smoothly at random; ``hinged`` keeps elbows and knees on one axis and always bent."""
    random = np.random.default_rng(seed)
    skeleton = make_skeleton()
    times = np.arange(frames)[:, None, None] / RATE
    shape = (1, skeleton.joint_count, 3)
    vectors = np.zeros((frames, *shape[1:]))
    for frequency in (0.8, 1.7):
        phase = 2 * np.pi * (frequency * times + random.uniform(size=shape))
        vectors += amplitude * random.normal(size=shape) * np.sin(phase) / 2
    rotations = from_vectors(vectors)
    for joint, axis in HINGES.items() if hinged else ():
        rotations[:, skeleton.index(joint)] = about(axis, 0.8 + 0.4 * np.sin(3 * times[:, 0, 0] + random.uniform(0, 6)))
    translations = np.tile(skeleton.offsets, (frames, 1, 1))
    translations[:, 0] += 0.2 * np.sin(2 * times[:, 0] + random.uniform(0, 6, size=3)) + [0.0, 0.0, lift]
    return make_capture("sway", frames, skeleton=skeleton, poses=PoseSequence(rotations, translations))


def times(factor: float, body: Morphology) -> np.ndarray:
    """The packed measures of a body ``factor`` times as large: directions stay as they are."""
    packed = factor * body.packed
    packed[measure.NECK_REST : measure.SPINE] = body.packed[measure.NECK_REST : measure.SPINE]
    return packed


def scaled(capture: Capture, factor: float) -> Capture:
    """The same capture of a body ``factor`` times as large."""
    skeleton, poses = capture.skeleton, capture.poses
    larger = Skeleton(skeleton.names, skeleton.parents, factor * skeleton.offsets, skeleton.end_sites)
    moved = PoseSequence(poses.local_rotations, factor * poses.local_translations)
    return replace(capture, skeleton=larger, poses=moved, floor=factor * capture.floor)


def placed(capture: Capture, yaw: float, shift: tuple[float, float]) -> Capture:
    """The same capture turned about the vertical and moved over the ground."""
    turn = about((0.0, 0.0, 1.0), yaw)
    rotations, translations = capture.poses.local_rotations.copy(), capture.poses.local_translations.copy()
    rotations[:, 0] = multiply(turn, rotations[:, 0])
    translations[:, 0] = rotate(turn, translations[:, 0]) + np.array([*shift, 0.0])
    return replace(capture, poses=PoseSequence(rotations, translations))


def walk(frames: int = 150) -> tuple[NormalizedMotion, tuple[ContactInterval, ...]]:
    """One body striding forward, a second a cycle, and when its heels and toes stand."""
    skeleton = make_skeleton()
    times = np.arange(frames) / RATE
    rotations = np.zeros((frames, skeleton.joint_count, 4))
    rotations[..., 3] = 1.0
    joint, contacts = skeleton.index, []
    for side, name in enumerate(("Left", "Right")):
        phase = 2 * np.pi * (times + 0.5 * side)
        knee = 0.35 + 0.3 * np.cos(phase)
        rotations[:, joint(f"{name}UpLeg")] = about((0, 1, 0), -0.15 - 0.4 * np.sin(phase))
        rotations[:, joint(f"{name}Leg")] = about((0, 1, 0), knee)
        rotations[:, joint(f"{name}Foot")] = about((0, 1, 0), -0.2 + 0.3 * np.sin(phase + 1.0) - 0.5 * knee)
        down = about((-1 if side == 0 else 1, 0, 0), 1.2 + 0.0 * times)
        rotations[:, joint(f"{name}Arm")] = multiply(about((0, 1, 0), 0.4 * np.sin(phase)), down)
        rotations[:, joint(f"{name}ForeArm")] = about(HINGES[f"{name}ForeArm"], 0.6 + 0.2 * np.sin(phase + 0.5))
        for cycle in range(int(times[-1]) + 2):
            strike = RATE * (cycle - 0.75 + 0.5 * side)
            for kind, begin, end in (("heel", 0.0, 0.45), ("toe", 0.08, 0.6)):
                first, last = max(round(strike + begin * RATE), 0), min(round(strike + end * RATE), frames - 1)
                if last > first:
                    contacts.append(ContactInterval("walk", ContactPoint(f"{name.lower()}_{kind}"), first, last))
    rotations[:, joint("Chest")] = about((0, 0, 1), 0.1 * np.sin(2 * np.pi * times))
    rotations[:, joint("Hips")] = about((0, 1, 0), 0.05 + 0.03 * np.sin(4 * np.pi * times))
    translations = np.tile(skeleton.offsets, (frames, 1, 1))
    translations[:, 0, 0] += 1.1 * times
    translations[:, 0, 2] += 0.02 * np.cos(4 * np.pi * times) - 0.04
    poses = PoseSequence(rotations, translations)
    capture = make_capture("walk", frames, skeleton=skeleton, poses=poses)
    return normalize_capture(capture)[0], tuple(contacts)


def target(
    part: str, place: object, chain: Chain | None = None, priority: int = 0, at_end: bool = True, **changes: object
) -> PositionConstraint:
    """A position constraint, active all the time unless said otherwise."""
    part = BodyPart(part)
    fields = {"activation": ALWAYS, "point": BodyPoint(part, changes.pop("offset", (0.0, 0.0, 0.0)), at_end)}
    return PositionConstraint(
        "motion", part.label, chain=chain or Chain(), priority=priority, target=tuple(place), **fields | changes
    )


def local_rotations(adapted: AdaptedMotion) -> np.ndarray:
    """Rotation of every segment relative to the one that carries it, (F, S, 3, 3); the pelvis' in the world."""
    local = adapted.rotations.copy()
    for segment, parent in enumerate(adapted.morphology.layout.parent_segments()):
        if parent >= 0:
            local[:, segment] = np.swapaxes(adapted.rotations[:, parent], 1, 2) @ adapted.rotations[:, segment]
    return local
