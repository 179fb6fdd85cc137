"""Small valid values to test with; every argument that is left out is sensible."""

from dataclasses import replace
from typing import Any

import numpy as np

from studio.core.body.canonical import BodyPart
from studio.core.body.humanoid import BodyMap
from studio.core.body.morphology import Morphology, Proportions
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.captures.capture import Capture, Guess
from studio.core.captures.confidence import Confidence
from studio.core.captures.contacts import ContactInterval, ContactPoint
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.mesh.character import Character
from studio.core.mesh.skin import SkinnedMesh
from studio.core.rotations import normalized
from studio.core.stage.clip import Clip
from studio.core.stage.project import Motion, Performer, Project

_LEG = ((0.0, 0.09, 0.0), (0.0, 0.0, -0.42), (0.0, 0.0, -0.40), (0.14, 0.0, -0.06), (0.06, 0.0, 0.0))
_ARM = ((0.0, 0.04, 0.12), (0.0, 0.14, 0.0), (0.0, 0.28, 0.0), (0.0, 0.25, 0.0), (0.0, 0.17, 0.0))
_TRUNK = (
    (0.0, 0.0, 0.91),
    (0.0, 0.0, 0.15),
    (0.0, 0.0, 0.17),
    (0.0, 0.0, 0.24),
    (0.0, 0.0, 0.10),
    (0.0, 0.0, 0.18),
)

BODY_MAP = {
    "pelvis": "Hips",
    "spine_1": "Spine",
    "spine_2": "Chest",
    "neck": "Neck",
    "head": "Head",
    **{
        f"{side.lower()}_{part}": f"{side}{joint}"
        for side in ("Left", "Right")
        for part, joint in (
            ("clavicle", "Shoulder"),
            ("upper_arm", "Arm"),
            ("forearm", "ForeArm"),
            ("hand", "Hand"),
            ("thigh", "UpLeg"),
            ("shank", "Leg"),
            ("foot", "Foot"),
            ("toe", "ToeBase"),
        )
    },
}


def make_skeleton(scale: float = 1.0) -> Skeleton:
    """A humanoid in T-pose of 26 joints, named as most captures name them; +X forward, Z up."""
    names = ["Hips", "Spine", "Chest", "Neck", "Head", "HeadEnd"]
    parents = [-1, 0, 1, 2, 3, 4]
    offsets = list(_TRUNK)
    for side, sign in (("Left", 1.0), ("Right", -1.0)):
        arm = [f"{side}{name}" for name in ("Shoulder", "Arm", "ForeArm", "Hand", "HandEnd")]
        leg = [f"{side}{name}" for name in ("UpLeg", "Leg", "Foot", "ToeBase", "ToeEnd")]
        for limb, bones, carrier in ((arm, _ARM, 2), (leg, _LEG, 0)):
            first = len(names)
            names += limb
            parents += [carrier, *range(first, first + 4)]
            offsets += [(x, sign * y, z) for x, y, z in bones]
    end_sites = np.array([name.endswith("End") for name in names])
    return Skeleton(tuple(names), np.array(parents), scale * np.array(offsets), end_sites)


def make_poses(skeleton: Skeleton | None = None, frames: int = 30, seed: int = 0) -> PoseSequence:
    """Joints that swing gently about rest while the root travels along +X."""
    skeleton = skeleton or make_skeleton()
    generator = np.random.default_rng(seed)
    phase = np.linspace(0.0, 2 * np.pi, frames)[:, None] + generator.uniform(0, 6, skeleton.joint_count)
    rotations = np.zeros((frames, skeleton.joint_count, 4))
    rotations[..., 1] = 0.1 * np.sin(phase)
    rotations[..., 3] = 1.0
    translations = np.tile(skeleton.offsets, (frames, 1, 1))
    translations[:, 0, 0] += np.linspace(0.0, 1.0, frames)
    return PoseSequence(rotations, translations)


def make_capture(name: str = "walk", frames: int = 30, seed: int = 0, **changes: Any) -> Capture:
    """A capture of ``make_skeleton`` moving as ``make_poses``."""
    skeleton = changes.pop("skeleton", None) or make_skeleton()
    fields: dict[str, Any] = {
        "name": name,
        "source": f"{name}.bvh",
        "skeleton": skeleton,
        "poses": make_poses(skeleton, frames, seed),
        "frame_rate": 60.0,
        "body_map": BodyMap.from_json(skeleton, BODY_MAP),
        "reference_rotations": np.tile([0.0, 0.0, 0.0, 1.0], (skeleton.joint_count, 1)),
        "floor": 0.0,
        "unit": "m",
        "up_axis": "Z",
        "first_frame": 0,
        "guesses": (Guess("unit", "m", "the body is 1.8 high", Confidence.LIKELY),),
        "repairs": (),
    }
    return Capture(**fields | changes)


