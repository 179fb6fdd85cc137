"""Dialog to adapt many files as a batch, with its progress."""

from functools import partial
from pathlib import Path

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

from studio.app.file_dialogs import CONSTRAINTS_FILTER, ask_file, ask_folder
from studio.app.workbench import Workbench
from studio.core.errors import StudioError
from studio.engine.background_tasks import Progress
from studio.io.project.character_file import bundled_characters
from studio.io.registry import known_formats
from studio.jobs.adapted_files import ACTOR_WORD, AdaptSettings
from studio.jobs.batch import BatchResult, BatchSettings, FileDone, run_batch
from studio.panels.fields import FIELD_ICON_PX, Choice, Section, press_button, styled_label

BATCH_DIALOG_WIDTH = 520
ACTOR_CHOICE = (ACTOR_WORD, "Each actor's own proportions")


class BatchDialog(QDialog):
    """Non-modal dialog for adapting a folder. If it is closed during a run, it is only hidden until the run ends."""

    def __init__(self, bench: Workbench) -> None:
        super().__init__(bench.window)
        self._bench, self._task = bench, -1
        self._page: Path | None = None
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
        self.format = Choice("Output format", [(suffix, suffix.upper()) for suffix in suffixes])
        bench = self._bench
        source = partial(ask_folder, bench, "Folder of captures")
        constraints = partial(ask_file, bench, "Constraints", CONSTRAINTS_FILTER)
        out = partial(ask_folder, bench, "Folder for the adapted files")
        for label, field, ask in (
            ("Input folder", self.source, source),
            ("Constraints", self.constraints, constraints),
            ("Output folder", self.out, out),
        ):
            choose = press_button("Choose…", partial(ask, partial(_show_path, field)))
            choose.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)
            choose.setAccessibleName(f"Choose {label.lower()}")
            section.add_row(label, field, choose)
            field.textChanged.connect(self._refresh)
        section.add_row("Output format", self.format)
        return section

    def _make_characters(self) -> Section:
        section = Section("Characters")
        grid, box = QGridLayout(), QWidget()
        grid.setContentsMargins(0, 0, 0, 0)
        names = [(key, character.name) for key, character in bundled_characters().items()]
        self.characters = {key: QCheckBox(text) for key, text in (*names, ACTOR_CHOICE)}
        for index, (key, check) in enumerate(self.characters.items()):
            check.setChecked(key != ACTOR_CHOICE[0])
            check.toggled.connect(self._refresh)
            grid.addWidget(check, index // 2, index % 2)
        box.setLayout(grid)
        section.add_wide(box)
        return section

    def _make_foot(self) -> QVBoxLayout:
        foot, row = QVBoxLayout(), QHBoxLayout()
        foot.setContentsMargins(FIELD_ICON_PX, FIELD_ICON_PX, FIELD_ICON_PX, 0)
        self.bar = QProgressBar()
        self.bar.setTextVisible(False)
        self.bar.setRange(0, 1000)
        self.words: QLabel = styled_label("", "hint")
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
        """Start the batch with the chosen settings."""
        settings = BatchSettings(
            Path(self.source.text()),
            Path(self.out.text()),
            AdaptSettings(
                characters=tuple(key for key, check in self.characters.items() if check.isChecked()),
                constraints=Path(self.constraints.text()) if self.constraints.text() else None,
                suffix=f".{str(self.format.currentText()).lower()}",
            ),
        )
        self._page = None
        self._task = self._bench.runner.run(
            f"Adapting {settings.source.name}", partial(_run_batch, settings), self._done
        )
        self._refresh()

    @property
    def running(self) -> bool:
        """True while a batch is running."""
        return self._task >= 0

    def _refresh(self) -> None:
        chosen = any(check.isChecked() for check in self.characters.values())
        self.start.setEnabled(not self.running and chosen and bool(self.source.text() and self.out.text()))
        self.start.setVisible(not self.running)
        self.stop.setVisible(self.running)
        self.show_page.setVisible(self._page is not None)
        if not self.running:
            self.bar.setValue(0)

    def _show_share(self, task: int, share: float, text: str) -> None:
        if task == self._task:
            self.bar.setValue(round(1000 * share))
            self.words.setText(text)

    def _done(self, result: BatchResult) -> None:
        self._page = result.page
        self._end(result.summary)

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
            self._bench.post_message(words)
            self.deleteLater()

    def closeEvent(self, event: QCloseEvent) -> None:
        """Hide the dialog; a running batch continues, and the status line shows it and can stop it too."""
        if self.running:
            event.ignore()
            self.hide()

    def reject(self) -> None:
        """Close the dialog on Escape as its Close button does, since Qt's own handling would delete it."""
        self.close()

    def _open_page(self) -> None:
        if not QDesktopServices.openUrl(QUrl.fromLocalFile(str(self._page))):
            raise StudioError(f"No web browser was found. The summary is in {self._page}.")


def _show_path(field: QLineEdit, path: Path) -> None:
    field.setText(str(path))


def _run_batch(settings: BatchSettings, progress: Progress) -> BatchResult:
    """Run the batch in a background thread; if it is cancelled, its worker processes are stopped."""
    share, text = 0.0, "Starting worker processes"

    def tell(done: FileDone) -> None:
        nonlocal share, text
        share, text = done.number / done.count, f"{done.number} of {done.count}: {done.name}: {done.outcome}"
        progress(share, text)

    return run_batch(settings, tell, lambda: progress(share, text))
