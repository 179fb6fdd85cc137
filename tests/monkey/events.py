"""The monkey's events: seeded clicks, drags, keys, menus, fields, drops and answers to dialogs."""

import os
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Any

from tests.monkey.report import Report

NUMBERS = (
    "0",
    "1",
    "-1",
    "7",
    "0.5",
    "1e9",
    "-1e308",
    "9999999",
    "nan",
    "",
    "12,5",
    "90 cm",
    "x" * 300,
    "\u0661",
    "😀",
)


def things_to_drop(folder: Path) -> list[Path]:
    """Good files of every kind, spoilt ones, and what is no file at all."""
    from tests.io.seeds import SEEDS, spoiled

    found = []
    for index, suffix in enumerate(sorted(SEEDS)):
        path = folder / f"good{suffix}"
        SEEDS[suffix](path)
        found.append(path)
        if suffix != ".fbx":
            bad = folder / f"bad{suffix}"
            bad.write_bytes(spoiled(Random(index), path.read_bytes()))
            found.append(bad)
    (folder / "empty.bvh").touch()
    (folder / "zero.bvh").symlink_to("/dev/zero")
    os.mkfifo(folder / "pipe.bvh")
    (folder / "inner").mkdir()
    return [*found, *(folder / name for name in ("empty.bvh", "zero.bvh", "pipe.bvh", "inner", "gone.studio"))]


