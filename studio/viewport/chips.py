"""Chips: small buttons and labels over the 3D view that show and toggle display options."""

from collections.abc import Callable, Mapping

from PySide6.QtCore import QPoint, QRect, Qt
from PySide6.QtWidgets import QGraphicsOpacityEffect, QGridLayout, QHBoxLayout, QLabel, QPushButton, QWidget

from studio.document import colours
from studio.document.mnemonics import escaped_mnemonics

CHIP_MARGIN = 8
"""Pixels between a chip and the edge of the view."""
EDGE_MARGIN, CHIP_SPACING = 12, 8
"""Pixels between the rows of chips and the edges of the view, and between chips of a row."""
PART_SEPARATOR = " · "
"""Text between the parts of the statistics."""
PROBLEM_MARGIN_PX = 60
"""Pixels of the view's width that the text of the problem chip must leave free."""
_SHAPE = "border-radius: 11px; padding: 3px 10px; font-size: 12px; border: 1px solid transparent;"
_BUTTON = f"""
QPushButton {{ background: rgba(22, 25, 29, 205); color: {colours.STAGE_TEXT_SECOND}; {_SHAPE} }}
QPushButton:checked {{ background: rgba(58, 66, 75, 235); color: {colours.STAGE_TEXT}; }}
QPushButton:hover {{ background: {colours.STAGE_CONTROL}; color: {colours.STAGE_TEXT}; }}
QPushButton:focus {{ border: 1px solid {colours.STAGE_SELECTED_CONTROL}; }}
"""
_WARNING = f"QPushButton {{ color: {colours.STAGE_PARTLY}; }} QPushButton:hover {{ color: {colours.STAGE_PARTLY}; }}"
_CALL_TO_ACTION_STYLE = f"QPushButton {{ background: {colours.STAGE_SELECTED_CONTROL}; color: #ffffff; }}"


class Chip(QPushButton):
    """Small button over the 3D view."""

    def __init__(self, text: str, name: str, clicked: Callable[[], object], parent: QWidget, extra: str = "") -> None:
        super().__init__(escaped_mnemonics(text), parent)
        self.setObjectName(name.replace(" ", "_").lower())
        self.setAccessibleName(name)
        self.setToolTip(name)
        self.setStyleSheet(_BUTTON + extra)
        self.setCursor(Qt.CursorShape.PointingHandCursor)
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.setAutoDefault(False)
        self.clicked.connect(lambda: clicked())

    def stand_at(self, position: QPoint) -> None:
        """Move to a position of the view, or as near to it as the view allows."""
        view = self.parentWidget()
        assert view is not None
        room = view.rect().adjusted(CHIP_MARGIN, CHIP_MARGIN, -CHIP_MARGIN - self.width(), -CHIP_MARGIN - self.height())
        self.move(min(max(position.x(), room.left()), room.right()), min(max(position.y(), room.top()), room.bottom()))

    def set_text(self, text: str) -> None:
        """Set the text; does nothing if it is the same."""
        if escaped_mnemonics(text) != self.text():
            self.setText(escaped_mnemonics(text))
            self.adjustSize()


class ToggleChip(Chip):
    """Chip of an option: a full dot before its text if it is on, an empty dot if off."""

    def __init__(self, text: str, name: str, on: bool, toggled: Callable[[], object], parent: QWidget) -> None:
        super().__init__(text, name, toggled, parent)
        self._word = text
        self.setCheckable(True)
        self.toggled.connect(self._tell)
        self.setChecked(on)
        self._tell(on)

    def _tell(self, on: bool) -> None:
        self.setText(f"{'●' if on else '○'}  {self._word}")


