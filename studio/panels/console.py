"""Python console: ``scene`` is the open project, and its changes are undo steps."""

import rlcompleter

from PySide6.QtCore import Qt
from PySide6.QtGui import QFontDatabase, QKeyEvent, QTextCursor
from PySide6.QtWidgets import QHBoxLayout, QPlainTextEdit, QPushButton, QVBoxLayout, QWidget

from studio.document.document import Document
from studio.panels.console_session import ConsoleSession
from studio.panels.fields import FIELD_ICON_PX

WELCOME_TEXT = "scene: the open project; api: studio.api (docs/scripts.md). Edits can be undone.\n"
MAX_OUTPUT_LINES = 5000
ENTRY_LINES = 4
_INDENT = "    "


class ConsoleEntry(QPlainTextEdit):
    """Entry field: Enter runs complete statements, Up and Down recall earlier ones, Tab completes names."""

    def __init__(self, console: "Console") -> None:
        super().__init__()
        self._console = console
        self.setPlaceholderText(">>> scene.project.performers")
        self.setAccessibleName("Python statement")
        self.setTabChangesFocus(False)
        self._before: list[str] = []
        self._place = 0

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Run a statement, recall an earlier one, or complete a name."""
        match event.key():
            case Qt.Key.Key_Return | Qt.Key.Key_Enter if not event.modifiers() & Qt.KeyboardModifier.ShiftModifier:
                self._enter()
            case Qt.Key.Key_Up if self.textCursor().blockNumber() == 0:
                self._recall(self._place - 1)
            case Qt.Key.Key_Down if self.textCursor().blockNumber() == self.blockCount() - 1:
                self._recall(self._place + 1)
            case Qt.Key.Key_Tab:
                self._complete()
            case Qt.Key.Key_Escape:
                self.clear()
            case _:
                super().keyPressEvent(event)

    def _enter(self) -> None:
        source = self.toPlainText()
        lines = source.split("\n")
        in_block = len(lines) > 1 and lines[-1].strip()
        if in_block or not self._console.session.is_whole(source):
            last = lines[-1]
            indent = last[: len(last) - len(last.lstrip())]
            self.insertPlainText("\n" + indent + (_INDENT if last.rstrip().endswith(":") else ""))
        elif source.strip() and self._console.run(source.rstrip()):
            self._before.append(source.rstrip())
            self._place = len(self._before)
            self.clear()

    def _recall(self, index: int) -> None:
        if 0 <= index <= len(self._before) and index != self._place:
            self._place = index
            self.setPlainText(self._before[index] if index < len(self._before) else "")
            self.moveCursor(QTextCursor.MoveOperation.End)

    def _complete(self) -> None:
        cursor = self.textCursor()
        before = cursor.block().text()[: cursor.positionInBlock()]
        if not before.strip():
            self.insertPlainText(_INDENT)
            return
        word = before[max((before.rfind(sign) for sign in " \t([{=,:+-*/<>!\"'"), default=-1) + 1 :]
        found = self._console.completions(word)
        common = _shared_beginning(found)
        if len(common) > len(word):
            self.insertPlainText(common[len(word) :])
        elif len(found) > 1:
            self._console.show_text("  ".join(found) + "\n")


class Console(QWidget):
    """Python console: output above, entry field below."""

    def __init__(self, document: Document) -> None:
        super().__init__()
        self.setObjectName("panel")
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        self.session = ConsoleSession(document)
        font = QFontDatabase.systemFont(QFontDatabase.SystemFont.FixedFont)
        self.shown = QPlainTextEdit(readOnly=True)
        self.shown.setAccessibleName("Python console")
        self.shown.setMaximumBlockCount(MAX_OUTPUT_LINES)
        self.entry = ConsoleEntry(self)
        self.stop_button = QPushButton("Stop")
        self.stop_button.setToolTip("Interrupt the statement that is running")
        self.stop_button.setEnabled(False)
        self.stop_button.clicked.connect(self.session.stop)
        for text in (self.shown, self.entry):
            text.setFont(font)
        self.entry.setFixedHeight(ENTRY_LINES * self.entry.fontMetrics().lineSpacing() + 8)
        row = QHBoxLayout()
        row.addWidget(self.entry, 1)
        row.addWidget(self.stop_button, 0, Qt.AlignmentFlag.AlignBottom)
        column = QVBoxLayout(self)
        column.setContentsMargins(FIELD_ICON_PX, 8, FIELD_ICON_PX, 8)
        column.addWidget(self.shown, 1)
        column.addLayout(row)
        self.setFocusProxy(self.entry)
        self.session.written.connect(self.show_text)
        self.session.ended.connect(self._ended)
        self.show_text(WELCOME_TEXT)

    def run(self, source: str) -> bool:
        """Run statements; returns False if others are still running."""
        if self.session.running:
            return False
        self.show_text(
            "".join(f"{'...' if index else '>>>'} {line}\n" for index, line in enumerate(source.split("\n")))
        )
        self.stop_button.setEnabled(True)
        self.session.run(source)
        return True

    def show_text(self, text: str) -> None:
        """Append text to the output."""
        self.shown.moveCursor(QTextCursor.MoveOperation.End)
        self.shown.insertPlainText(text)
        self.shown.moveCursor(QTextCursor.MoveOperation.End)

    def completions(self, word: str) -> list[str]:
        """Names of the session that complete ``word``, which may contain dots."""
        completer = rlcompleter.Completer(self.session.namespace)
        found: list[str] = []
        while (name := completer.complete(word, len(found))) is not None and name not in found:
            found.append(name)
        return found

    def close_session(self) -> None:
        """Stop the running statement and release the project."""
        self.session.close()

    def _ended(self) -> None:
        self.stop_button.setEnabled(False)


def _shared_beginning(names: list[str]) -> str:
    first, last = (min(names), max(names)) if names else ("", "")
    count = next((index for index, (a, b) in enumerate(zip(first, last, strict=False)) if a != b), len(first))
    return first[:count]
