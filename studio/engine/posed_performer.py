"""Posed performer: the frame of a performer's motion at a stage time, its pose and placement."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.body.canonical import BodyPart
from studio.core.body.finger_poses import FingerPoses
from studio.core.body.rest_pose import rest_pose
from studio.core.captures.capture import Capture
from studio.core.captures.contacts import FOOT_POINTS, ContactInterval
from studio.core.normalized.pieces import PlayedPiece
from studio.core.rigs.played_fingers import captures_of_clips, fingers_of_row, has_fingers, weighted_pieces
from studio.core.solver.performers.rows import timing_of
from studio.core.solver.request import AdaptedMotion
from studio.core.stage.clip import Clip
from studio.core.stage.holding import grips_on_props
from studio.core.stage.placement import Placement
from studio.core.stage.project import Performer, Project
from studio.core.stage.timing import Timing
from studio.document.document import Document
from studio.engine.live_interface import Live

FloatArray = NDArray[np.float64]
PATH_RATE_HZ = 15.0
"""Frequency in Hz at which paths over the stage are sampled."""
ResultOf = Callable[[str], AdaptedMotion | None]
"""The newest adapted motion by id, or None while there is none."""


def motion_time(clip: Clip, frame_rate: float, time: float) -> float:
    """Time of the clip's motion in seconds at the stage time ``time``, within the first loop and clamped to the
    clip.
    """
    seconds = float(clip.motion_seconds(time, frame_rate))
    return min(max(seconds, clip.first / frame_rate), clip.last / frame_rate)


def stage_time(clip: Clip, frame_rate: float, time: float) -> float:
    """Stage time in seconds at which the time ``time`` of the clip's motion first plays."""
    return float(clip.stage_seconds(time, frame_rate))


def row_at(motion: AdaptedMotion, timing: Timing | None, time: float) -> int:
    """Index of the frame of ``motion`` nearest to a stage time in seconds."""
    return int(rows_at(motion, timing, [time])[0])


def rows_at(motion: AdaptedMotion, timing: Timing | None, times: ArrayLike) -> NDArray[np.intp]:
    """(N,) indices of the frames of ``motion`` nearest to stage times (N,) in seconds."""
    frames = np.asarray(times) * motion.frame_rate if timing is None else timing.frames_at(times)
    rows = np.rint(frames).astype(np.intp) - motion.first_frame
    return np.clip(rows, 0, motion.frame_count - 1)


