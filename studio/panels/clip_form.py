"""Form for the strike label of a library clip, with a small timeline and the pose at each mark."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QEvent, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QKeyEvent, QKeySequence, QPainter, QPaintEvent
from PySide6.QtWidgets import QFrame, QHBoxLayout, QScrollArea, QVBoxLayout, QWidget

from studio.document import colours
from studio.library.clip_labels import HIT_SEGMENTS, ClipLabel, Kind, Limb
from studio.panels.clip_line import ClipLine, ClipMark, with_mark
from studio.panels.fields import FIELD_ICON_PX, Choice, NumberField, Section, TagField, press_button, styled_label
from studio.panels.stick_figure import FigureView, paint_sticks

if TYPE_CHECKING:
    from studio.library.label_motion import OpenedClip

FIGURES_PX, CAPTION_PX = 104, 16
AUTOMATIC_LABEL_HINT = (
    "Classified automatically. Drag trim handles and hit marker, set the type, and confirm; indexing keeps your"
    " classification."
)
CONFIRMED_LABEL_HINT = "Confirmed (kept on re-indexing)"


class ClipForm(QScrollArea):
    """Form for the strike label of a library clip. ``confirmed`` carries the label as edited by the user; ``closed``
    requests the list of strikes again.
    """

    confirmed = Signal(object)
    closed = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setWidgetResizable(True)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._steps: list[ClipLabel] = []
        self._opened: OpenedClip | None = None
        self.line, self.figures = ClipLine(), HitFigures()
        self.limb = Choice("Limb", [(limb, limb.words.capitalize()) for limb in Limb])
        self.kind = Choice("Type", [(kind, kind.capitalize()) for kind in Kind])
        self.segment = Choice("Striking body part", [])
        self.tags = TagField("high, spinning", "Tags by which the motion library finds the clip")
        self.frames = {mark: NumberField(f"Frame: {mark}", "", 0, 0, 1, 0) for mark in ClipMark}
        self.undo = press_button("Undo", self._undo)
        self.confirm = press_button("Confirm", self._confirm, "main")
        self.title, self.hint = styled_label("", "title"), styled_label(AUTOMATIC_LABEL_HINT, "hint")
        self._lay_out()
        self._connect()

    @property
    def label(self) -> ClipLabel:
        """Label with the current values of the form."""
        return self._steps[-1]

    def open(self, opened: "OpenedClip") -> None:
        """Show a library clip, and discard the undo steps of the previous one."""
        self._opened, self._steps = opened, [opened.clip.label]
        self.title.setText(opened.clip.take.motion.name)
        self.line.open(opened.speeds, opened.frame_rate, opened.clip.label)
        for field in self.frames.values():
            field.setRange(0, opened.speeds.shape[1] - 1)
        self._show()

    def tell_confirmed(self) -> None:
        """Show that the label was stored in the library."""
        self.hint.setText(CONFIRMED_LABEL_HINT)
        self.confirm.setEnabled(False)

    def event(self, event: QEvent) -> bool:
        """Reserve the undo shortcuts for edits of the label while the form has the focus."""
        if event.type() == QEvent.Type.ShortcutOverride and _undoes(event):
            event.accept()
            return True
        return super().event(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Undo or redo edits of the label."""
        if _undoes(event):
            self._undo()
        else:
            super().keyPressEvent(event)

    # User input

    def _connect(self) -> None:
        self.line.begun.connect(lambda: self._steps.append(self.label))
        self.line.dragged.connect(self._replace_last)
        self.line.marked.connect(self.figures.emphasise)
        self.limb.value_chosen.connect(self._choose_limb)
        self.kind.value_chosen.connect(lambda kind: self._put(replace(self.label, kind=kind)))
        self.segment.value_chosen.connect(lambda segment: self._put(replace(self.label, segment=segment)))
        self.tags.tags_edited.connect(lambda tags: self._put(replace(self.label, tags=tags)))
        for mark, field in self.frames.items():
            field.begun.connect(lambda: self._steps.append(self.label))
            field.edited.connect(lambda value, mark=mark: self._set_frame(mark, round(value)))

    def _set_frame(self, mark: ClipMark, frame: int) -> None:
        if self._opened is not None:
            self._replace_last(with_mark(self.label, mark, frame, self._opened.speeds.shape[1]))

    def _choose_limb(self, limb: Limb) -> None:
        segments = HIT_SEGMENTS[limb.is_arm]
        segment = self.label.segment if self.label.segment in segments else segments[0]
        swapped = {Kind.PUNCH: Kind.KICK, Kind.KICK: Kind.PUNCH}
        wrong = Kind.KICK if limb.is_arm else Kind.PUNCH
        kind = swapped[wrong] if self.label.kind is wrong else self.label.kind
        self._put(replace(self.label, limb=limb, segment=segment, kind=kind))

    def _put(self, label: ClipLabel) -> None:
        if label != self.label:
            self._steps.append(label)
            self._show()

    def _replace_last(self, label: ClipLabel) -> None:
        self._steps[-1] = label
        self._show()

    def _undo(self) -> None:
        now = self.label
        while len(self._steps) > 1 and self.label == now:  # a drag that came back is no step
            self._steps.pop()
        self._show()

    def _confirm(self) -> None:
        self.confirmed.emit(replace(self.label, confirmed=True))

    # Display

    def _show(self) -> None:
        label, opened = self.label, self._opened
        if opened is None:
            return
        self.segment.offer([(each, each.capitalize()) for each in HIT_SEGMENTS[label.limb.is_arm]])
        for choice, value in ((self.limb, label.limb), (self.kind, label.kind), (self.segment, label.segment)):
            choice.show_value(value)
        self.tags.show_tags(label.tags)
        for mark, field in self.frames.items():
            field.show_value(getattr(label, mark))
        self.line.show_label(label)
        self.figures.show_label(opened, label)
        self.undo.setEnabled(len(self._steps) > 1)
        self.confirm.setEnabled(True)
        self.hint.setText(CONFIRMED_LABEL_HINT if label.confirmed and len(self._steps) == 1 else AUTOMATIC_LABEL_HINT)

    def _lay_out(self) -> None:
        inside = QWidget()
        self.setWidget(inside)
        column = QVBoxLayout(inside)
        column.setContentsMargins(0, 8, 0, 8)
        column.setSpacing(8)
        head = QHBoxLayout()
        head.setContentsMargins(FIELD_ICON_PX - 4, 0, FIELD_ICON_PX, 0)
        back = press_button("‹ Strikes", self.closed.emit, "link")
        back.setAccessibleName("Back to the strikes that were found")
        head.addWidget(back)
        head.addStretch(1)
        head.addWidget(self.undo)
        head.addWidget(self.confirm)
        column.addLayout(head)
        self.title.setContentsMargins(FIELD_ICON_PX, 0, FIELD_ICON_PX, 0)
        column.addWidget(self.title)
        drawn = QVBoxLayout()
        drawn.setContentsMargins(FIELD_ICON_PX, 0, FIELD_ICON_PX, 0)
        drawn.setSpacing(4)
        drawn.addWidget(self.line)
        drawn.addWidget(self.figures)
        column.addLayout(drawn)
        section = Section("Classification")
        section.add_row("Limb", self.limb)
        section.add_row("Type", self.kind)
        section.add_row("Striking body part", self.segment)
        section.add_row("Tags", self.tags)
        section.add_row("Frame range", *self.frames.values())
        column.addWidget(section)
        self.hint.setContentsMargins(FIELD_ICON_PX, 0, FIELD_ICON_PX, 0)
        column.addWidget(self.hint)
        column.addStretch(1)


