"""Acknowledged edits are never lost, however the process ends; saved ones need no recovery."""

import os
import sqlite3
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import replace
from datetime import datetime, timedelta
from pathlib import Path
from random import Random
from typing import Any

import pytest

from studio.core.errors import StudioError
from studio.core.stage.clip import Clip
from studio.core.stage.project import Motion, Project
from studio.core.stage.prop import Prop
from studio.document.document import Document
from studio.document.recovery import recoverable_sessions, recovered_session, remove_useless_sessions
from studio.io.project.entity_json import project_json
from studio.io.project.project_file import ChangedOnDisk, read_project, write_project
from tests.builders import make_capture, make_project
from tests.document.test_undo import edit_at_random
from tests.patience import SECONDS

ROOT = Path(__file__).parents[2]
KILLS = int(os.environ.get("MORPHO_KILLS", "10"))


def state(project: Project) -> bytes:
    return project_json(project, {})


@pytest.fixture
def make_document(qapp: Any, tmp_path: Path) -> Iterator[Callable[..., Document]]:
    documents: list[Document] = []

    def make(project: Project | None = None, folder: Path | None = None) -> Document:
        documents.append(Document(project or make_project(), journal_folder=folder or tmp_path / "state"))
        return documents[-1]

    yield make
    for document in documents:
        document.close()
    assert not [thread for thread in threading.enumerate() if thread.name == "journal"]


def died(document: Document) -> None:
    """As after a kill: what is on the disk is all there is, and the locks are free."""
    journal = document.journal
    assert journal is not None
    assert journal.flush()
    journal._queue.put(None)
    journal._thread.join()
    journal._lock.release()
    document._lock.release()
    document.journal = document._lock = None


def edit(document: Document, steps: int = 5) -> None:
    gesture = document.new_gesture()
    for step in range(steps):
        document.add("props", Prop(f"Box {step}"), "Add box")
        moved = replace(document.project.constraints["constraint 0"], target=(step / 10, 0.0, 1.0))
        document.replace("constraints", "constraint 0", moved, "Move target", gesture)
    document.undo_stack.undo()


@pytest.mark.parametrize("what", ["edit", "save", "export", "record"])
def test_kill_9_costs_no_acknowledged_edit_and_no_file_that_was_whole(tmp_path: Path, what: str) -> None:
    command = [sys.executable, "-m", "tests.document.killed", what, str(tmp_path), str(KILLS), "11"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=SECONDS, check=False)
    assert (done.stdout.strip(), done.returncode) == ("0", 0), done.stderr


def test_a_session_is_recovered_with_its_undo_history(make_document: Any, tmp_path: Path) -> None:
    document = make_document()
    first = state(document.project)
    edit(document, 60)
    last, history, index = state(document.project), document.history, document.undo_stack.index()
    died(document)
    (session,) = recoverable_sessions(tmp_path / "state")
    other = make_document()
    other.recover(session)
    assert state(other.project) == last
    assert (other.history, other.undo_stack.index()) == (history, index)
    assert other.dirty
    other.undo_stack.setIndex(0)
    assert state(other.project) == first


def import_walk(document: Document, rate: float = 30.0, frames: int = 120) -> None:
    """As the window does: a capture of another rate and length takes the place of what is played, as one step."""
    with document.group("Import walk.bvh"):
        capture = document.add("captures", make_capture("walk", frames=frames, frame_rate=rate), "Import")
        motion = document.add("motions", Motion("walk", capture), "Import")
        for key, performer in document.project.performers.items():
            document.replace("performers", key, replace(performer, clips=(Clip(motion, 0, frames - 1),)), "Import")


def test_a_recovered_project_has_its_own_rate_range_and_playhead(make_document: Any, tmp_path: Path) -> None:
    document = make_document()
    import_walk(document)
    document.playhead.set_range(10, 80)
    document.playhead.set_frame(40)
    edit(document)
    stood = document.playhead.state
    assert (stood.frame_rate, stood.first, stood.last) == (30.0, 10, 80)
    for _ in range(2):  # what was recovered may die again
        died(document)
        (session,) = recoverable_sessions(tmp_path / "state")
        document = make_document()
        document.recover(session)
        assert document.playhead.state == stood


def test_a_session_that_says_nothing_of_the_playhead_has_the_ruler_of_its_own_motion(
    make_document: Any, tmp_path: Path
) -> None:
    document = make_document()
    import_walk(document)
    died(document)
    (session,) = recoverable_sessions(tmp_path / "state")
    with closing(sqlite3.connect(session.file)) as connection, connection:
        connection.execute("DELETE FROM session WHERE key = 'playhead'")
    other = make_document()
    other.recover(session)
    assert (other.playhead.frame_rate, other.playhead.first, other.playhead.last) == (30.0, 0, 119)


