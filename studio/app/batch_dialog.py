"""Many files at once: a dialog over the verb ``batch``, with its progress."""

from functools import partial
from pathlib import Path
from typing import Any

from PySide6.QtCore import Qt, QUrl
from PySide6.QtGui import QCloseEvent, QDesktopServices
from PySide6.QtWidgets import (
    QCheckBox,
    QDialog,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QProgressBar,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from studio.app.batching import run_batch
from studio.app.file_dialogs import CONSTRAINTS_FILTER, ask_file, ask_folder
from studio.app.workbench import Workbench
from studio.core.errors import StudioError
from studio.io.project.character_file import bundled_characters
from studio.io.registry import known_formats
from studio.panels.fields import FIELD_ICON_PX, Choice, Section, labelled, press_button

BATCH_DIALOG_WIDTH = 520
ACTOR_CHOICE = ("actor", "The body each capture was recorded from")


class BatchDialog(QDialog):
    """Not modal: the studio goes on beside it. Closed while a batch runs, it waits for its end out of sight."""

    def __init__(self, bench: Workbench) -> None:
        super().__init__(bench.window)
        self._bench, self._task, self._page = bench, -1, ""
        self.setWindowTitle("Adapt a folder of captures")
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.setMinimumWidth(BATCH_DIALOG_WIDTH)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, FIELD_ICON_PX)
        column.addWidget(self._make_files())
        column.addWidget(self._make_characters())
        column.addStretch(1)
        column.addLayout(self._make_foot())
        runner = bench.runner
        runner.progressed.connect(self._show_share)
        runner.failed.connect(self._failed)
        runner.cancelled.connect(self._cancelled)
        self._refresh()

    def _make_files(self) -> Section:
        section = Section("Files")
        self.source, self.out, self.constraints = QLineEdit(), QLineEdit(), QLineEdit()
        self.constraints.setPlaceholderText("None")
        suffixes = [suffix.lstrip(".") for suffix in known_formats().suffixes("motion_writer")]
        self.format = Choice("Written as", [(suffix, suffix.upper()) for suffix in suffixes])
        bench = self._bench
        source = partial(ask_folder, bench, "Folder of captures")
        constraints = partial(ask_file, bench, "Constraints", CONSTRAINTS_FILTER)
        out = partial(ask_folder, bench, "Folder for the adapted files")
        for label, field, ask in (
            ("Captures in", self.source, source),
            ("Constraints", self.constraints, constraints),
            ("Write into", self.out, out),
        ):
            choose = press_button("Choose…", partial(ask, partial(_show_path, field)))
            choose.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)
            choose.setAccessibleName(f"Choose {label.lower()}")
            section.add_row(label, field, choose)
            field.textChanged.connect(self._refresh)
        section.add_row("Written as", self.format)
        return section

    def _make_characters(self) -> Section:
        section = Section("Characters")
        grid, box = QGridLayout(), QWidget()
        grid.setContentsMargins(0, 0, 0, 0)
        names = [(key, character.name) for key, character in bundled_characters().items()]
        self.characters = {key: QCheckBox(text) for key, text in (*names, ACTOR_CHOICE)}
        for place, (key, check) in enumerate(self.characters.items()):
            check.setChecked(key != ACTOR_CHOICE[0])
            check.toggled.connect(self._refresh)
            grid.addWidget(check, place // 2, place % 2)
        box.setLayout(grid)
        section.add_wide(box)
        return section

    def _make_foot(self) -> QVBoxLayout:
        foot, row = QVBoxLayout(), QHBoxLayout()
        foot.setContentsMargins(FIELD_ICON_PX, FIELD_ICON_PX, FIELD_ICON_PX, 0)
        self.bar = QProgressBar()
        self.bar.setTextVisible(False)
        self.bar.setRange(0, 1000)
        self.words: QLabel = labelled("", "hint")
        self.words.setMinimumHeight(2 * self.words.fontMetrics().height())
        self.start = press_button("Adapt", self.begin, "main")
        self.stop = press_button("Stop", lambda: self._bench.runner.cancel(self._task))
        self.show_page = press_button("Show summary", self._open_page)
        foot.addWidget(self.bar)
        foot.addWidget(self.words)
        row.addStretch(1)
        for button in (self.show_page, self.stop, self.start, press_button("Close", self.close)):
            row.addWidget(button)
        foot.addLayout(row)
        return foot

    def begin(self) -> None:
        """Start the verb with what is chosen."""
        arguments = [self.source.text(), "--out", self.out.text(), "--format", str(self.format.currentText()).lower()]
        arguments += ["--character", *(key for key, check in self.characters.items() if check.isChecked())]
        if self.constraints.text():
            arguments += ["--constraints", self.constraints.text()]
        self._page = ""
        self._task = self._bench.runner.run(
            f"Adapting {Path(self.source.text()).name}", lambda progress: run_batch(arguments, progress), self._done
        )
        self._refresh()

    @property
    def running(self) -> bool:
        """True while its batch runs."""
        return self._task >= 0

    def _refresh(self) -> None:
        chosen = any(check.isChecked() for check in self.characters.values())
        self.start.setEnabled(not self.running and chosen and bool(self.source.text() and self.out.text()))
        self.start.setVisible(not self.running)
        self.stop.setVisible(self.running)
        self.show_page.setVisible(bool(self._page))
        if not self.running:
            self.bar.setValue(0)

    def _show_share(self, task: int, share: float, text: str) -> None:
        if task == self._task:
            self.bar.setValue(round(1000 * share))
            self.words.setText(text)

    def _done(self, answer: dict[str, Any]) -> None:
        adapted = answer["files"] - answer["unchanged"] - answer["failed"]
        unchanged, failed = answer["unchanged"], answer["failed"]
        self._page = answer["page"]
        self._end(f"{answer['files']} files: {adapted} adapted, {unchanged} unchanged, {failed} failed.")

    def _failed(self, task: int, sentence: str) -> None:
        if task == self._task:
            self._end(sentence)

    def _cancelled(self, task: int) -> None:
        if task == self._task:
            self._end("Stopped. Finished files are kept; Adapt continues from there.")

    def _end(self, words: str) -> None:
        self._task = -1
        self.words.setText(words)
        self._refresh()
        if self.isHidden():
            self._bench.said.emit(words)
            self.deleteLater()

    def closeEvent(self, event: QCloseEvent) -> None:
        """A batch goes on; the status line shows it, and can stop it too."""
        if self.running:
            event.ignore()
            self.hide()

    def reject(self) -> None:
        """Escape is the close button: Qt would delete the dialog unasked."""
        self.close()

    def _open_page(self) -> None:
        if not QDesktopServices.openUrl(QUrl.fromLocalFile(self._page)):
            raise StudioError(f"No program opens web pages here. The summary is {self._page}.")


def _show_path(field: QLineEdit, path: Path) -> None:
    field.setText(str(path))
