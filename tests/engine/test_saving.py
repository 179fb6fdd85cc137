"""A save runs beside the window and tells the document when the file is whole."""

import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from studio.core.errors import StudioError
from studio.core.stage.prop import Prop
from studio.document.document import Document
from studio.engine.background_tasks import TaskRunner
from studio.engine.saving import save_in_background
from studio.io.project.entity_json import project_json
from studio.io.project.project_file import read_project
from tests.builders import make_project


@pytest.fixture
def runner(qapp: Any) -> Iterator[TaskRunner]:
    runner = TaskRunner()
    yield runner
    runner.close()
    assert not [thread for thread in threading.enumerate() if thread.name.startswith("task-")]


def test_a_save_beside_the_window_leaves_a_clean_document(qtbot: Any, runner: TaskRunner, tmp_path: Path) -> None:
    document = Document(make_project())
    document.add("props", Prop("Box"), "Add")
    path = tmp_path / "walk.studio"
    with qtbot.waitSignal(runner.finished):
        save_in_background(document, runner, path)
    assert (document.path, document.dirty) == (path, False)
    assert project_json(read_project(path).project, {}) == project_json(document.project, {})


def test_what_is_edited_while_a_save_runs_is_still_to_be_saved(qtbot: Any, runner: TaskRunner, tmp_path: Path) -> None:
    document = Document(make_project())
    with qtbot.waitSignal(runner.finished):
        save_in_background(document, runner, tmp_path / "walk.studio")
        document.add("props", Prop("Meanwhile"), "Add")
    assert document.dirty
    assert not read_project(tmp_path / "walk.studio").project.props


def test_a_save_that_fails_leaves_the_document_as_it_was(qtbot: Any, runner: TaskRunner, tmp_path: Path) -> None:
    document = Document(make_project())
    document.add("props", Prop("Box"), "Add")
    with qtbot.waitSignal(runner.failed) as failure:
        save_in_background(document, runner, tmp_path / "gone" / "walk.studio")
    assert "Save as" in failure.args[1]
    assert (document.path, document.dirty) == (None, True)


def test_a_project_without_a_file_asks_for_one(qapp: Any, runner: TaskRunner) -> None:
    with pytest.raises(StudioError, match="Save as"):
        save_in_background(Document(make_project()), runner)