def test_where_the_playhead_rests_after_the_last_edit_is_kept_too(
    make_document: Any, tmp_path: Path, qtbot: Any
) -> None:
    document = make_document()
    edit(document)
    document.playhead.set_frame(17)
    qtbot.waitUntil(lambda: not document._rest.isActive())
    died(document)
    (session,) = recoverable_sessions(tmp_path / "state")
    assert recovered_session(session).playhead == document.playhead.state


@pytest.mark.parametrize("seed", range(12))
def test_any_edits_are_recovered_to_the_byte_with_a_history_that_undoes_them_all(
    make_document: Any, tmp_path: Path, seed: int
) -> None:
    document, chance, gesture = make_document(), Random(seed), 0
    first = state(document.project)
    for step in range(60):
        gesture = document.new_gesture() if step % 4 == 0 else gesture
        if chance.random() < 0.2:
            document.undo_stack.setIndex(chance.randrange(document.undo_stack.count() + 1))
        edit_at_random(document, chance, gesture)
    last, history = state(document.project), document.history
    died(document)
    (session,) = recoverable_sessions(tmp_path / "state")
    other = make_document()
    other.recover(session)
    assert (state(other.project), other.history) == (last, history)
    other.undo_stack.setIndex(0)
    assert state(other.project) == first


def test_only_what_is_saved_or_given_up_a_month_ago_is_tidied_away(make_document: Any, tmp_path: Path) -> None:
    folder, month = tmp_path / "state", timedelta(days=31)
    saved, lost, declined = make_document(), make_document(), make_document()
    for document in (saved, lost, declined):
        edit(document)
    saved.save(tmp_path / "walk.studio")
    died(saved)
    died(lost)
    declined.close()
    remove_useless_sessions(folder)
    assert len(recoverable_sessions(folder, declined=True)) == 2
    remove_useless_sessions(folder, datetime.now() + month)
    (session,) = recoverable_sessions(folder, declined=True)
    assert not session.declined
    assert len(list(folder.glob("*.sqlite"))) == 1


def test_a_recovered_session_that_dies_again_is_recovered_again(make_document: Any, tmp_path: Path) -> None:
    document = make_document()
    edit(document)
    last = state(document.project)
    for _ in range(3):
        died(document)
        (session,) = recoverable_sessions(tmp_path / "state")
        document = make_document()
        document.recover(session)
    assert state(document.project) == last


def test_what_is_saved_needs_no_recovery_and_what_comes_after_does(make_document: Any, tmp_path: Path) -> None:
    path = tmp_path / "walk.studio"
    document = make_document()
    edit(document)
    document.save(path)
    assert not document.dirty
    died(document)
    assert recoverable_sessions(tmp_path / "state") == ()
    document = make_document()
    document.open(path)
    document.add("props", Prop("Late"), "Add")
    last = state(document.project)
    died(document)
    (session,) = recoverable_sessions(tmp_path / "state")
    assert (session.path, session.edits) == (path, 1)
    assert state(recovered_session(session).project) == last


def test_the_moves_of_one_gesture_are_offered_as_one_edit_as_the_undo_stack_has_them(
    make_document: Any, tmp_path: Path
) -> None:
    document = make_document()
    for xs in ((0.1, 0.2, 0.3), (0.4, 0.5)):
        gesture = document.new_gesture()
        for x in xs:
            wrist = document.project.constraints["constraint 0"]
            document.replace("constraints", "constraint 0", replace(wrist, target=(x, 0.0, 1.0)), "Move", gesture)
    document.add("props", Prop("Late"), "Add")
    count = len(document.history)
    died(document)
    (session,) = recoverable_sessions(tmp_path / "state")
    assert session.edits == count == 3


def test_a_session_still_alive_is_not_offered(make_document: Any, tmp_path: Path) -> None:
    document = make_document()
    edit(document)
    assert document.journal.flush()
    assert recoverable_sessions(tmp_path / "state") == ()


def test_edits_that_the_user_gave_up_stay_on_the_disk(make_document: Any, tmp_path: Path) -> None:
    document = make_document()
    edit(document)
    last = state(document.project)
    document.close()
    assert recoverable_sessions(tmp_path / "state") == ()
    (session,) = recoverable_sessions(tmp_path / "state", declined=True)
    assert state(recovered_session(session).project) == last


def test_a_closed_session_with_nothing_unsaved_leaves_nothing(make_document: Any, tmp_path: Path) -> None:
    document = make_document()
    edit(document)
    document.save(tmp_path / "walk.studio")
    document.close()
    assert not list((tmp_path / "state").glob("*.sqlite*"))


def test_looking_at_a_project_writes_no_journal(make_document: Any, tmp_path: Path) -> None:
    make_document()
    assert not list((tmp_path / "state").glob("*.sqlite*"))