@dataclass(frozen=True, eq=False)
class PosedPerformer:
    """Performer at one moment: its adapted motion, the index ``row`` of the current frame, and its placement on the
    stage.
    """

    performer: Performer
    motion: AdaptedMotion
    row: int
    placement: Placement
    resting: bool = False
    """True if the performer has no motion yet and is in its rest pose."""
    frames_around: AdaptedMotion | None = None
    """Newest motion with several frames, if ``motion`` is only the displayed frame."""

    captures: tuple[Capture, ...] = ()
    """Captures of the performer's clips."""

    holding: float = 0.0
    """Fraction from 0 to 1 by which the hands have closed on a prop."""
    holding_grip: float = 0.0
    """Hand pose, from -1 (open) to 1 (fists), of hands that hold the prop."""

    @property
    def frame(self) -> int:
        """Frame number in the whole motion."""
        return self.row + self.motion.first_frame

    @property
    def over_time(self) -> AdaptedMotion:
        """Newest motion with several frames, for paths over time; the displayed frame if that motion is of a body with
        other segments, because the character was just replaced.
        """
        around = self.frames_around
        if around is None or around.morphology.layout != self.motion.morphology.layout:
            return self.motion
        return around

    @cached_property
    def points(self) -> FloatArray:
        """(K+23, 3) canonical points on the stage, in metres."""
        return self.placement.to_stage(self.motion.positions[self.row])

    def has_same_pose(self, newer: AdaptedMotion) -> bool:
        """True if a newer result of the same performer has the same pose at this moment."""
        row = self.frame - newer.first_frame
        return 0 <= row < newer.frame_count and np.array_equal(newer.positions[row], self.motion.positions[self.row])

    @cached_property
    def played(self) -> PlayedPiece | None:
        """Clip piece of the composite motion that plays at this frame; None for a motion that is not composed of
        clips.
        """
        composite = self.motion.composite
        return composite.piece_at(self.frame) if composite else None

    @property
    def mirrored(self) -> bool:
        """True if the playing clip is mirrored."""
        return self.played is not None and self.played.piece.mirrored

    @cached_property
    def seconds(self) -> float:
        """Time in seconds of the playing clip's motion."""
        frame, composite = self.frame, self.motion.composite
        if composite is None or composite.is_plain:
            return frame / self.motion.frame_rate
        played = composite.piece_at(frame)
        return float(played.motion_frames(np.array([frame]), composite.timing)[0]) / played.piece.motion.frame_rate

    @cached_property
    def clip(self) -> Clip | None:
        """Clip that plays at this frame; None if there is none."""
        clips, played = self.performer.clips, self.played
        place = played.piece.origin[0] if played else 0
        return clips[min(place, len(clips) - 1)] if clips else None

    def grip(self, own: float) -> float:
        """Hand pose from -1 (open) to 1 (fists): that of the playing clips, else that of held props, else the
        character's ``own``.
        """
        own += self.holding * (self.holding_grip - own)
        clips, composite = self.performer.clips, self.motion.composite
        before = composite.fingers_before if composite else None
        if composite is None or (before is None and all(clip.grip is None for clip in clips)):
            return own
        closed = 0.0
        for piece, weight in weighted_pieces(composite, np.array([self.frame])):
            place = min(piece.piece.origin[0], len(clips) - 1)
            if place < 0 and before is not None:
                grip = own + before.asked[0] * (before.grips[0] - own)
            else:
                asked = clips[place].grip
                grip = own if asked is None else asked
            closed += float(weight[0] * grip)
        return closed

    @property
    def shape_of_hands(self) -> tuple[object, ...]:
        """Values on which ``fingers`` depend apart from the frame of the motion."""
        return self.performer.clips, tuple(map(id, self.captures)), self.holding, self.holding_grip

    @cached_property
    def fingers(self) -> FingerPoses | None:
        """Finger poses of this frame; None for a motion that is not composed of clips."""
        composite, held = self.motion.composite, (self.holding, self.holding_grip)
        if composite is None or not self.captures:
            return None
        weight, grip = (np.array([each]) for each in held)
        frames = np.array([self.frame])
        return fingers_of_row(composite, self.performer.clips, self.captures, frames, (weight, grip))

    @property
    def streamed_fingers(self) -> FingerPoses | None:
        """Finger poses of this frame; None if the clips neither capture fingers nor set a hand pose."""
        known = any(clip.grip is not None for clip in self.performer.clips) or any(map(has_fingers, self.captures))
        return self.fingers if known or self.holding else None

    @cached_property
    def clip_placement(self) -> Placement:
        """Placement on the stage of the playing clip's motion, the space of constraints and targets."""
        played, leg = self.played, self.motion.body.leg_length
        if played is None:
            return self.placement
        x, y = played.placement.offset
        return self.placement.compose(Placement((leg * x, leg * y), played.placement.turn))

    def points_in_clip(self, points: ArrayLike) -> FloatArray:
        """Points (..., 3) of the performer's motion in the space of the playing clip, which is that of its
        constraints.
        """
        if self.clip_placement == self.placement:
            return np.asarray(points)
        return self.clip_placement.to_motion(self.placement.to_stage(points))

    def rotation_in_clip(self, part: BodyPart) -> FloatArray:
        """Rotation matrix (3, 3) of a segment in the space of the playing clip."""
        rotation: FloatArray = self.motion.rotations[self.row, self.motion.morphology.layout.segment_of_part(part)]
        if self.clip_placement == self.placement:
            return rotation
        return np.asarray(self.clip_placement.rotation.T @ self.placement.rotation @ rotation)

    @property
    def motion_id(self) -> str | None:
        """Id of the playing motion; None if there is none."""
        return self.clip.motion_id if self.clip else None

    def contacts_in(self, project: Project) -> tuple[ContactInterval, ...]:
        """Contacts of the playing motion; on a track with several clips, the foot contacts after transitions."""
        composite = self.motion.composite
        if composite is None:
            return tuple(project.contacts_of(self.motion_id or "").values())
        feet = [each for each in self.motion.contacts if each.point in FOOT_POINTS]
        return (*feet, *(each for each in composite.contacts if each.point not in FOOT_POINTS))


