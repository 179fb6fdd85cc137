"""Document: the open project with its undo stack, its file and its journal. All mutable state of a project is here."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from PySide6.QtCore import QObject, QTimer

from studio.core.errors import StudioError
from studio.core.stage.project import Project
from studio.document.commands.replace import Edit, ReplaceValue
from studio.document.edited_project import EditedProject
from studio.document.file_lock import FileLock
from studio.document.journal import Journal, JournalEntry, StateHash
from studio.document.recovery import Session, mark_recovered, recovered_session
from studio.io.project.archive import Stamp
from studio.io.project.project_file import (
    ChangedOnDisk,
    OpenedProject,
    document_id_of,
    new_document_id,
    read_project,
    write_project,
)

LOCKS_FOLDER = "locks"
"""Name of the folder of file locks, within the folder of the journals."""
PLAYHEAD_SAVE_MILLISECONDS = 500
"""Minimum time between two writes of the playhead's position to the journal."""


@dataclass(frozen=True, eq=False)
class SaveSnapshot:
    """Immutable snapshot of the project for saving, so that a worker can write it while the user goes on editing."""

    project: Project
    path: Path
    document_id: str
    revision: int
    expected: Stamp | None
    thumbnail: bytes | None = None
    locks: Path | None = None
    """Folder of locks that tell if another window has the file open; None to skip the check."""

    def write(self, report: Callable[[float, str], None] = lambda _share, _text: None) -> Stamp:
        """Write the project file; ``report`` receives the progress. Raises StudioError if it cannot be written, and
        ChangedOnDisk if it was changed since, or another window has it open.
        """
        if self.locks is not None:
            self._refuse_open_elsewhere(self.locks)
        return write_project(
            self.path,
            self.project,
            self.document_id,
            thumbnail=self.thumbnail,
            expected=self.expected,
            report=report,
        )

    def _refuse_open_elsewhere(self, locks: Path) -> None:
        document_id = document_id_of(self.path)
        lock = FileLock.acquired(lock_of_document(locks, document_id)) if document_id else None
        if lock is not None:
            lock.release()
        elif document_id:
            raise ChangedOnDisk(
                f"'{self.path.name}' is open in another window of Morpho Studio. Save under another name, or save again"
                " to replace it."
            )


def lock_of_document(locks: Path, document_id: str) -> Path:
    """Path of the lock that a window holds while it has the document open."""
    return locks / f"{document_id}.lock"