class Monkey:
    """Does one thing a turn of the event loop, in whatever window is in front."""

    def __init__(self, seed: int, folder: Path, report: Report) -> None:
        from PySide6.QtCore import Qt

        self.random, self.folder, self.report = Random(seed), folder, report
        self.files = things_to_drop(folder)
        self.window: Any = None
        self.left = 0
        self.held: tuple[Any, Any] | None = None
        self.seen: Any = None
        """The window that was in front last: Python's handle of it has those of its children, which go with it."""
        self.keys = [
            *(Qt.Key(Qt.Key.Key_A + k) for k in range(26)), *(Qt.Key(Qt.Key.Key_0 + k) for k in range(10)),
            *(getattr(Qt.Key, f"Key_{name}") for name in (
                "Space", "Left", "Right", "Up", "Down", "Home", "End", "PageUp", "PageDown", "Tab", "Backtab", "Escape",
                "Return", "Enter", "Delete", "Backspace", "F1", "F2", "F5",
                "F10", "Comma", "Period", "Question", "Plus",
                "Minus", "Menu", "Alt", "Control")),
        ]  # fmt: skip
        self.doings: list[tuple[int, Callable[[], object]]] = [
            (30, self.click), (8, self.double_click), (8, self.right_click), (10, self.wheel), (12, self.press_or_move),
            (10, self.release), (14, self.key), (6, self.type), (8, self.set_field), (6, self.action), (2, self.drop),
            (3, self.answer), (2, self.seek), (1, self.resize),
        ]  # fmt: skip

    def step(self) -> None:
        """One event."""
        [doing] = self.random.choices([each for _, each in self.doings], [weight for weight, _ in self.doings])
        self.report.kinds[doing.__name__] += 1
        self.report.events += 1
        doing()

    # Where

    def front(self) -> Any:
        """The popup, dialog or window that has mouse and keys."""
        from PySide6.QtWidgets import QApplication, QFileDialog

        front = QApplication.activePopupWidget() or QApplication.activeModalWidget()
        if front is None:
            tops = [each for each in QApplication.topLevelWidgets() if each.isVisible() and each is not self.window]
            front = self.random.choice(tops) if tops and self.random.random() < 0.3 else self.window
        if isinstance(front, QFileDialog):  # what a file dialog can do to files is not ours to try
            self.answer_files(front)
            return None
        self.report.windows[type(front).__name__] += 1
        self.seen = front
        return front

    def somewhere(self) -> tuple[Any, Any] | None:
        """A widget that is seen, and a point in it."""
        from PySide6.QtCore import QPoint
        from PySide6.QtWidgets import QWidget

        front = self.front()
        if front is None:
            return None
        seen = [each for each in front.findChildren(QWidget) if each.isVisible() and each.window() is front]
        if self.random.random() < 0.3 and front is self.window:
            seen = self.views() or seen
        widget = self.random.choice(seen) if seen else front
        point = QPoint(*(self.random.randrange(max(size, 1)) for size in (widget.width(), widget.height())))
        return widget, point

    def views(self) -> list[Any]:
        """The 3D view and the tracks of the timeline, as far as they are there yet."""
        bench = self.window.bench
        return [
            *([bench.viewport] if bench.has_viewport else []),
            *([bench.timeline.tracks] if bench.has_timeline else []),
        ]

    def modifiers(self) -> Any:
        from PySide6.QtCore import Qt

        kinds = Qt.KeyboardModifier
        held = kinds.NoModifier
        for modifier in (kinds.ShiftModifier, kinds.ControlModifier, kinds.AltModifier):
            if self.random.random() < 0.12:
                held |= modifier
        return held

    def button(self) -> Any:
        from PySide6.QtCore import Qt

        kinds = Qt.MouseButton
        return self.random.choices([kinds.LeftButton, kinds.RightButton, kinds.MiddleButton], [8, 1, 1])[0]

    def mouse(self, kind: str, widget: Any, point: Any, button: Any, held: Any) -> None:
        """One event of the mouse at a point of a widget, if that is still there."""
        from PySide6.QtCore import QEvent
        from PySide6.QtGui import QMouseEvent
        from PySide6.QtWidgets import QApplication
        from shiboken6 import isValid

        if isValid(widget):
            where = widget.mapToGlobal(point.toPointF())
            event = QMouseEvent(getattr(QEvent.Type, kind), point.toPointF(), where, button, held, self.modifiers())
            QApplication.sendEvent(widget, event)

    # What

    def click(self) -> None:
        from PySide6.QtCore import Qt

        if place := self.somewhere():
            button = self.button()
            self.mouse("MouseButtonPress", *place, button, button)
            self.mouse("MouseButtonRelease", *place, button, Qt.MouseButton.NoButton)

    def double_click(self) -> None:
        from PySide6.QtCore import Qt

        if place := self.somewhere():
            button, none = self.button(), Qt.MouseButton.NoButton
            for kind in ("Press", "Release", "DblClick", "Release"):
                self.mouse(f"MouseButton{kind}", *place, button, none if kind == "Release" else button)

    def right_click(self) -> None:
        from PySide6.QtGui import QContextMenuEvent
        from PySide6.QtWidgets import QApplication

        if place := self.somewhere():
            widget, point = place
            event = QContextMenuEvent(QContextMenuEvent.Reason.Mouse, point, widget.mapToGlobal(point))
            QApplication.sendEvent(widget, event)

    def wheel(self) -> None:
        from PySide6.QtCore import QPoint, Qt
        from PySide6.QtGui import QWheelEvent
        from PySide6.QtWidgets import QApplication

        if place := self.somewhere():
            widget, point = place
            turn = QPoint(0, self.random.choice([120, -120, 120, -120, 15, 12_000, -12_000]))
            event = QWheelEvent(
                point.toPointF(), widget.mapToGlobal(point.toPointF()), QPoint(), turn, Qt.MouseButton.NoButton,
                self.modifiers(), Qt.ScrollPhase.NoScrollPhase, False,
            )  # fmt: skip
            QApplication.sendEvent(widget, event)

    def press_or_move(self) -> None:
        """A pressed widget has the mouse until it is let go, wherever that is by then."""
        from PySide6.QtCore import Qt

        if place := self.somewhere():
            if self.held is None:
                self.held = place[0], self.button()
                self.mouse("MouseButtonPress", *place, self.held[1], self.held[1])
            for _ in range(self.random.randint(1, 4)):
                if (place := self.somewhere()) and self.held is not None:
                    self.mouse("MouseMove", self.held[0], place[1], Qt.MouseButton.NoButton, self.held[1])
                elif place:
                    self.mouse("MouseMove", *place, Qt.MouseButton.NoButton, Qt.MouseButton.NoButton)

    def release(self) -> None:
        from PySide6.QtCore import Qt

        if self.held is not None and (place := self.somewhere()):
            self.mouse("MouseButtonRelease", self.held[0], place[1], self.held[1], Qt.MouseButton.NoButton)
            self.held = None
        elif place := self.somewhere():
            self.mouse("MouseMove", *place, Qt.MouseButton.NoButton, Qt.MouseButton.NoButton)

    def key(self) -> None:
        from PySide6.QtTest import QTest

        if front := self.front():
            QTest.keyClick(front.focusWidget() or front, self.random.choice(self.keys), self.modifiers())

    def type(self) -> None:
        from PySide6.QtTest import QTest
        from PySide6.QtWidgets import QApplication

        self.front()
        if widget := QApplication.focusWidget():
            QTest.keyClicks(widget, self.random.choice([each for each in NUMBERS if each.isascii()])[:12])

    def set_field(self) -> None:
        """Type into a field that is seen and press Return, or take another choice."""
        from PySide6.QtCore import Qt
        from PySide6.QtTest import QTest
        from PySide6.QtWidgets import QAbstractSpinBox, QComboBox, QLineEdit, QSlider

        from tests.gui.window_use import choose_by_keys

        front = self.front()
        if front is None:
            return
        kinds = (QAbstractSpinBox, QComboBox, QLineEdit, QSlider)
        fields = [each for kind in kinds for each in front.findChildren(kind) if each.isVisible() and each.isEnabled()]
        if not fields:
            return
        match self.random.choice(fields):
            case QComboBox() as box:
                choose_by_keys(box, self.random.randint(0, 3))
            case QSlider() as slider:
                slider.setValue(self.random.randint(slider.minimum(), slider.maximum()))
            case QAbstractSpinBox() | QLineEdit() as typed:
                line = typed if isinstance(typed, QLineEdit) else typed.findChild(QLineEdit)
                line.setFocus()
                line.selectAll()
                line.insert(self.random.choice(NUMBERS))
                QTest.keyClick(line, self.random.choice([Qt.Key.Key_Return, Qt.Key.Key_Tab, Qt.Key.Key_Escape]))

    def action(self) -> None:
        """Something of the menus, as the palette would start it."""
        if self.front() is self.window:
            action = self.random.choice(list(self.window.actions_by_id.by_id.values()))
            if action.isEnabled():
                action.trigger()

    def drop(self) -> None:
        from PySide6.QtCore import QMimeData, QPointF, Qt, QUrl
        from PySide6.QtGui import QDragEnterEvent, QDropEvent
        from PySide6.QtWidgets import QApplication

        content = QMimeData()
        content.setUrls(
            [QUrl.fromLocalFile(str(path)) for path in self.random.sample(self.files, self.random.choice([1, 1, 3]))]
        )
        left, none = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
        place, copy = QPointF(400, 300), Qt.DropAction.CopyAction
        for event in (QDragEnterEvent(place.toPoint(), copy, content, left, none),
                      QDropEvent(place, copy, content, left, none)):  # fmt: skip
            QApplication.sendEvent(self.window, event)

    def answer(self) -> None:
        """Press one of the buttons of what the window asks."""
        from PySide6.QtWidgets import QPushButton

        for note in (self.window.recovery, self.window.question, self.window.strip):
            buttons = [each for each in note.findChildren(QPushButton) if each.isVisible()]
            if buttons:
                self.random.choice(buttons).click()

    def answer_files(self, dialog: Any) -> None:
        """A file of the monkey's own folder, or none."""
        from PySide6.QtWidgets import QFileDialog

        new = dialog.acceptMode() == QFileDialog.AcceptMode.AcceptSave
        if self.random.random() < 0.4:
            dialog.reject()
        elif dialog.fileMode() == QFileDialog.FileMode.Directory:
            folder = self.folder / "inner"
            dialog.close()
            dialog.fileSelected.emit(str(folder))
        else:
            name = self.folder / f"out{self.random.randrange(4)}" if new else self.random.choice(self.files)
            suffix = dialog.defaultSuffix() if new else ""
            dialog.close()
            dialog.fileSelected.emit(f"{name}.{suffix}" if suffix else str(name))

    def seek(self) -> None:
        """A range as long as the fields take, seen from very near."""
        playhead = self.window.bench.document.playhead
        match self.random.randrange(3):
            case 0:
                playhead.set_frame(self.random.choice([0, 1, 500, 9_999_999]))
            case 1 if self.window.bench.has_timeline:
                self.window.bench.timeline.transport.last.setValue(self.random.choice([1, 300, 9_999_999]))
            case _ if self.window.bench.has_timeline:
                axis = self.window.bench.timeline.tracks.axis
                axis.zoom(self.random.choice([1e-9, 1e9, 3.0]), self.random.randrange(2000))

    def resize(self) -> None:
        self.window.resize(self.random.randint(1, 1200), self.random.randint(1, 800))
