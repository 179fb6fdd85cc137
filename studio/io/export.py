"""Export of motions to files: adapted ones on a character's own skeleton, captures on their own."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.core.body.finger_poses import FingerPoses
from studio.core.body.pose import PoseSequence
from studio.core.body.rest_pose import rest_pose
from studio.core.body.skeleton import Skeleton
from studio.core.captures.annotations import Annotations
from studio.core.captures.capture import Capture
from studio.core.captures.contacts import Touch
from studio.core.errors import StudioError
from studio.core.mesh.appearance import Material
from studio.core.mesh.character import Character
from studio.core.normalized.actor import SourceRig
from studio.core.normalized.realize import actor_joint_poses
from studio.core.rigs.carried_joints import carried_joints, with_carried_joints
from studio.core.rigs.character_skeleton import character_body_map, character_poses, character_skeleton, joint_segments
from studio.core.rigs.joint_skin import JointSkin, bone_skin, character_skin
from studio.core.rigs.played_fingers import fingers_of_capture
from studio.core.rotations import IDENTITY_QUATERNION
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.stage.placement import Placement
from studio.io.registry import Format, Progress, known_formats

FloatArray = NDArray[np.float64]

_STILL_RATE = 30.0
ORIGIN_PLACEMENT = Placement()
"""Placement of a body that stands on no stage."""
_BONES = "#C8CDD2"


@dataclass(frozen=True, eq=False)
class Take:
    """Motion to export: joints and poses for every format, and further data for formats that can hold them."""

    capture: Capture
    """Motion to be written, as if it had been captured: joints, poses, body map, ground."""
    annotations: Annotations = Annotations()
    """Contacts, constraints and labels to be written beside it."""
    character: Character | None = None
    """Character that performs ``adapted``, with its skin. The joints are then those of its ``character_skeleton``,
    followed by the extra joints that it carries.
    """
    adapted: AdaptedMotion | None = None
    request: AdaptRequest | None = None
    """Request that ``adapted`` answers: the normalised motion, contacts, constraints."""
    bound: JointSkin | None = None
    """Skin bound to the joints as they are written, if export options have changed them; None to let ``skin_of`` make
    it.
    """
    rest_rotations: FloatArray | None = None
    """Local rotations (J, 4) of the joints at rest; None if they are zero."""
    fingers: FingerPoses | None = None
    """Finger poses in all frames of a character with finger joints; None if they are at rest."""
    place: Placement = Placement()
    """Placement on the stage of the space of the poses."""
    begin: float = 0.0
    """Stage second of the first frame."""

    @property
    def name(self) -> str:
        """Name of the motion, or of its performer."""
        return self.capture.name

    @property
    def carried_joints(self) -> tuple[str, ...]:
        """Names of the extra joints after a character's own, without the ends of bones."""
        if self.adapted is None or self.character is None:
            return ()
        own = len(joint_segments(self.adapted.morphology.layout))
        ends = self.skeleton.end_sites
        return tuple(name for joint, name in enumerate(self.skeleton.names) if joint >= own and not ends[joint])

    @property
    def skeleton(self) -> Skeleton:
        """Joints to be written."""
        return self.capture.skeleton

    @property
    def poses(self) -> PoseSequence:
        """Poses of the joints, metres, Z up."""
        return self.capture.poses

    @property
    def frame_rate(self) -> float:
        """Frame rate in Hz."""
        return self.capture.frame_rate


def skin_of(take: Take) -> JointSkin:
    """Skin of the character on the joints of ``take``, or a figure of bones if it has no character."""
    if take.bound is not None:
        return take.bound
    return character_skin(take.character, take.skeleton) if take.character else bone_skin(take.skeleton)


def plain_material(take: Take) -> Material:
    """Single material of a skin without an appearance."""
    return Material(take.name, take.character.colour if take.character else _BONES)


def take_of_capture(capture: Capture, annotations: Annotations | None = None) -> Take:
    """Take of a capture with its own joints, poses and frame rate."""
    return Take(capture, annotations or Annotations())


def take_of_standing(character: Character) -> Take:
    """Take of one frame, in which a character rests."""
    positions, rotations = (each[None] for each in rest_pose(character.morphology))
    still = AdaptedMotion(character.morphology, _STILL_RATE, 0, positions, rotations, np.empty((0, 1)))
    return take_of_adapted(character.name, still, character)