class Document(EditedProject):
    """Open document.

    Views read from it and keep no copy; every change goes through ``replace``, ``add``, ``remove``, ``group``.
    """

    def __init__(
        self, project: Project | None = None, parent: QObject | None = None, journal_folder: Path | None = None
    ) -> None:
        """Without ``journal_folder`` the document has no recovery journal and no lock."""
        super().__init__(project, parent)
        self._path: Path | None = None
        self._document_id = new_document_id()
        self._stamp: Stamp | None = None
        self._read_only = ""
        self._unsaved_base = False
        self._folder = journal_folder
        self.journal: Journal | None = None
        self._lock: FileLock | None = None
        self.opened: OpenedProject | None = None
        self._rest = QTimer(self, singleShot=True, interval=PLAYHEAD_SAVE_MILLISECONDS)
        self._rest.timeout.connect(self._keep_playhead)
        for moved in (self.playhead.changed, self.playhead.range_changed, self.playhead.playing_changed):
            moved.connect(self._wait_for_rest)
        self._begin_session()

    @property
    def path(self) -> Path | None:
        """File from which this project was opened, or to which it was saved."""
        return self._path

    @property
    def dirty(self) -> bool:
        """True if there are unsaved changes."""
        return self._unsaved_base or not self.undo_stack.isClean()

    @property
    def read_only(self) -> str:
        """Reason why the project may not be saved to its own file; empty if it may be."""
        return self._read_only

    @property
    def journal_state(self) -> str:
        """Text for the status bar about the edits backed up for recovery; empty without a journal."""
        return self.journal.state if self.journal else ""

    def new(self, project: Project) -> None:
        """Replace the project by a new one that has no file yet."""
        self._become(project, None, new_document_id(), None, "")

    def open(self, path: Path) -> OpenedProject:
        """Read a project file and show it. Raises StudioError, and changes nothing, if it cannot be read."""
        opened = read_project(path)
        self.show_opened(opened)
        return opened

    def show_opened(self, opened: OpenedProject) -> None:
        """Show the result of ``read_project``; its problems and remarks are reported one by one."""
        reason = ""
        if opened.read_only or opened.problems:
            reason = f"Parts of '{opened.path.name}' could not be read. It was opened read-only: use File > Save as…"
        self._become(opened.project, opened.path, opened.document_id, opened.stamp, reason)
        self.opened = opened
        for problem in (*opened.problems, *opened.remarks):
            self.problem_reported.emit(problem)

    def make_save(
        self, path: Path | None = None, thumbnail: bytes | None = None, overwrite: bool = False
    ) -> SaveSnapshot:
        """Snapshot to be written by a worker; ``note_saved`` must be called afterwards.

        ``overwrite`` replaces a file that another program has changed. Raises StudioError if the project has no file
        yet or is read-only.
        """
        target = path or self._path
        if target is None:
            raise StudioError("This project has not been saved yet. Use File > Save as…")
        own = self._path is not None and target.resolve() == self._path.resolve()
        if own and self._read_only:
            raise StudioError(self._read_only)
        document_id = self._document_id if own or self._path is None else new_document_id()
        expected = self._stamp if own and not overwrite else None
        locks = None if own or overwrite or self._folder is None else self._folder / LOCKS_FOLDER
        return SaveSnapshot(self.project, target, document_id, self.revision, expected, thumbnail, locks)

    def note_saved(self, saving: SaveSnapshot, stamp: Stamp) -> None:
        """Record that the snapshot ``saving`` was written: its file is the project's file from now on."""
        self._path, self._stamp, self._read_only = saving.path, stamp, ""
        self._unsaved_base = False
        whole = saving.revision == self.revision
        if self.journal is not None:
            self.journal.mark_saved(saving.project, saving.path, stamp, whole)
        if saving.document_id != self._document_id:
            self._document_id = saving.document_id
            self._take_lock()
        if whole:
            self.undo_stack.setClean()
        else:
            self.undo_stack.resetClean()
        self.saved_state_changed.emit()

    def save(self, path: Path | None = None, thumbnail: bytes | None = None, overwrite: bool = False) -> None:
        """Save and wait until it is done; ``engine.saving`` does so in the background. Raises StudioError if the file
        cannot be written.
        """
        saving = self.make_save(path, thumbnail, overwrite)
        self.note_saved(saving, saving.write())

    def recover(self, session: Session) -> None:
        """Show the last state of a crashed session, with its undo history if that can be rebuilt."""
        recovered = recovered_session(session)
        self._become(recovered.base, session.path, session.document_id, session.stamp, "", unsaved=True)
        self._replay(recovered.steps)
        hashes = StateHash()
        if hashes.of(self.project) != hashes.of(recovered.project):
            self._become(recovered.project, session.path, session.document_id, session.stamp, "", unsaved=True)
        if recovered.playhead is not None:
            self.playhead.restore(recovered.playhead)
            self._keep_playhead()
        for problem in recovered.problems:
            self.problem_reported.emit(problem)
        if self.journal is not None and self.journal.flush():
            mark_recovered(session)

    def close(self) -> None:
        """Stop playback, end the journal and release the lock. Unsaved edits stay in their journal."""
        self._end_session()
        self.undo_stack.blockSignals(True)
        self.undo_stack.clear()
        self._folder = None  # what a late answer still opens is neither kept for recovery nor locked

    def _end_session(self) -> None:
        self.playhead.pause()
        self._rest.stop()
        if self.journal is not None:
            self.journal.close()
            self.journal.deleteLater()
            self.journal = None
        if self._lock is not None:
            self._lock.release()
            self._lock = None

    def _become(
        self,
        project: Project,
        path: Path | None,
        document_id: str,
        stamp: Stamp | None,
        read_only: str,
        unsaved: bool = False,
    ) -> None:
        self._end_session()
        self._path, self._document_id, self._stamp = path, document_id, stamp
        self._read_only, self._unsaved_base, self.opened = read_only, unsaved, None
        self._show_other(project)
        self._begin_session()
        self.saved_state_changed.emit()

    def _begin_session(self) -> None:
        if self._folder is None:
            return
        self._take_lock()
        self.journal = Journal(
            self._folder, self._document_id, self.project, self._path, self._unsaved_base, self, self._stamp
        )
        self.journal.acknowledged_changed.connect(self._tell_saved_state)
        self.journal.failed.connect(self.problem_reported)

    def _take_lock(self) -> None:
        """Lock the document; if another window holds the lock, the document becomes read-only."""
        if self._folder is None:
            return
        if self._lock is not None:
            self._lock.release()
        try:
            self._lock = FileLock.acquired(lock_of_document(self._folder / LOCKS_FOLDER, self._document_id))
        except OSError as error:
            self._lock = None
            self.problem_reported.emit(
                f"'{self._folder}' cannot be written ({error}). Save often: edits are not backed up."
            )
            return
        if self._lock is None:
            name = self._path.name if self._path else "This project"
            self._read_only = (
                f"'{name}' is open in another window of Morpho Studio. Use File > Save as… to keep changes."
            )
            self.problem_reported.emit(self._read_only)

    def _recorded(self, edits: tuple[Edit, ...], verb: str, text: str, gesture: int | None) -> None:
        if self.journal is not None:
            self.journal.record(JournalEntry(verb, edits, text, gesture, self.project))
            self._keep_playhead()
            self.saved_state_changed.emit()

    def _wait_for_rest(self) -> None:
        if self.journal is not None and self.journal.unsaved and not self._rest.isActive():
            self._rest.start()

    def _keep_playhead(self) -> None:
        if self.journal is not None and not self.playhead.playing:
            self.journal.record_playhead(self.playhead.state)

    def _replay(self, steps: tuple[JournalEntry, ...]) -> None:
        for step in steps:
            match step.verb:
                case "undo":
                    self.undo_stack.undo()
                case "redo":
                    self.undo_stack.redo()
                case _:
                    self.undo_stack.push(ReplaceValue(self._step, step.edits, step.text, step.gesture))
            self._gesture = max(self._gesture, step.gesture or 0)
