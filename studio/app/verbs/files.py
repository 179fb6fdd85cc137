"""Actions of the File menu: open, save, import and export. Long work runs in the background."""

import re
from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QBuffer, QIODevice, Qt
from PySide6.QtGui import QImageWriter

from studio.app import capture_import, character_import, sample
from studio.app.file_dialogs import PROJECT_FILTER, ask_file, ask_new_file, characters, motions
from studio.app.verbs import media
from studio.app.workbench import Workbench
from studio.core.captures.remarks import remarks_on
from studio.core.errors import StudioError
from studio.engine.saving import save_in_background
from studio.io.media.footage_file import FILM_SUFFIXES, PICTURE_SUFFIXES
from studio.io.media.sound_file import SOUND_SUFFIXES
from studio.io.project.project_file import ChangedOnDisk, OpenedProject, read_project
from studio.io.registry import Progress, ReadCharacter
from studio.library.scenes import BundledScene

THUMBNAIL_WIDTH_PX = 256
NUMBERED_STEM = re.compile(r"^(.*?)[_ .-]?(\d+)$")


def new(bench: Workbench) -> None:
    """Open a new project with the bundled characters and no capture."""
    bench.window.run_when_saved(lambda: bench.document.new(sample.empty_project()))


def open_sample(bench: Workbench) -> None:
    """Open the sample project."""
    bench.window.run_when_saved(lambda: sample.open_sample(bench))


def scene_opener(scene: BundledScene) -> Callable[[Workbench], None]:
    """Function of the action that opens an example scene."""
    return lambda bench: bench.window.run_when_saved(lambda: sample.open_scene(bench, scene))


def open_project(bench: Workbench) -> None:
    """Ask for a project file and open it."""
    ask_file(bench, "Open project", PROJECT_FILTER, lambda path: open_path(bench, path))


def open_path(bench: Workbench, path: Path) -> None:
    """Open a project in place of the current one, or import a capture, character, footage or sound into it."""
    suffix = path.suffix.lower()
    if suffix == ".studio":
        bench.window.run_when_saved(lambda: _open(bench, path))
    elif suffix in (*FILM_SUFFIXES, *PICTURE_SUFFIXES):
        media.add_footage(bench, path)
    elif suffix in SOUND_SUFFIXES:
        media.add_sound(bench, path)
    else:
        _import(bench, path)


def _import(bench: Workbench, path: Path) -> None:
    """Read a file once, in the background, and import the capture or the character in it."""
    known = bench.settings.corrections

    def read(progress: Progress) -> capture_import.ReadMotion | ReadCharacter:
        return capture_import.read_capture_or_character(path, progress, known, bench.live.prefetch_capture)

    def show(held: capture_import.ReadMotion | ReadCharacter) -> None:
        if isinstance(held, ReadCharacter):
            character_import.show_import(bench, path, held)
        else:
            capture_import.show_import(bench, path, held)

    bench.runner.run(f"Opening {path.name}", read, show)


def save(bench: Workbench) -> None:
    """Save to the project's file; ask for a file if there is none."""
    if bench.document.path is None:
        save_as(bench)
    else:
        save_to(bench, bench.document.path)


def save_as(bench: Workbench) -> None:
    """Ask for a file and save to it."""
    name = bench.document.path.name if bench.document.path else "untitled.studio"
    ask_new_file(bench, "Save project", PROJECT_FILTER, name, lambda path: save_to(bench, path))


def save_increment(bench: Workbench) -> None:
    """Save under the next number: ``walk.studio`` becomes ``walk_002.studio``, then ``walk_003.studio``."""
    if bench.document.path is None:
        save_as(bench)
    else:
        save_to(bench, next_increment(bench.document.path))


def next_increment(path: Path) -> Path:
    """Next numbered path that does not exist."""
    found = NUMBERED_STEM.match(path.stem)
    name, number = (found[1], int(found[2])) if found else (path.stem, 1)
    while True:
        number += 1
        candidate = path.with_name(f"{name}_{number:03d}{path.suffix}")
        if not candidate.exists():
            return candidate


def save_to(bench: Workbench, path: Path, overwrite: bool = False) -> None:
    """Write the project to ``path``; errors are reported with what the user can do."""

    def saved() -> None:
        _remember(bench, path)
        bench.clear_message()

    def refused(error: StudioError) -> None:
        if isinstance(error, ChangedOnDisk):
            again = ("Save anyway", lambda: save_to(bench, path, overwrite=True))
            bench.post_message(str(error), ("Save as…", lambda: save_as(bench)), again, ("Close", lambda: None))

    save_in_background(bench.document, bench.runner, path, stage_thumbnail(bench), overwrite, saved, refused)


def stage_thumbnail(bench: Workbench) -> bytes | None:
    """PNG image of the 3D view as last drawn; None if it was never drawn."""
    if not bench.has_viewport or bench.viewport.drawn_image.isNull():
        return None
    buffer = QBuffer()
    buffer.open(QIODevice.OpenModeFlag.WriteOnly)
    image = bench.viewport.drawn_image.scaledToWidth(THUMBNAIL_WIDTH_PX, Qt.TransformationMode.SmoothTransformation)
    QImageWriter(buffer, b"PNG").write(image)
    return bytes(buffer.data().data())


def import_motion(bench: Workbench) -> None:
    """Ask for a capture and import it."""
    ask_file(bench, "Import capture", motions("capture_reader"), lambda path: capture_import.import_motion(bench, path))


def import_character(bench: Workbench) -> None:
    """Ask for a character and import it."""
    kind = characters("character_reader")
    ask_file(bench, "Import character", kind, lambda path: character_import.import_character(bench, path))


def export(bench: Workbench) -> None:
    """Show the export dialog."""
    from studio.app.export_dialog import open_export_dialog  # late: it loads the solver

    open_export_dialog(bench)


def adapt_folder(bench: Workbench) -> None:
    """Show the non-modal dialog for adapting a folder of captures."""
    from studio.app.batch_dialog import BatchDialog

    BatchDialog(bench).show()


def _remember(bench: Workbench, path: Path) -> None:
    bench.settings.remember(path)
    bench.window.library.show_recent(bench.settings.recent)


def leave(bench: Workbench) -> None:
    """Close the window."""
    bench.window.close()


def _open(bench: Workbench, path: Path) -> None:
    def read(_progress: Progress) -> OpenedProject:
        opened = read_project(path)
        for capture in opened.project.captures.values():
            remarks_on(capture)  # here, beside the window, whose views show them
        return opened

    def show(opened: OpenedProject) -> None:
        bench.document.show_opened(opened)
        _remember(bench, path)

    bench.runner.run(f"Opening {path.name}", read, show)