def make_morphology(scale: float = 1.0, leg_scale: float = 1.0, spine_count: int = 3) -> Morphology:
    """A symmetric adult of some 1.75 m."""
    both = np.ones(2)
    mirrored = np.array([[1.0, 1.0, 1.0], [1.0, -1.0, 1.0]])
    morphology = Morphology(
        spine=np.tile([0.0, 0.0, 0.48 / spine_count], (spine_count, 1)),
        neck=0.10,
        head=0.18,
        collar_base=mirrored * [0.0, 0.03, -0.03],
        clavicle=0.15 * both,
        arm=np.tile([0.29, 0.26], (2, 1)),
        hand=np.tile([0.0, 0.0, 0.18], (2, 1)),
        hip_offset=mirrored * [0.0, 0.09, -0.04],
        leg=leg_scale * np.tile([0.43, 0.41], (2, 1)),
        foot=np.tile([0.13, 0.0, -0.06], (2, 1)),
        toe=np.tile([0.07, 0.0, -0.01], (2, 1)),
        ankle_height=0.08 * both,
        toe_height=0.02 * both,
        heel_length=0.05 * both,
    )
    return Proportions(stature=scale).applied_to(morphology) if scale != 1.0 else morphology


def make_skin(vertices: int = 12) -> SkinnedMesh:
    """A small ball of splinters bound to the pelvis."""
    normals = normalized(np.random.default_rng(vertices).normal(size=(vertices, 3)))
    return SkinnedMesh(
        vertices=(0.1 * normals + [0.0, 0.0, 0.9]).astype(np.float32),
        normals=normals.astype(np.float32),
        centres=np.tile(np.float32([0.0, 0.0, 0.9]), (vertices, 1)),
        triangles=np.array([(k, k + 1, k + 2) for k in range(vertices - 2)], dtype=np.int32),
        segments=np.zeros((vertices, 4), dtype=np.int32),
        weights=np.tile(np.float32([1.0, 0.0, 0.0, 0.0]), (vertices, 1)),
    )


def make_character(name: str = "Woman", colour: str = "#7FB4E6", **measures: Any) -> Character:
    """A character of ``make_morphology(**measures)``; ``proportions`` may be given too."""
    proportions = measures.pop("proportions", Proportions())
    return Character(name, colour, make_morphology(**measures), make_skin(), proportions)


def make_constraint(motion_id: str = "motion", name: str = "Right wrist", **changes: Any) -> PositionConstraint:
    """A target for the right wrist, fully active from 0.1 to 0.3 s."""
    constraint = PositionConstraint(
        motion_id=motion_id,
        name=name,
        point=BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True),
        chain=Chain(),
        priority=0,
        activation=ActivationCurve(0.0, 0.1, 0.3, 0.4),
        target=(0.4, -0.3, 1.2),
    )
    return replace(constraint, **changes)


def make_contact(motion_id: str = "motion", **changes: Any) -> ContactInterval:
    """The left heel on the ground in frames 3 to 12."""
    return replace(ContactInterval(motion_id, ContactPoint.LEFT_HEEL, 3, 12), **changes)


def make_project(characters: int = 2, constraints: int = 1, contacts: int = 2, frames: int = 30) -> Project:
    """One capture played by some characters side by side.

    Ids are readable: ``capture``, ``motion``, ``character 0``, ``performer 0``, ``constraint 0`` and so on.
    """
    clips = (Clip("motion", 0, frames - 1, id="clip"),)
    bodies = {f"character {k}": make_character(f"Body {k}", leg_scale=1.0 + 0.1 * k) for k in range(characters)}
    performers = {
        f"performer {k}": Performer(f"Body {k}", f"character {k}", clips, (0.0, 1.2 * k)) for k in range(characters)
    }
    targets = {f"constraint {k}": make_constraint(name=f"Target {k}", priority=k) for k in range(constraints)}
    touches = {
        f"contact {k}": make_contact(point=tuple(ContactPoint)[k % 4], first=k, last=k + 8) for k in range(contacts)
    }
    return Project(
        captures={"capture": make_capture(frames=frames)},
        motions={"motion": Motion("Walk", "capture")},
        characters=bodies,
        performers=performers,
        constraints=targets,
        contacts=touches,
    )