def pose_of(project: Project, performer_id: str, motion: AdaptedMotion, time: float) -> PosedPerformer:
    """Pose of a performer with the adapted ``motion`` at a stage time in seconds."""
    performer = project.performers[performer_id]
    weights, grips = grips_on_props(project.props.values(), performer_id, np.array([time]))
    return PosedPerformer(
        performer,
        motion,
        _row_of(project, performer, motion, time),
        Placement.of(performer),
        captures=() if project.missing_references(performer) else captures_of_clips(project, performer),
        holding=float(weights[0]),
        holding_grip=float(grips[0]),
    )


def _row_of(project: Project, performer: Performer, motion: AdaptedMotion, time: float) -> int:
    return row_at(motion, timing_of(project, performer) if performer.clips else None, time)


def posed_performers(
    project: Project, result_of: ResultOf, time: float, around: ResultOf = lambda _: None
) -> dict[str, PosedPerformer]:
    """Poses by id of the visible performers that have an adapted motion, at a stage time in seconds; ``around`` returns
    motions over several frames.
    """
    posed = {}
    for performer_id, performer in project.performers.items():
        character = project.characters.get(performer.character_id) if performer.visible else None
        motion = result_of(performer_id) if character is not None else None
        # A result may still be of the body that the performer had before.
        if motion is not None and character is not None and motion.morphology.layout == character.build.layout:
            pose = pose_of(project, performer_id, motion, time)
            posed[performer_id] = replace(pose, frames_around=around(performer_id))
    return posed


def displayed_stage(document: Document, live: Live) -> tuple[Project, float, dict[str, PosedPerformer]]:
    """Project, stage time in seconds, and poses of the visible performers: at the playhead, or of live play."""
    moment = live.play.moment
    if moment is not None:
        return moment.project, moment.seconds, posed_performers(moment.project, live.shown_frame, moment.seconds)
    project, time = document.project, document.playhead.time
    return project, time, posed_performers(project, live.shown_frame, time, live.result)


def swept_points(project: Project, result_of: ResultOf) -> dict[str, FloatArray]:
    """(T, P, 2) ground positions in metres of the points of each performer over all its clips, root first, relative to
    its position and in the axes of its placement.
    """
    clips = [clip for performer in project.performers.values() for clip in performer.clips]
    end = max((clip.start + clip.length(project.frame_rate_of(clip)) for clip in clips), default=0.0)
    times = np.arange(int(max(end, 0.0) * PATH_RATE_HZ) + 1) / PATH_RATE_HZ
    swept = {}
    for performer_id, performer in project.performers.items():
        motion = result_of(performer_id) if performer.clips else None
        if motion is not None:
            timing = timing_of(project, performer)
            swept[performer_id] = motion.positions[rows_at(motion, timing, times), :, :2]
    return swept


def resting_performers(project: Project, posed: Mapping[str, PosedPerformer]) -> dict[str, PosedPerformer]:
    """Rest poses of the visible performers that are not in ``posed``, at their positions on the stage."""
    resting = {}
    for performer_id, performer in project.performers.items():
        character = project.characters.get(performer.character_id) if performer.visible else None
        if character is not None and performer_id not in posed:
            positions, rotations = (part[None] for part in rest_pose(character.morphology))
            motion = AdaptedMotion(character.morphology, 1.0, 0, positions, rotations, np.empty((0, 1)))
            resting[performer_id] = PosedPerformer(performer, motion, 0, Placement.of(performer), resting=True)
    return resting


def has_new_frames(project: Project, posed: Mapping[str, PosedPerformer], time: float) -> bool:
    """True if any performer has another frame at the stage time ``time`` than in ``posed``."""
    return any(
        one.over_time.first_frame + _row_of(project, one.performer, one.over_time, time) != one.frame
        for one in posed.values()
    )
