"""Context of the tracks: the data for painting and hit tests."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRect

from studio.core.captures.remarks import Remark
from studio.core.solver.request import AdaptedMotion
from studio.core.stage.project import Project
from studio.document.document import Document
from studio.document.keyed_fields import KeyRef
from studio.engine.live_interface import Live
from studio.engine.residuals import Inactive, Residual, applies_to, inactivity, worst_residual
from studio.timeline.axis import TimeAxis
from studio.timeline.strip_states import ErrorStrip, strip_of
from studio.timeline.subject import ActiveMotion
from studio.timeline.time_words import number_text

FloatArray = NDArray[np.float64]

ROW_LABEL_WIDTH = 196
FOLD_WIDTH = 14
"""Width in pixels of the area at the left of a track's name that collapses the track."""


class ItemPart(StrEnum):
    """Part of an entity under the mouse or with the keyboard focus."""

    BODY = "body"
    START = "start"
    FULL = "fade-in end"
    FULL_END = "fade-out start"
    END = "end"
    FIRST = "first frame"
    LAST = "last frame"
    KEY = "key"
    LABEL = "label"
    FOLD = "fold"
    EMPTY = "empty"
    TIME = "time"


HANDLE_PARTS = (ItemPart.START, ItemPart.FULL, ItemPart.FULL_END, ItemPart.END)
EDGE_PARTS = (ItemPart.FIRST, ItemPart.LAST)


@dataclass(frozen=True)
class TimelineRow:
    """Track of the timeline: its kind and id, and its offset ``y`` below the first track and its height in pixels.

    Kinds are labels, constraints, clip, layer, corrections, growth, props and lane, and in the dope sheet summary and
    sheet. The id of a clip or growth track is that of the performer; that of a layer track names performer and body
    region.
    """

    kind: str
    id: str
    y: int
    height: int

    @property
    def key(self) -> tuple[str, str]:
        """Kind and id."""
        return self.kind, self.id


@dataclass(frozen=True)
class Hit:
    """Part under the mouse: kind, id and part. In the empty space of a contact lane, the id is the contact point.

    ``performer_id`` is that of the track of a clip; ``keys`` are all keys of a diamond, at one time.
    """

    kind: str
    id: str
    part: ItemPart
    performer_id: str = ""
    keys: tuple[KeyRef, ...] = ()


@dataclass(frozen=True, eq=False)
class RowContext:
    """Document, active motion, axis and results that the tracks show, and the focused handle."""

    document: Document
    live: Live
    axis: TimeAxis
    subject: ActiveMotion
    handle: ItemPart | None = None
    folded: frozenset[tuple[str, str]] = frozenset()
    """Kind and id of the collapsed tracks."""
    rows_per_performer: bool = False
    """True if every performer has a clip track; otherwise one track stands for all."""
    remarks: tuple[Remark, ...] = ()
    """Remarks on the capture of the motion, for the ruler."""
    shows_dope_sheet: bool = False
    """True if the tracks are those of the dope sheet."""
    curves: bool = False
    """True if the graph is the curve editor."""

    @property
    def project(self) -> Project:
        """Project, mirrored if the active clip is."""
        return self.document.shown_project

    @property
    def subject_name(self) -> str:
        """Name of the active performer."""
        return self.project.performers[self.subject.performer_id].name

    def is_selected(self, collection: str, entity_id: str) -> bool:
        """True if an entity is selected."""
        return (collection, entity_id) in self.document.selection

    def x_of_frame(self, frame: float) -> float:
        """Pixel of a frame of the active motion."""
        return self.axis.x_of_time(self.subject.stage_time(frame))

    def frame_words(self, frame: float) -> str:
        """Stage frame for a frame of the active motion: ``frame 1809 (178 of the clip)``."""
        stage = self.subject.stage_time(frame)
        return frame_words(stage * self.axis.frame_rate, self.subject.looped_frame(stage))

    def moment(self, frame: float) -> str:
        """Stage time and frame for a frame of the active motion: ``30.151 s · frame 1809 (178 of the clip)``."""
        return f"{self.subject.stage_time(frame):.3f} s · {self.frame_words(frame)}"

    def xs_of_frames(self, frames: FloatArray) -> FloatArray:
        """Pixels of frames of the active motion, of the same shape."""
        seconds = self.subject.to_stage(frames / self.subject.frame_rate)
        return self.axis.left + (seconds - self.axis.start) * self.axis.scale

    def frame_at(self, x: float) -> float:
        """Frame of the active motion at a pixel, as a fractional number."""
        return self.subject.motion_frame(self.axis.time_at(x))

    def x_of_motion_time(self, seconds: float) -> float:
        """Pixel of a time of the active motion in seconds."""
        return self.axis.x_of_time(self.subject.to_stage(seconds))

    @property
    def later_repeats(self) -> range:
        """Indices of the visible loops of the clip after the first one."""
        clip, rate, axis = self.subject.clip, self.subject.frame_rate, self.axis
        left, right = (clip.repeat_at(axis.time_at(x), rate) for x in (axis.left, axis.right))
        return range(max(left, 1), right + 1)

    def result(self, performer_id: str) -> AdaptedMotion | None:
        """Newest adapted motion of a performer; None if it has none."""
        return self.live.result(performer_id)

    def strip(self, constraint_id: str, performer_id: str) -> ErrorStrip | None:
        """Error strip of a constraint on a performer; None if it is unknown or the constraint is inactive."""
        return strip_of(self.project, performer_id, self.live.reported_motion(performer_id), constraint_id)

    def applies_to(self, constraint_id: str, performer_id: str) -> bool:
        """True if a constraint applies to a performer."""
        return applies_to(self.project, performer_id, constraint_id)

    def residual(self, constraint_id: str, performer_id: str) -> Residual | None:
        """Worst residual of a constraint on a performer; None if it is unknown or the constraint is inactive."""
        return worst_residual(self.project, performer_id, self.live.reported_motion(performer_id), constraint_id)

    def inactivity(self, constraint_id: str, performer_id: str) -> Inactive:
        """Reason why a constraint without a residual is inactive on a performer."""
        return inactivity(self.project, performer_id, self.live.reported_motion(performer_id), constraint_id)


def frame_words(stage: float, own: float) -> str:
    """Frame as text, ``frame 1809 (178 of the clip)``, from the frame of the stage and of the active motion."""
    of_clip = f" ({number_text(own)} of the clip)" if abs(stage - own) >= 0.005 else ""
    return f"frame {number_text(stage)}{of_clip}"


def clipped_span(point: QPointF, x: float, y: float, reach: float) -> bool:
    """True if ``point`` is within ``reach`` pixels of (x, y), horizontally and vertically."""
    return abs(point.x() - x) <= reach and abs(point.y() - y) <= reach


def label_area(row: QRect) -> QRect:
    """Rectangle of the name of a track."""
    return QRect(0, row.top(), ROW_LABEL_WIDTH, row.height())