def _undoes(event: QEvent) -> bool:
    return isinstance(event, QKeyEvent) and event.matches(QKeySequence.StandardKey.Undo)


class HitFigures(QWidget):
    """Stick figures at the first frame, the hit and the last frame, turned so that the strike goes to the right."""

    def __init__(self) -> None:
        super().__init__()
        self.setAccessibleName("Pose at the beginning, at the hit and at the end")
        self.setFixedHeight(FIGURES_PX + CAPTION_PX)
        self._opened: OpenedClip | None = None
        self._label: ClipLabel | None = None
        self._stressed: ClipMark | None = None

    def sizeHint(self) -> QSize:
        return QSize(200, FIGURES_PX + CAPTION_PX)

    def show_label(self, opened: "OpenedClip", label: ClipLabel) -> None:
        """Show the poses at the marks of ``label``."""
        self._opened, self._label = opened, label
        self.update()

    def emphasise(self, mark: ClipMark | None) -> None:
        """Emphasise the figure of one mark; None emphasises none."""
        self._stressed = mark
        self.update()

    def paintEvent(self, _: QPaintEvent) -> None:
        opened, label = self._opened, self._label
        if opened is None or label is None:
            return
        with QPainter(self) as painter:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            font = painter.font()
            font.setPixelSize(11)
            painter.setFont(font)
            look = self._look(opened, label)
            width = self.width() / 3.0
            for column, mark in enumerate(ClipMark):
                box = QRectF(column * width, 0.0, width, FIGURES_PX)
                strong = mark is (self._stressed or ClipMark.HIT)
                colour = colours.TEXT if strong else colours.TEXT_THIRD
                points = opened.points[getattr(label, mark)]
                paint_sticks(painter, points, opened.pairs, look, box, colour, 2.0)
                painter.setPen(QColor(colour))
                words = f"{(getattr(label, mark) - label.hit) / opened.frame_rate:+.2f} s"
                caption = QRectF(box.left(), FIGURES_PX, width, CAPTION_PX)
                painter.drawText(caption, Qt.AlignmentFlag.AlignCenter, "hit" if mark is ClipMark.HIT else words)

    @staticmethod
    def _look(opened: "OpenedClip", label: ClipLabel) -> FigureView:
        layout = opened.clip.actor.body.layout
        root = layout.collar_point(label.limb.side) + 1 if label.limb.is_arm else layout.hip_point(label.limb.side)
        x, y = (opened.points[label.hit, root + 2, :2] - opened.points[label.hit, root, :2]).tolist()
        cut = opened.points[label.first : label.last + 1, :, 2]
        return FigureView((x, y), max(float(np.max(cut)), 0.5))
