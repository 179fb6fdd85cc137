"""Timeline panel: the transport and, below it, tracks and graph."""

from PySide6.QtCore import QPoint, QRect, Signal
from PySide6.QtGui import QCloseEvent
from PySide6.QtWidgets import QVBoxLayout, QWidget

from studio.core.captures.contacts import ContactPoint
from studio.document.document import Document
from studio.engine.live_interface import Live
from studio.timeline import edits
from studio.timeline.sheet import TimelineLayout
from studio.timeline.shown import ItemPart
from studio.timeline.strip_states import StripState
from studio.timeline.track_canvas import TrackCanvas
from studio.timeline.tracks import constraint, contacts
from studio.timeline.tracks.error_strip import STRIP_SPACING_PIXELS
from studio.timeline.transport import Transport


class Timeline(QWidget):
    """Transport, ruler, tracks and graph below the 3D view.

    Positions are in pixels of ``tracks``, the widget with the tracks. ``message_posted`` is emitted with a text about
    the part under the mouse, for the status line.
    """

    message_posted = Signal(str)
    action_requested = Signal(str)
    """Emitted with the id of an action."""

    def __init__(self, document: Document, live: Live, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.transport = Transport(document, live.play, self)
        self.transport.action_requested.connect(self.action_requested)
        self.transport.dope.clicked.connect(self.set_dope)
        self.transport.curves.clicked.connect(self.edit_curves)
        self.tracks = TrackCanvas(document, live, self)
        self.tracks.message_posted.connect(self.message_posted)
        self._closed = False
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(0)
        layout.addWidget(self.transport)
        layout.addWidget(self.tracks, 1)

    def x_of_frame(self, frame: float) -> float:
        """Pixel of a stage frame."""
        return self.tracks.axis.x_of_frame(frame)

    def frame_at(self, x: float) -> float:
        """Stage frame at a pixel, as a fractional number."""
        return self.tracks.axis.frame_at(x)

    def row_rect(self, kind: str, row_id: str = "") -> QRect:
        """Rectangle of a track; empty if there is none.

        Kinds: ``ruler``, ``labels``, ``clip`` (id of the performer), ``lane`` (left foot, right foot, hands, knees,
        seat), ``constraints``, ``plot``.
        """
        sheet = self.tracks.sheet
        if sheet is None:
            return QRect()
        if kind in ("ruler", "plot"):
            return sheet.ruler if kind == "ruler" else sheet.plot
        row = sheet.find(kind, row_id)
        return sheet.rect(row) if row else QRect()

    def handle_point(self, constraint_id: str, handle: str) -> QPoint:
        """Pixel of a handle of a constraint's activation: ``start``, ``fade-in end``, ``fade-out start`` or ``end``."""
        sheet = self._sheet()
        entity = sheet.context.project.constraints[constraint_id]
        points = constraint.handle_points(sheet.context, self.row_rect("constraints", constraint_id), entity)
        return points[ItemPart(handle)].toPoint()

    def contact_rect(self, contact_id: str) -> QRect:
        """Rectangle of a contact's bar."""
        sheet = self._sheet()
        contact = sheet.context.project.contacts[contact_id]
        row = self.row_rect("lane", contacts.row_of(contact.point))
        return contacts.contact_bar(sheet.context, row, contact).toRect()

    def strip_point(self, constraint_id: str, performer_id: str, frame: int) -> QPoint:
        """Pixel of a performer's error strip at a frame of the active motion."""
        shown = self._sheet().context
        index = [body.performer_id for body in shown.subject.bodies].index(performer_id)
        top = constraint.strip_top(self.row_rect("constraints", constraint_id), index)
        return QPoint(round(shown.x_of_frame(frame)), top + STRIP_SPACING_PIXELS - 1)

    def strip_state(self, constraint_id: str, performer_id: str, frame: int) -> StripState:
        """State of a performer's error strip at a frame of the active motion."""
        shown = self._sheet().context
        strip = shown.strip(constraint_id, performer_id)
        unknown = StripState.UNKNOWN if shown.applies_to(constraint_id, performer_id) else StripState.INACTIVE
        return strip.state_at(shown.subject.stage_time(frame)) if strip else unknown

    def fit(self) -> None:
        """Show the whole stage time."""
        self.tracks.axis.fit()

    @property
    def dope(self) -> bool:
        """True if the tracks are those of the dope sheet."""
        return self.tracks.dope

    def set_dope(self, dope: bool) -> None:
        """Show the dope sheet of the selection, or the usual tracks."""
        self.tracks.set_dope(dope)
        self.transport.dope.setChecked(dope)

    @property
    def editing_curves(self) -> bool:
        """True if the graph is the curve editor."""
        return self.tracks.editing

    def edit_curves(self, editing: bool) -> None:
        """Show the curve editor of the selection in place of the graph, or the graph again."""
        self.tracks.set_editing(editing)
        self.transport.curves.setChecked(editing)

    def fold_rows(self) -> None:
        """Collapse constraint tracks and the graph to one line each, or expand them."""
        self.tracks.fold_all()

    def show_progress(self, words: str, share: float) -> None:
        """Show the text and progress (0 to 1) of a task; an empty text if none runs."""
        self.tracks.show_progress(words, share)

    def add_contact(self, point: ContactPoint) -> str | None:
        """Add a contact at the playhead and return its id; None if one is there already, or without a motion."""
        shown = self.tracks.shown
        if shown is None:
            return None
        return edits.add_contact(shown, point, round(shown.subject.motion_frame(shown.document.playhead.time)))

    def add_label(self) -> str | None:
        """Add a label at the playhead and return its id; None without a motion."""
        shown = self.tracks.shown
        if shown is None:
            return None
        return edits.add_label(shown, round(shown.subject.motion_frame(shown.document.playhead.time)))

    def go_to_label(self, direction: int) -> None:
        """Move the playhead to the next (1) or previous (-1) label."""
        if self.tracks.shown is not None:
            edits.go_to_label(self.tracks.shown, direction)

    def go_to_key(self, direction: int) -> None:
        """Move the playhead to the next (1) or previous (-1) end of a contact, time of an activation, or key."""
        if self.tracks.shown is not None:
            edits.go_to_key(self.tracks.shown, direction)

    def closeEvent(self, event: QCloseEvent) -> None:
        """Disconnect from the document."""
        if not self._closed:
            self._closed = True
            self.tracks.leave()
            self.transport.leave()
        super().closeEvent(event)

    def _sheet(self) -> TimelineLayout:
        if self.tracks.sheet is None:
            raise LookupError("The timeline is empty.")
        return self.tracks.sheet