class Chips:
    """Chips of a 3D view: display options at the top left, statistics at the top right, the worst problem at the bottom
    left.
    """

    def __init__(self, parent: QWidget, clicked: Mapping[str, Callable[[], object]]) -> None:
        """``clicked`` has the functions of the chips view, shading, space, correct, ghost, onion, trails, follow,
        markers, problem and constrain.
        """
        self.view = Chip("Perspective", "Perspective or orthographic view", clicked["view"], parent)
        self.shading = Chip("Skin", "Skin or bones", clicked["shading"], parent)
        self.space = Chip("World axes", "Axes of the gizmo: world, local, parent or screen", clicked["space"], parent)
        self.correct = ToggleChip(
            "Pose correction", "Pose joints with the gizmo on a correction layer", False, clicked["correct"], parent
        )
        self.ghost = ToggleChip("Source ghost", "Ghost of the source", False, clicked["ghost"], parent)
        self.onion = ToggleChip("Onion skins", "Onion skins of the selected character", False, clicked["onion"], parent)
        self.trails = ToggleChip(
            "Motion trails", "Motion trail of the constrained point", True, clicked["trails"], parent
        )
        self.follow = ToggleChip("Follow", "Camera follows the selected character", False, clicked["follow"], parent)
        self.markers = ToggleChip("Markers", "Markers as they were recorded", False, clicked["markers"], parent)
        self.work = QLabel(parent)
        self.work.setAccessibleName("Characters, frames per second, and mouse latency")
        self.work.setStyleSheet(f"background: rgba(22, 25, 29, 205); color: {colours.STAGE_TEXT_SECOND}; {_SHAPE}")
        self.problem = Chip("", "Most important problem", clicked["problem"], parent, _WARNING)
        self.constrain = Chip("", "Constrain the picked joint", clicked["constrain"], parent, _CALL_TO_ACTION_STYLE)
        self._top = (
            *(self.view, self.shading, self.space, self.correct),
            *(self.ghost, self.onion, self.trails, self.follow, self.markers),
        )
        self._view = parent
        self._recorded, self._space_used = False, True
        self._work_parts: tuple[str, ...] = ()
        self._work_room = 0
        self._arrange(parent)
        for hidden in (self.problem, self.constrain, self.work, self.markers):
            hidden.hide()

    def _arrange(self, parent: QWidget) -> None:
        grid = QGridLayout(parent)
        grid.setContentsMargins(EDGE_MARGIN, EDGE_MARGIN, EDGE_MARGIN, EDGE_MARGIN)
        top, bottom = QHBoxLayout(), QHBoxLayout()
        top.setSpacing(CHIP_SPACING)
        for chip in self._top:
            top.addWidget(chip)
        top.addStretch(1)
        top.addWidget(self.work)
        bottom.addWidget(self.problem)
        bottom.addStretch(1)
        grid.addLayout(top, 0, 0)
        grid.setRowStretch(1, 1)
        grid.addLayout(bottom, 2, 0)

    def connect_toggles(self, toggled: Callable[[], object]) -> None:
        """Call ``toggled`` whenever an option is switched on or off."""
        for chip in self._top:
            if isinstance(chip, ToggleChip):
                chip.toggled.connect(lambda _: toggled())

    def fit(self, width: int) -> None:
        """Hide the chips that do not fit in ``width`` pixels, the least important first; the statistics take what is
        left, and drop parts that do not fit.
        """
        room = width - 2 * EDGE_MARGIN - sum(_needed(chip) for chip in (self.view, self.shading))
        for chip, used in (
            (self.space, self._space_used),
            (self.correct, True),
            (self.ghost, True),
            (self.markers, self._recorded),  # before what can be switched by keys as well
            (self.trails, True),
            (self.follow, True),
            (self.onion, True),
        ):
            fits = used and room >= _needed(chip)
            chip.setVisible(fits)
            room -= (_needed(chip) if fits else room) if used else 0
        self._work_room = room
        self._show_work()

    def _show_work(self) -> None:
        self.work.ensurePolished()
        padding = self.work.sizeHint().width() - self.work.fontMetrics().horizontalAdvance(self.work.text())
        texts = [PART_SEPARATOR.join(self._work_parts[:count]) for count in range(1, len(self._work_parts) + 1)]
        fitting = [
            text for text in texts if self.work.fontMetrics().horizontalAdvance(text) + padding <= self._work_room
        ]
        self.work.setText(fitting[-1] if fitting else "")
        self.work.setVisible(bool(fitting))

    def make_room(self, gizmo: QRect) -> None:
        """Hide the chips over the gizmo's rectangle, so that the gizmo is visible and can be dragged."""
        for chip in (*self._top, self.work, self.problem):
            covers = gizmo.intersects(chip.geometry())
            if covers == chip.testAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents):
                continue
            chip.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents, covers)
            effect = QGraphicsOpacityEffect(chip) if covers else None
            if effect is not None:
                effect.setOpacity(0.0)
            chip.setGraphicsEffect(effect)  # type: ignore[arg-type]

    def show_parallel(self, parallel: bool) -> None:
        """Show if the projection is orthographic (``parallel``) or perspective."""
        self.view.set_text("Orthographic" if parallel else "Perspective")

    def show_gizmo_space(self, space: str, used: bool) -> None:
        """Show the orientation of the gizmo; hide its chip if the gizmo does not use one."""
        self.space.set_text(f"{space.capitalize()} axes")
        self._space_used = used
        self.fit(self._view.width())

    def show_recorded(self, recorded: bool) -> None:
        """Show the markers chip if there are recorded markers."""
        if recorded != self._recorded:
            self._recorded = recorded
            self.fit(self._view.width())

    def show_work(self, bodies: int, pace: str, eased: bool) -> None:
        """Show the number of visible characters and, during motion, the frame rate and if the image is anti-aliased."""
        count = f"{bodies} character{'' if bodies == 1 else 's'}"
        moving = (*pace.split(PART_SEPARATOR), *(() if eased else ("anti-aliased when idle",))) if pace else ()
        parts = (count, *moving) if bodies else ()
        if parts != self._work_parts:
            self._work_parts = parts
            self._show_work()

    def show_problem(self, sentence: str | None) -> None:
        """Show a sentence about the worst problem, elided if it does not fit; None hides the chip."""
        words = sentence or ""
        room = self._view.width() - PROBLEM_MARGIN_PX
        self.problem.ensurePolished()
        self.problem.set_text(self.problem.fontMetrics().elidedText(words, Qt.TextElideMode.ElideRight, room))
        self.problem.setToolTip(words)
        self.problem.setAccessibleDescription(words)
        self.problem.setVisible(sentence is not None)


def _needed(chip: Chip) -> int:
    """Pixels that a chip and the gap behind it take in their row."""
    chip.ensurePolished()
    return chip.sizeHint().width() + CHIP_SPACING
