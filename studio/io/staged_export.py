"""Export of a performer of a stage: its row of clips on its character."""

from dataclasses import replace
from itertools import product

import numpy as np

from studio.core.body.finger_poses import FingerPoses
from studio.core.captures.annotations import Label, labels_in_range
from studio.core.captures.capture import Capture
from studio.core.names import safe_name
from studio.core.normalized.normalize import normalize_capture
from studio.core.rigs.carried_joints import carried_joints, with_carried_joints
from studio.core.rigs.driven_fingers import below_hands
from studio.core.rigs.played_fingers import captures_of_clips, fingers_of_performer, has_fingers, on_captured_joints
from studio.core.rotations import IDENTITY_QUATERNION
from studio.core.solver.performers.rows import is_plain, timing_of
from studio.core.solver.performers.staged_performances import Performance
from studio.core.stage.placement import Placement
from studio.core.stage.project import Project
from studio.io.export import Take, take_of_adapted


def file_name(project: Project, performer_id: str, suffix: str = ".bvh") -> str:
    """File name for a performer's motion: its first motion and its name, such as ``front_kick tall man.bvh``."""
    performer = project.performers[performer_id]
    motion = project.motions[performer.clips[0].motion_id]
    return safe_name(f"{motion.name} {performer.name.lower()}{suffix}")


def take_of_performer(project: Project, performer_id: str, performance: Performance, *, along: bool = False) -> Take:
    """Take of one performer on its character.

    With ``along`` it has the extra joints of its only unchanged clip, or else the fingers of its captures, and the
    character's own fingers move.
    """
    performer = project.performers[performer_id]
    character = project.characters[performer.character_id]
    clips, captures = performer.clips, captures_of_clips(project, performer)
    composite, timing = performance.composite, performance.composite.timing
    frames = np.arange(timing.first, timing.last + 1)
    fingers = fingers_of_performer(project, performer_id, composite, frames) if along else None
    take = take_of_adapted(performer.name, performance.adapted_on_stage, character, performance.request)
    if along:
        unchanged = len(clips) == 1 and is_plain(clips[0]) and bool(other_joints(captures[0]))
        carried = captures[0] if unchanged else next(filter(has_fingers, captures), None)
        take = _with_captured_joints(take, carried, fingers, fingers_only=not unchanged) if carried else take
    return replace(
        take,
        annotations=replace(take.annotations, labels=labels_played(project, performer_id)),
        place=Placement.of(performer),
        begin=timing.start,
        fingers=fingers,
    )


def _with_captured_joints(take: Take, captured: Capture, fingers: FingerPoses | None, *, fingers_only: bool) -> Take:
    """Take with the other joints of a capture as it moves in the same frames, or with its fingers only; fingers pose as
    ``fingers``.
    """
    body, adapted, actor = captured.body_map, take.adapted, normalize_capture(captured)[1]
    assert body is not None
    assert adapted is not None
    joints, poses = carried_joints(captured.skeleton, body), None
    if fingers_only:
        below = set(below_hands(captured.skeleton, body))
        joints = tuple(joint for joint in joints if joint in below)
    else:
        poses = actor.pass_through.frames(adapted.first_frame, adapted.first_frame + adapted.frame_count - 1)
    if fingers is not None and has_fingers(captured) and (poses is None or fingers.asked.any()):
        poses = on_captured_joints(captured, fingers, poses)
    assert poses is not None
    skeleton, poses = with_carried_joints(take.skeleton, take.poses, adapted, actor, joints, poses)
    rest = np.tile(IDENTITY_QUATERNION, (skeleton.joint_count, 1))
    return replace(take, capture=replace(take.capture, skeleton=skeleton, poses=poses, reference_rotations=rest))


def labels_played(project: Project, performer_id: str) -> tuple[Label, ...]:
    """Labels of the motions that a performer plays, in frames of its row of clips, once for each repeat."""
    performer = project.performers[performer_id]
    timing, played = timing_of(project, performer), []
    for clip in performer.clips:
        rate = project.frame_rate_of(clip)
        once = clip.length(rate) / clip.repeats
        labels = labels_in_range(project.labels_of(clip.motion_id).values(), clip.first, clip.last)
        for label, repeat in product(labels, range(clip.repeats)):
            begin = repeat * once - timing.start
            ends = clip.stage_seconds(np.array([clip.first + label.first, clip.first + label.last]) / rate, rate)
            frames = np.rint((begin + ends) * timing.frame_rate).clip(0, timing.last - timing.first)
            first, last = frames.astype(int).tolist()
            played.append(replace(label, first=first, last=last))
    return tuple(played)


def other_joints(capture: Capture) -> tuple[str, ...]:
    """Names of the capture's extra joints that can be transferred to a character."""
    if capture.body_map is None:
        return ()
    skeleton = capture.skeleton
    carried = carried_joints(skeleton, capture.body_map)
    return tuple(skeleton.names[joint] for joint in carried if not skeleton.end_sites[joint])
