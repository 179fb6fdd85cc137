"""Shown: everything that the rows need for drawing and hit tests."""

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
"""Pixels at the left of a label that fold its row."""


class ItemPart(StrEnum):
    """Part of an entity that is under the mouse or has the keyboard focus."""

    BODY = "body"
    START = "start"
    FULL = "ease-in end"
    FULL_END = "ease-out start"
    END = "end"
    FIRST = "first frame"
    LAST = "last frame"
    KEY = "key"
    LABEL = "label"
    FOLD = "fold"
    EMPTY = "empty"
    TIME = "time"


HANDLES = (ItemPart.START, ItemPart.FULL, ItemPart.FULL_END, ItemPart.END)
EDGES = (ItemPart.FIRST, ItemPart.LAST)


@dataclass(frozen=True)
class TimelineRow:
    """Row: its kind, its id, and its offset below the first row in pixels.

    Kinds are labels, constraints, clip, layer, corrections, growth, props and lane; summary and sheet are those of the
    dope sheet. A row of clips or of growth has its performer's id, one of layers that and the region.
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
    """Part under a point: its kind, its id (an empty place of a line has its contact point), its part.

    A clip is in the row of ``performer_id``; a diamond is all ``keys`` at one time.
    """

    kind: str
    id: str
    part: ItemPart
    performer_id: str = ""
    keys: tuple[KeyRef, ...] = ()


@dataclass(frozen=True, eq=False)
class RowContext:
    """Document, motion, axis and results of the timeline, and the focused handle."""

    document: Document
    live: Live
    axis: TimeAxis
    subject: ActiveMotion
    handle: ItemPart | None = None
    folded: frozenset[tuple[str, str]] = frozenset()
    """Kind and id of the rows that are only a line high."""
    rows_per_performer: bool = False
    """True if every performer has its row of clips; else the active one's stands for all."""
    remarks: tuple[Remark, ...] = ()
    """Remarks on the capture of the motion."""
    shows_dope_sheet: bool = False
    """True if the rows are those of the dope sheet."""
    curves: bool = False
    """True if the plot is the curve editor."""

    @property
    def project(self) -> Project:
        """Project as the active clip shows it."""
        return self.document.shown_project

    @property
    def subject_name(self) -> str:
        """Name of the active performer."""
        return self.project.performers[self.subject.performer_id].name

    def is_selected(self, collection: str, entity_id: str) -> bool:
        """True if an entity is selected."""
        return (collection, entity_id) in self.document.selection

    def x_of_frame(self, frame: float) -> float:
        """Pixel of a frame of the motion."""
        return self.axis.x_of_time(self.subject.stage_time(frame))

    def frame_words(self, frame: float) -> str:
        """``frame 1809 (178 of the clip)``: the frame of the stage for a frame of the motion."""
        stage = self.subject.stage_time(frame)
        return frame_words(stage * self.axis.frame_rate, self.subject.looped_frame(stage))

    def moment(self, frame: float) -> str:
        """``30.151 s · frame 1809 (178 of the clip)``, of a frame of the motion."""
        return f"{self.subject.stage_time(frame):.3f} s · {self.frame_words(frame)}"

    def xs_of_frames(self, frames: FloatArray) -> FloatArray:
        """Pixels of frames of the motion, of any shape."""
        seconds = self.subject.to_stage(frames / self.subject.frame_rate)
        return self.axis.left + (seconds - self.axis.start) * self.axis.scale

    def frame_at(self, x: float) -> float:
        """Frame of the motion at a pixel, with a fraction."""
        return self.subject.motion_frame(self.axis.time_at(x))

    def x_of_motion_time(self, seconds: float) -> float:
        """Pixel of a time of the motion."""
        return self.axis.x_of_time(self.subject.to_stage(seconds))

    @property
    def later_repeats(self) -> range:
        """Visible repeats of the clip after its first one."""
        clip, rate, axis = self.subject.clip, self.subject.frame_rate, self.axis
        left, right = (clip.repeat_at(axis.time_at(x), rate) for x in (axis.left, axis.right))
        return range(max(left, 1), right + 1)

    def result(self, performer_id: str) -> AdaptedMotion | None:
        """Newest adapted motion of a body."""
        return self.live.result(performer_id)

    def strip(self, constraint_id: str, performer_id: str) -> ErrorStrip | None:
        """Strip of a constraint on a body; None while it is unknown or the constraint is inactive."""
        return strip_of(self.project, performer_id, self.live.reported_motion(performer_id), constraint_id)

    def applies_to(self, constraint_id: str, performer_id: str) -> bool:
        """True if a constraint applies to a body."""
        return applies_to(self.project, performer_id, constraint_id)

    def residual(self, constraint_id: str, performer_id: str) -> Residual | None:
        """Worst residual of a constraint on a body."""
        return worst_residual(self.project, performer_id, self.live.reported_motion(performer_id), constraint_id)

    def inactivity(self, constraint_id: str, performer_id: str) -> Inactive:
        """Reason why a constraint without a residual is inactive on a body."""
        return inactivity(self.project, performer_id, self.live.reported_motion(performer_id), constraint_id)


def frame_words(stage: float, own: float) -> str:
    """``frame 1809 (178 of the clip)``, of frames of the stage and of the motion."""
    of_clip = f" ({number_text(own)} of the clip)" if abs(stage - own) >= 0.005 else ""
    return f"frame {number_text(stage)}{of_clip}"


def clipped_span(point: QPointF, x: float, y: float, reach: float) -> bool:
    """True if a point is within ``reach`` pixels of another, horizontally and vertically."""
    return abs(point.x() - x) <= reach and abs(point.y() - y) <= reach


def label_area(row: QRect) -> QRect:
    """Rectangle of a row's label."""
    return QRect(0, row.top(), ROW_LABEL_WIDTH, row.height())
