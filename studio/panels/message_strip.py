"""Message strip under the 3D view, and its variant for questions. Neither is modal."""

import re
from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum

from PySide6.QtCore import QEvent, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QSizePolicy, QWidget

from studio.panels.fields import press_button, return_keys

Answer = tuple[str, Callable[[], object]]


class Lifetime(IntEnum):
    """Event that removes a message; a message also ends at every event of a smaller value."""

    CLOSED = 0
    """The user closes the message, or another one is shown."""
    PROJECT_OPENED = 1
    """Another project is opened; for messages about the current project."""
    EDITED = 2
    """The project is edited; for advice on the next edit."""
    SELECTED = 3
    """The selection changes; for messages that ask for a selection."""


@dataclass(frozen=True)
class UserMessage:
    """Message to the user: sentence, buttons, and lifetime."""

    sentence: str
    answers: tuple[Answer, ...] = ()
    lifetime: Lifetime = Lifetime.CLOSED
    warns: bool = True


LONG_WORD_PATTERN = re.compile(r"\S{60}(?=\S)")
"""Pattern for breaking long words, such as paths, which would otherwise widen the window."""
PRESS_KEYS = (Qt.Key.Key_Return, Qt.Key.Key_Enter)


class MessageStrip(QWidget):
    """Strip with one message and a button to close it; hidden without a message."""

    def __init__(self, name: str = "message_strip") -> None:
        super().__init__()
        self.setObjectName(name)
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        self._row = QHBoxLayout(self)
        self._row.setContentsMargins(12, 6, 8, 6)
        self._row.setSpacing(8)
        self._label = QLabel()
        self._label.setWordWrap(True)
        self._label.setTextFormat(Qt.TextFormat.PlainText)
        self._label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self._label.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        self._row.addWidget(self._label, 1)
        self._answers: list[QPushButton] = []
        self._lifetime, self._sentence = Lifetime.CLOSED, ""
        self.hide()

    @property
    def text(self) -> str:
        """Shown sentence; empty if the strip is hidden."""
        return "" if self.isHidden() else self._sentence

    def show_sentence(self, sentence: str, *answers: Answer) -> None:
        """Show a sentence with buttons for its ``answers``; each button closes the strip."""
        for button in self._answers:
            self._row.removeWidget(button)
            button.deleteLater()
        self._lifetime = Lifetime.CLOSED
        chosen = answers or (("Close", self.clear),)
        self._answers = [
            self._make_button(*answer, main=index == 0 and bool(answers)) for index, answer in enumerate(chosen)
        ]
        self._sentence = sentence
        self._label.setText(LONG_WORD_PATTERN.sub("\\g<0>\u200b", sentence))
        self.setAccessibleName(sentence)
        self.show()

    def show_message(self, message: UserMessage) -> None:
        """Show a message; an empty one removes the current one."""
        if message.sentence:
            self.show_sentence(message.sentence, *message.answers)
            self._lifetime = message.lifetime
            self.setProperty("role", "warning" if message.warns else "")
            self.style().polish(self)
        else:
            self.clear()

    def clear_at(self, event: Lifetime) -> None:
        """Remove the message if ``event`` ends its lifetime."""
        if self._lifetime >= event:
            self.clear()

    def ask_user(self, sentence: str, *answers: Answer) -> None:
        """Show a question with the focus on the first answer: Tab moves on, Enter presses, Esc presses the last
        answer.
        """
        self.show_sentence(sentence, *answers)
        self._answers[0].setFocus(Qt.FocusReason.PopupFocusReason)

    def event(self, event: QEvent) -> bool:
        """Reserve the keys of answers from shortcuts while an answer has the focus."""
        keys = (*PRESS_KEYS, Qt.Key.Key_Space, Qt.Key.Key_Escape)
        if isinstance(event, QKeyEvent) and event.type() == QEvent.Type.ShortcutOverride and event.key() in keys:
            event.accept()
            return True
        return bool(super().event(event))

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Press the focused answer with Enter, or the last one with Esc."""
        focused = next((button for button in self._answers if button.hasFocus()), None)
        if event.key() in PRESS_KEYS and focused is not None:
            focused.click()
        elif event.key() == Qt.Key.Key_Escape:
            self._answers[-1].click()
        else:
            super().keyPressEvent(event)

    def clear(self) -> None:
        """Remove the message and hide the strip."""
        return_keys(self)
        self.hide()

    def press(self, text: str) -> None:
        """Press a button by its text."""
        next(button for button in self._answers if button.text() == text).click()

    def _make_button(self, text: str, run: Callable[[], object], main: bool) -> QPushButton:
        def answer() -> None:
            self.clear()
            run()

        button = press_button(text, answer, "main" if main else "link")
        self._row.addWidget(button)
        return button


class RecoveryBar(MessageStrip):
    """Message strip that offers to recover a crashed session; declining deletes nothing."""

    refused = Signal()

    def __init__(self) -> None:
        super().__init__("recovery_bar")

    def offer(self, words: str, recover: Callable[[], object]) -> None:
        """Show the offer ``words``; ``recover`` is called if the user accepts."""
        self.show_sentence(words, ("Recover", recover), ("Not now", self.refused.emit))