def test_a_damaged_step_costs_only_what_comes_after_it(make_document: Any, tmp_path: Path) -> None:
    document = make_document()
    for number in range(70):
        document.add("props", Prop(str(number)), "Add")
    died(document)
    (session,) = recoverable_sessions(tmp_path / "state")
    with sqlite3.connect(session.file) as connection:
        connection.execute("UPDATE steps SET edits = replace(edits, '\"60\"', '\"sixty\"') WHERE number = 61")
    connection.close()
    recovered = recovered_session(session)
    assert len(recovered.project.props) == 60
    assert "61" in recovered.problems[0]


def test_the_status_line_says_how_many_edits_are_safe(make_document: Any) -> None:
    document = make_document()
    document.add("props", Prop("Box"), "Add")
    assert document.journal.flush()
    assert document.journal_state == "All changes backed up - 1 edit"


def test_a_second_window_has_the_project_for_reading(make_document: Any, tmp_path: Path) -> None:
    path = tmp_path / "walk.studio"
    first, second = make_document(), make_document()
    first.save(path)
    second.open(path)
    assert "another window" in second.read_only
    with pytest.raises(StudioError, match="Save as"):
        second.save()
    second.save(tmp_path / "copy.studio")
    assert not second.read_only
    assert read_project(path).document_id != read_project(tmp_path / "copy.studio").document_id


def test_a_journal_that_cannot_be_written_is_told(make_document: Any, tmp_path: Path, qtbot: Any) -> None:
    (tmp_path / "file").write_text("in the way")
    document = make_document(folder=tmp_path / "file" / "state")
    with qtbot.waitSignal(document.problem_reported) as told:
        document.add("props", Prop("Box"), "Add")
    assert "Save the project" in told.args[0]
    assert document.journal_state == "Backup stopped - save the project"


def test_saving_marks_clean_only_what_was_saved(make_document: Any, tmp_path: Path) -> None:
    document = make_document()
    edit(document)
    saving = document.make_save(tmp_path / "walk.studio")
    stamp = saving.write()
    document.add("props", Prop("Meanwhile"), "Add")
    document.note_saved(saving, stamp)
    assert document.dirty
    document.save()
    assert not document.dirty


def test_a_file_changed_by_somebody_else_is_replaced_only_when_asked(make_document: Any, tmp_path: Path) -> None:
    path = tmp_path / "walk.studio"
    document = make_document()
    document.save(path)
    write_project(path, Project(), "f" * 32)
    with pytest.raises(ChangedOnDisk):
        document.save()
    document.save(overwrite=True)
    assert state(read_project(path).project) == state(document.project)


def test_a_failed_open_leaves_the_open_project_untouched(make_document: Any, tmp_path: Path) -> None:
    (tmp_path / "bad.studio").write_bytes(b"not a project")
    document = make_document()
    edit(document)
    before, history = state(document.project), document.history
    with pytest.raises(StudioError):
        document.open(tmp_path / "bad.studio")
    assert (state(document.project), document.history) == (before, history)


def test_a_damaged_project_is_not_saved_over_its_file(make_document: Any, tmp_path: Path) -> None:
    path = tmp_path / "walk.studio"
    document = make_document()
    document.save(path)
    path.write_bytes(path.read_bytes()[:-300])
    told: list[str] = []
    other = make_document(folder=tmp_path / "other")
    other.problem_reported.connect(told.append)
    other.open(path)
    assert told
    with pytest.raises(StudioError, match="Save as"):
        other.save()


def test_who_saves_over_what_another_window_has_open_is_told_first(make_document: Any, tmp_path: Path) -> None:
    path = tmp_path / "walk.studio"
    first, second = make_document(), make_document()
    first.save(path)
    before = path.read_bytes()
    with pytest.raises(ChangedOnDisk, match="open in another window"):
        second.save(path)
    assert path.read_bytes() == before
    first.close()
    second.save(path)
    assert path.read_bytes() != before


def test_what_a_closed_window_still_opens_is_neither_locked_nor_kept(make_document: Any, tmp_path: Path) -> None:
    path = tmp_path / "walk.studio"
    late, other = make_document(), make_document()
    other.save(path)
    other.close()
    late.close()
    late.open(path)
    assert late.journal is None
    after = make_document()
    after.open(path)
    assert not after.read_only


def test_a_recovered_session_does_not_save_over_what_was_saved_since(make_document: Any, tmp_path: Path) -> None:
    path = tmp_path / "walk.studio"
    document = make_document()
    document.save(path)
    edit(document)
    died(document)
    later = make_document()
    later.open(path)
    edit(later, 2)
    later.save()
    later.close()
    [session] = recoverable_sessions(tmp_path / "state")
    again = make_document()
    again.recover(session)
    with pytest.raises(ChangedOnDisk):
        again.save()
    again.save(overwrite=True)


def test_a_recovered_session_saves_over_the_file_that_it_knew(make_document: Any, tmp_path: Path) -> None:
    path = tmp_path / "walk.studio"
    document = make_document()
    edit(document)
    document.save(path)
    edit(document, 2)
    died(document)
    [session] = recoverable_sessions(tmp_path / "state")
    again = make_document()
    again.recover(session)
    again.save()
    assert not again.dirty
