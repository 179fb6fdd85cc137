"""Options of an exported file, the same for all formats, for the window, the command line and scripts."""

import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.core.body.pose import PoseSequence
from studio.core.body.pose_sampling import poses_at
from studio.core.captures.annotations import Annotations
from studio.core.errors import StudioError
from studio.core.plausible import FRAME_RATE_RANGE
from studio.core.rigs.root_motion import capture_in_place, with_root_joint
from studio.core.rigs.zero_pose import t_pose, with_zero_pose
from studio.core.rotations import IDENTITY_QUATERNION, from_matrix, multiply
from studio.core.stage.placement import Placement
from studio.io.export import Take, skin_of
from studio.io.export_choices import (
    HIPS_ONLY_SUFFIXES,
    JOINT_SUFFIXES,
    REST_POSE_SUFFIXES,
    REST_POSES,
    ROOT_CHOICES,
    SKELETON_SUFFIXES,
)
from studio.io.joint_names import with_joint_names
from studio.io.takes.own_rig import has_own_rig, take_on_own_rig

FloatArray = NDArray[np.float64]

MOST_EXPORTED_FRAMES = 1_000_000
"""Maximum number of frames of a file: more than two hours at 120 fps."""
_ENDS = 1e-6
"""A part of a frame by which a range may be too short for it."""


@dataclass(frozen=True)
class ExportOptions:
    """Options of an export; empty ones keep the take's own values.

    These are a T-pose and the names of HumanIK for characters, and a capture's own for a capture.
    """

    joint_names: str = ""
    """Key of ``joint_names.joint_namings``; empty to keep the names, or a character's own joints if it has some."""
    rest_pose: str = ""
    """Key of ``REST_POSES``; ``own`` is the pose in which a character's skin is bound, or the file's own."""
    body_only: bool = False
    """True to leave out extra joints of a capture: fingers, eyes, twist bones, props."""
    begin: float | None = None
    """First second to write, of the motion, or of the stage for a performer."""
    end: float | None = None
    """Last second to write."""
    frame_rate: float | None = None
    """Frame rate in Hz; frames between those of the motion are interpolated."""
    root: str = ""
    """Key of ``ROOT_CHOICES``."""
    at_origin: bool = False
    """True to leave a body at the begin of its own motion, instead of its position on the stage."""

    def carries(self, path: Path) -> bool:
        """True if a character's file at ``path`` also gets the capture's extra joints: skeletons do, tables do not."""
        return not self.body_only and path.suffix.lower() in SKELETON_SUFFIXES

    def check(self, path: Path) -> None:
        """Raise StudioError if a choice does not fit the format of ``path``."""
        suffix = path.suffix.lower()
        if self.rest_pose and suffix not in REST_POSE_SUFFIXES:
            raise StudioError(
                f"{path.name} has no rest pose to choose. Skeletons have: {', '.join(REST_POSE_SUFFIXES)}."
            )
        for name, value, known in (("rest pose", self.rest_pose, REST_POSES), ("root", self.root, ROOT_CHOICES)):
            if value and value not in known:
                raise StudioError(f"There is no {name} '{value}'. Choose {', '.join(filter(None, known))}.")
        if self.root == "floor" and suffix in HIPS_ONLY_SUFFIXES:
            raise StudioError(f"{path.name} has no root joint: its hips travel. Choose in-place or none.")
        rate = self.frame_rate
        if rate is not None and not FRAME_RATE_RANGE.least <= rate <= FRAME_RATE_RANGE.most:
            raise StudioError(
                f"A frame rate is from {FRAME_RATE_RANGE.least:g} to {FRAME_RATE_RANGE.most:g} fps, not {rate:g}."
            )
        if not all(math.isfinite(end) for end in (self.begin, self.end) if end is not None):
            raise StudioError("A range runs from a second to a later one; each is a finite number.")
        if self.begin is not None and self.end is not None and self.begin > self.end:
            raise StudioError(f"A range runs from a second to a later one, not from {self.begin:g} to {self.end:g}.")

    def applied_to(self, take: Take, path: Path) -> Take:
        """``take`` with the options applied for a file at ``path``. Raises StudioError if a choice does not fit."""
        self.check(path)
        if path.suffix.lower() == ".s4d" and take.annotations.constraints and self._is_timed(take):
            raise StudioError(
                f"{path.name}: the constraints of '{take.name}' count from its first frame. Write all of it at its own"
                " frame rate, or another kind of file."
            )
        take = self._on_joints(take, path)
        return self._shaped(self._timed(take) if self._is_timed(take) else take, path)

    def applied_over(self, take: Take, seconds: FloatArray, frame_rate: float, path: Path) -> Take:
        """Take with the options applied in frames at stage ``seconds`` (N,), ignoring the range; outside its own frames
        it holds still.
        """
        self.check(path)
        return self._shaped(sampled_take(self._on_joints(take, path), seconds - take.begin, frame_rate), path)

    def _on_joints(self, take: Take, path: Path) -> Take:
        """Take on the chosen joints, frame by frame as adapted."""
        if not self.joint_names and path.suffix.lower() in JOINT_SUFFIXES and has_own_rig(take):
            return take_on_own_rig(take, path.suffix.lower(), Placement() if self.at_origin else take.place)
        return take

    def _shaped(self, take: Take, path: Path) -> Take:
        """Take with the chosen placement, zero pose, root and names."""
        if not self.at_origin:
            take = placed_take(take)
        take = self._from_rest_pose(take, path)
        if self.root == "floor":
            capture, bound, rest = with_root_joint(take.capture, _lowest_bone(take)), take.bound, take.rest_rotations
            if capture.skeleton.joint_count > take.skeleton.joint_count:
                bound = skin_of(take).with_joint_above() if take.character else None
                rest = None if rest is None else np.concatenate([IDENTITY_QUATERNION[None], rest])
            take = replace(take, capture=capture, bound=bound, rest_rotations=rest)
        elif self.root == "in-place":
            take = replace(take, capture=capture_in_place(take.capture))
        if self.joint_names:
            take = replace(take, capture=with_joint_names(take.capture, self.joint_names))
        return take

    def _is_timed(self, take: Take) -> bool:
        """True if the options ask for frames other than those of the take."""
        others = self.frame_rate not in (None, take.frame_rate)
        return others or self.begin is not None or self.end is not None

    def _timed(self, take: Take) -> Take:
        """Take in the chosen frames."""
        own, rate = take.frame_rate, self.frame_rate or take.frame_rate
        last = (take.poses.frame_count - 1) / own
        start = 0.0 if self.begin is None else max(self.begin - take.begin, 0.0)
        stop = last if self.end is None else min(self.end - take.begin, last)
        if start > stop + _ENDS / rate:
            raise StudioError(
                f"'{take.name}' plays from second {take.begin:.2f} to {take.begin + last:.2f}: none of it lies in the"
                " range. Choose another range."
            )
        if rate == own:
            start = round(start * own) / own
        return sampled_take(take, frame_times(start, stop, rate), rate)

    def _from_rest_pose(self, take: Take, path: Path) -> Take:
        """Take with the chosen zero pose."""
        if take.rest_rotations is not None:
            if self.rest_pose != "t" and path.suffix.lower() != ".bvh":
                return take
            skin = skin_of(take)
            rotations = t_pose(take.capture) if self.rest_pose == "t" else skin.bind_rotations
            capture = with_zero_pose(take.capture, rotations)
            return replace(take, capture=capture, bound=skin.counted_from(rotations), rest_rotations=None)
        if self.rest_pose == "t" and take.character is None:
            return replace(take, capture=with_zero_pose(take.capture, t_pose(take.capture)))
        if self.rest_pose == "own" and take.character is not None:
            skin = skin_of(take)
            capture = with_zero_pose(take.capture, skin.bind_rotations)
            return replace(take, capture=capture, bound=skin.counted_from(skin.bind_rotations))
        return take


