"""Relinking of moved source files: found by content or name in known folders, else chosen by the user."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from studio.app.file_dialogs import MEDIA_FILTERS, ask_file, motions
from studio.app.workbench import Workbench
from studio.core.errors import StudioError
from studio.io.registry import Progress
from studio.io.source_files import SourceFile, SourceMissing, digest_of, find_source
from studio.panels.message_strip import Lifetime


def source_finder(bench: Workbench, capture_id: str) -> Callable[[Progress], SourceFile]:
    """Function for a background task that finds the source file of a capture; it raises SourceMissing if there is
    none.
    """
    capture, known = bench.document.project.captures[capture_id], bench.sources.get(capture_id)
    folders = known_folders(bench)
    return lambda progress: find_source(capture, known, folders, progress)


def known_folders(bench: Workbench) -> tuple[Path, ...]:
    """Folders in which moved sources are searched: those of the project, of other sources and of recent file
    dialogs.
    """
    project, settings = bench.document.path, bench.settings
    files = (*([project] if project else ()), *bench.sources.values(), *settings.recent)
    folders = (*(file.parent for file in files), *settings.source_folders, Path(settings.folder))
    return tuple(dict.fromkeys(folders))


def relink_shown(bench: Workbench) -> None:
    """Relink the source file of the selected capture, else of the capture that is playing."""
    capture_id = shown_capture(bench)
    if capture_id is None:
        raise StudioError("No capture is selected. Select one in the outliner.")
    relink(bench, capture_id)


def shown_capture(bench: Workbench) -> str | None:
    """Id of the selected capture, else of the capture that is playing."""
    selected = bench.document.selection.of("captures")
    motion = bench.document.project.motions.get(bench.document.active_motion_id or "")
    return str(selected[0]) if selected else motion.capture_id if motion else None


def relink(bench: Workbench, capture_id: str) -> int:
    """Search for the source file of a capture, and ask the user if it is not found. Returns the id of the task."""
    capture = bench.document.project.captures[capture_id]

    def missed(error: StudioError) -> None:
        if isinstance(error, SourceMissing):
            ask_source(bench, capture_id)

    def found(source: SourceFile) -> None:
        if link_source(bench, capture_id, source):
            _report(bench, capture_id, source)

    task: int = bench.runner.run(f"Looking for {capture.source}", source_finder(bench, capture_id), found, missed)
    return task


def offer_relinking(bench: Workbench, capture_id: str, error: StudioError, then: Callable[[], object]) -> None:
    """Report that a source is missing, with a button that asks for it and then calls ``then``."""
    ask = ("Relink…", lambda: ask_source(bench, capture_id, then))
    bench.post_message(str(error), ask, ("Close", bench.clear_message))


def ask_source(bench: Workbench, capture_id: str, then: Callable[[], object] = lambda: None) -> None:
    """Ask for the file of a capture, link it, then call ``then``."""
    capture = bench.document.project.captures.get(capture_id)
    if capture is None:
        return

    def chosen(path: Path) -> None:
        def linked(source: SourceFile) -> None:
            is_other = capture.digest not in ("", source.digest)
            if link_source(bench, capture_id, source):
                _report(bench, capture_id, source, is_other)
                then()

        bench.runner.run(f"Relinking {capture.name}", lambda _: SourceFile(path, digest_of(path)), linked)

    ask_file(bench, f"Locate the source file of {capture.name}", motions("capture_reader"), chosen)


def link_source(bench: Workbench, capture_id: str, source: SourceFile) -> bool:
    """Set the source file of a capture; another name or content is an undo step. Returns False if the capture no longer
    exists.
    """
    capture = bench.document.project.captures.get(capture_id)
    if capture is None:
        return False
    bench.sources[capture_id] = source.path
    bench.settings.remember_source(source.path)
    if capture.digest != source.digest:
        linked = replace(capture, source=source.path.name, digest=source.digest)
        bench.document.replace("captures", capture_id, linked, f"Relink {capture.name}")
    return True


def offer_media_relinking(bench: Workbench, collection: str, source: str, error: StudioError) -> None:
    """Report that the file ``source`` of sounds or footage is missing, with a button to locate it."""
    ask = ("Relink…", lambda: ask_media(bench, collection, source))
    bench.post_message(str(error), ask, ("Close", bench.clear_message))


def ask_media(bench: Workbench, collection: str, source: str) -> None:
    """Ask for the new path of the file ``source`` of sounds or footage; all entities read from it change in one undo
    step.
    """

    def chosen(path: Path) -> None:
        entities = getattr(bench.document.project, collection)
        linked = {key: replace(each, source=str(path)) for key, each in entities.items() if each.source == source}
        with bench.document.group(f"Relink {Path(source).name}"):
            for key, each in linked.items():
                bench.document.replace(collection, key, each, f"Relink {each.name}")
        bench.media_relinked.emit(str(path))

    ask_file(bench, f"Locate {Path(source).name}", MEDIA_FILTERS[collection], chosen)


def _report(bench: Workbench, capture_id: str, source: SourceFile, is_other: bool = False) -> None:
    """Report the new source file of a capture, and a warning if its content differs (``is_other``) from the imported
    file.
    """
    name = bench.document.project.captures[capture_id].name
    warning = " Its content differs from that of the imported file." if is_other else ""
    sentence = f"The source file of {name} is {source.path}.{warning} Change an import setting to re-import it."
    other = ("Choose another…", lambda: ask_source(bench, capture_id))
    bench.post_message(sentence, ("Close", bench.clear_message), other, until=Lifetime.EDITED)
