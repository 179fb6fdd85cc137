"""Non-modal file dialogs of the system; a function is called with the chosen path."""

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QFileDialog

from studio.app.workbench import Workbench
from studio.io.media.footage_file import FILM_SUFFIXES, PICTURE_SUFFIXES
from studio.io.media.sound_file import SOUND_SUFFIXES
from studio.io.registry import known_formats

PROJECT_FILTER = "Morpho Studio projects (*.studio)"
CONSTRAINTS_FILTER = "Constraints (*.json)"
MEDIA_FILTERS = {
    "sounds": f"Sounds and videos ({' '.join(f'*{suffix}' for suffix in SOUND_SUFFIXES)})",
    "footage": f"Videos and images ({' '.join(f'*{suffix}' for suffix in (*FILM_SUFFIXES, *PICTURE_SUFFIXES))})",
}
"""File filters for sounds and footage, by collection of the project."""
ALL_FILES_FILTER = "All files (*)"


def motions(job: str) -> str:
    """Filter of a file dialog for all motion formats that can be read (``capture_reader``) or written
    (``motion_writer``).
    """
    return f"Motions ({_patterns(job)})"


def characters(job: str) -> str:
    """Filter of a file dialog for all character formats that can be read (``character_reader``)."""
    return f"Characters ({_patterns(job)})"


def _patterns(job: str) -> str:
    return " ".join(f"*{suffix}" for suffix in known_formats().suffixes(job))


def ask_file(bench: Workbench, title: str, kind: str, then: Callable[[Path], object]) -> QFileDialog:
    """Ask for an existing file, and call ``then`` with it."""
    dialog = _make(bench, title, kind)
    dialog.setFileMode(QFileDialog.FileMode.ExistingFile)
    return _open(bench, dialog, then)


def ask_new_file(
    bench: Workbench, title: str, kind: str, name: str, then: Callable[[Path], object], suffix: str = "studio"
) -> QFileDialog:
    """Ask for a file to be written, and call ``then`` with it. ``suffix`` is added if none is typed; the system asks
    before overwriting.
    """
    dialog = _make(bench, title, kind)
    dialog.setAcceptMode(QFileDialog.AcceptMode.AcceptSave)
    dialog.setDefaultSuffix(suffix)
    dialog.selectFile(name)
    return _open(bench, dialog, then)


def ask_folder(bench: Workbench, title: str, then: Callable[[Path], object]) -> QFileDialog:
    """Ask for a folder to write to, and call ``then`` with it."""
    dialog = _make(bench, title, ALL_FILES_FILTER)
    dialog.setFileMode(QFileDialog.FileMode.Directory)
    dialog.setOption(QFileDialog.Option.ShowDirsOnly)
    return _open(bench, dialog, then)


def _make(bench: Workbench, title: str, kind: str) -> QFileDialog:
    dialog = QFileDialog(bench.window, title, bench.settings.folder)
    dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
    if kind != ALL_FILES_FILTER:
        dialog.setNameFilters([kind, ALL_FILES_FILTER])
    return dialog


def _open(bench: Workbench, dialog: QFileDialog, then: Callable[[Path], object]) -> QFileDialog:
    def chosen(name: str) -> None:
        path = Path(name)
        bench.settings.folder = path if path.is_dir() else path.parent
        then(path)

    dialog.fileSelected.connect(chosen)
    dialog.open()
    return dialog