def _lowest_bone(take: Take) -> int:
    """First bone on the path to the hips: nodes above it only carry the skeleton."""
    hips = take.capture.body_map.spine[0] if take.capture.body_map else 0
    bones = None if take.bound is None else take.bound.bones
    return next((each for each in take.skeleton.path(0, hips) if bones is None or bones[each]), hips)


def frame_times(begin: float, end: float, frame_rate: float) -> FloatArray:
    """Times (N,) in seconds of the frames of a file. Raises StudioError if there are too many."""
    count = int((end - begin) * frame_rate + _ENDS) + 1
    if count > MOST_EXPORTED_FRAMES:
        raise StudioError(
            f"A file of {count:,} frames is too large: it holds {MOST_EXPORTED_FRAMES:,}. Choose a lower frame rate or"
            " a shorter range."
        )
    return begin + np.arange(count) / frame_rate


def sampled_take(take: Take, seconds: FloatArray, frame_rate: float) -> Take:
    """Take sampled at ``seconds`` (N,) from its own first frame, as N frames at ``frame_rate``."""
    frames = seconds * take.frame_rate
    first, last = frames[0], frames[-1]

    def moved(frame: int) -> int:
        return round(float(min(max(frame, first), last) - first) / take.frame_rate * frame_rate)

    capture = replace(
        take.capture,
        poses=poses_at(take.poses, frames),
        frame_rate=frame_rate,
        first_frame=min(moved(take.capture.first_frame), len(frames) - 1),
        markers=None,
    )
    spans = take.annotations
    kept = {
        name: tuple(
            replace(each, first=moved(each.first), last=moved(each.last))
            for each in getattr(spans, name)
            if each.first <= last and each.last >= first
        )
        for name in ("contacts", "labels")
        if getattr(spans, name) is not None
    }
    adapted = take.adapted
    if adapted is not None:
        rows = np.clip(np.rint(frames), 0, adapted.frame_count - 1).astype(np.int64)
        adapted = replace(
            adapted,
            frame_rate=frame_rate,
            positions=adapted.positions[rows],
            rotations=adapted.rotations[rows],
            residuals=adapted.residuals[:, rows],
        )
    annotations = Annotations(kept.get("contacts"), spans.constraints, kept["labels"])
    return replace(
        take, capture=capture, annotations=annotations, adapted=adapted, begin=take.begin + float(seconds[0])
    )


def placed_take(take: Take) -> Take:
    """Take at its position on the stage."""
    capture, place = take.capture, take.place
    if place.position == (0.0, 0.0) and place.heading == 0.0:
        return take
    turn = from_matrix(place.rotation)
    rotations, translations = np.array(capture.poses.local_rotations), np.array(capture.poses.local_translations)
    rotations[:, 0] = multiply(turn, rotations[:, 0])
    translations[:, 0] = place.to_stage(translations[:, 0])
    return replace(take, capture=replace(capture, poses=PoseSequence(rotations, translations)), place=Placement())