def take_of_adapted(
    name: str,
    adapted: AdaptedMotion,
    character: Character | None = None,
    request: AdaptRequest | None = None,
    along: tuple[Capture, SourceRig] | None = None,
) -> Take:
    """Take of an adapted motion on the skeleton of its body; ``name`` is used in errors.

    ``along`` is a capture, and its actor, whose extra joints (fingers, props) are exported too; its fingers also move
    those of the character.
    """
    try:
        skeleton, poses = character_skeleton(adapted.morphology), character_poses(adapted)
        carried = carried_joints(along[0].skeleton, along[0].body_map) if along and along[0].body_map else ()
        if along and carried:
            skeleton, poses = with_carried_joints(skeleton, poses, adapted, along[1], carried)
    except StudioError as error:
        raise StudioError(f"The motion of {name} cannot be exported: {error}") from error
    capture = Capture(
        name=name,
        source="",
        skeleton=skeleton,
        poses=poses,
        frame_rate=adapted.frame_rate,
        body_map=character_body_map(adapted.morphology.layout),
        reference_rotations=np.tile(IDENTITY_QUATERNION, (skeleton.joint_count, 1)),
        floor=request.ground.height if request else 0.0,
        unit="m",
        up_axis="Z",
        first_frame=0,
        guesses=(),
        repairs=(),
    )
    fingers = along and fingers_of_capture(along[0], adapted.first_frame, adapted.frame_count)
    return Take(capture, _met(request, adapted), character, adapted, request, fingers=fingers)


def take_of_actor(
    adapted: AdaptedMotion,
    actor: SourceRig,
    capture: Capture,
    request: AdaptRequest | None = None,
    placement: Placement = ORIGIN_PLACEMENT,
) -> Take:
    """Take of a motion adapted to the actor of its own capture, on the joints of the capture.

    Fingers, eyes, props and other joints that belong to no body part move as captured. The body stays where it was
    captured, or stands at ``placement`` on the stage if that is given.
    """
    try:
        poses = actor_joint_poses(actor, adapted.positions[:], adapted.rotations[:], adapted.first_frame)
    except StudioError as error:
        raise StudioError(f"The motion of {capture.name} cannot be exported: {error}") from error
    take = Take(replace(capture, poses=poses, first_frame=0), _met(request, adapted), None, adapted, request)
    if placement == ORIGIN_PLACEMENT:
        return take
    x, y, _ = (-actor.origin).tolist()
    return replace(take, place=placement.compose(Placement((x, y))))


def _met(request: AdaptRequest | None, adapted: AdaptedMotion) -> Annotations:
    """Annotations of the exported frames: contacts only, since constraints are already solved in the poses."""
    if request is None:
        return Annotations()
    start, last = adapted.first_frame, adapted.frame_count - 1
    return Annotations(
        tuple(
            replace(each, first=max(each.first - start, 0), last=min(each.last - start, last))
            for each in (*adapted.contacts, *(each for each in request.contacts if isinstance(each.point, Touch)))
            if start <= each.last and each.first - start <= last
        )
    )


def format_for(path: Path, job: str = "motion_writer") -> Format:
    """Format of the suffix of ``path`` that supports ``job``. Raises StudioError, which lists the existing formats."""
    known = known_formats()
    for each in known.that_can(job):
        if path.suffix.lower() in each.suffixes:
            return each
    what = job.removesuffix("_writer")
    suffixes = ", ".join(known.suffixes(job))
    raise StudioError(
        f"{path.name} does not name a kind of file that a {what} can be written to. End its name with {suffixes}."
    )


def write_take(take: Take, path: Path, progress: Progress = lambda share, text: None) -> Format:
    """Write a take in the format of the suffix of ``path``, and return the format.

    Raises StudioError. ``progress`` is called with a fraction from 0 to 1 and may raise an exception to cancel; the
    file is then as before, or absent.
    """
    chosen = format_for(path)
    chosen.write_motion(path, take, progress)
    return chosen


def write_capture(capture: Capture, path: Path) -> Format:
    """Write a capture with its own joints, poses and frame rate, and return the format."""
    return write_take(take_of_capture(capture), path)
