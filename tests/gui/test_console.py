"""The Python console: edits of the open project as undo steps, errors in words, and a window that goes on meanwhile."""

import random
import time
from dataclasses import replace

import pytest
from PySide6.QtCore import Qt, QTimer
from PySide6.QtTest import QTest

from studio.core.stage.project import Project
from studio.core.stage.prop import Prop

PATIENCE = 30_000


@pytest.fixture
def console(qtbot, window):
    window.actions_by_id.by_id["console"].trigger()
    qtbot.waitUntil(window.console.entry.hasFocus)
    return window.console


@pytest.fixture
def run(qtbot, console):
    """Type statements, press Enter, and wait for what is shown of them."""

    def run(source: str) -> str:
        before = len(console.shown.toPlainText())
        QTest.keyClicks(console.entry, source)
        with qtbot.waitSignal(console.session.ended, timeout=PATIENCE):
            QTest.keyClick(console.entry, Qt.Key.Key_Return)
        QTest.qWait(0)
        return console.shown.toPlainText()[before:]

    return run


def test_the_value_of_an_expression_is_shown_and_kept(run) -> None:
    assert "'studio'.upper()" in (shown := run("'studio'.upper()"))
    assert shown.rstrip().endswith("'STUDIO'")
    assert run("len(_)").rstrip().endswith("6")


def test_an_edit_is_an_undo_step_of_the_window(run, window) -> None:
    document = window.bench.document
    [first, *_] = document.project.performers
    before, steps = document.project, document.undo_stack.count()
    run(f"scene.change('performers', '{first}', position=(1.0, 2.0))")
    assert document.project.performers[first].position == (1.0, 2.0)
    assert document.undo_stack.count() == steps + 1
    document.undo_stack.undo()
    assert document.project == before


def test_a_block_with_undo_step_is_one_step_and_an_error_in_it_takes_all_back(qtbot, console, window) -> None:
    document = window.bench.document
    first, second = document.project.performers
    steps, before = document.undo_stack.count(), document.project
    source = (
        "with scene.undo_step('Move both'):\n"
        f"    scene.change('performers', '{first}', position=(3.0, 0.0))\n"
        f"    scene.change('performers', '{second}', position=(4.0, 0.0))\n"
    )
    with qtbot.waitSignal(console.session.ended, timeout=PATIENCE):
        console.run(source)
    assert document.undo_stack.count() == steps + 1
    assert document.undo_stack.text(steps) == "Move both"
    document.undo_stack.undo()
    with qtbot.waitSignal(console.session.ended, timeout=PATIENCE):
        console.run(source + "    1 / 0\n")
    QTest.qWait(0)
    assert document.project == before
    assert "ZeroDivisionError" in console.shown.toPlainText()


def test_an_error_shows_the_statement_and_none_of_the_console(run) -> None:
    shown = run("[][0]")
    assert "IndexError: list index out of range" in shown
    assert "console_session.py" not in shown


def test_an_error_of_the_studio_is_its_sentence_alone(run) -> None:
    shown = run("scene.change('performers', 'nobody', position=(0, 0))")
    assert "There is no 'nobody' among the performers." in shown
    assert "Traceback" not in shown


def test_an_open_block_goes_on_and_a_blank_line_ends_it(qtbot, console) -> None:
    QTest.keyClicks(console.entry, "for number in range(3):")
    QTest.keyClick(console.entry, Qt.Key.Key_Return)
    assert console.entry.toPlainText() == "for number in range(3):\n    "
    QTest.keyClicks(console.entry, "print(number * 11)")
    QTest.keyClick(console.entry, Qt.Key.Key_Return)
    assert not console.session.running
    for _ in range(4):
        QTest.keyClick(console.entry, Qt.Key.Key_Backspace)
    with qtbot.waitSignal(console.session.ended, timeout=PATIENCE):
        QTest.keyClick(console.entry, Qt.Key.Key_Return)
    QTest.qWait(0)
    assert console.shown.toPlainText().rstrip().endswith("0\n11\n22")


def test_the_window_goes_on_while_a_statement_runs_and_stop_ends_it(qtbot, console) -> None:
    beats = []
    heart = QTimer(console, interval=10)
    heart.timeout.connect(lambda: beats.append(time.monotonic()))
    heart.start()
    with qtbot.waitSignal(console.session.ended, timeout=PATIENCE):
        console.run("while True: pass")
        qtbot.waitUntil(lambda: len(beats) > 20, timeout=PATIENCE)
        assert not console.run("1")
        console.stop_button.click()
    QTest.qWait(0)
    assert "KeyboardInterrupt" in console.shown.toPlainText()
    assert not console.stop_button.isEnabled()


def test_earlier_statements_come_back_with_up_and_names_are_completed_with_tab(run, console) -> None:
    run("answer = 42")
    run("'second'")
    QTest.keyClick(console.entry, Qt.Key.Key_Up)
    QTest.keyClick(console.entry, Qt.Key.Key_Up)
    assert console.entry.toPlainText() == "answer = 42"
    console.entry.clear()
    QTest.keyClicks(console.entry, "answ")
    QTest.keyClick(console.entry, Qt.Key.Key_Tab)
    assert console.entry.toPlainText() == "answer"


def test_a_window_that_closes_leaves_a_running_statement_behind(qtbot, console, window) -> None:
    console.run("import time\nwhile True: time.sleep(0.01); scene.project")
    qtbot.waitUntil(lambda: console.session.running)
    window.close_without_saving()
    qtbot.waitUntil(lambda: not console.session.running, timeout=PATIENCE)


WAITING_BLOCK = (
    "import time\n"
    "with scene.undo_step('Move'):\n"
    "    scene.change('performers', 'performer 0', position=(3.0, 0.0))\n"
    "    while not scene.project.props: time.sleep(0.01)\n"
    "    scene.change('performers', 'performer 0', position=(4.0, 0.0))\n"
)


@pytest.fixture
def block(qtbot, console, window):
    """The document while a block with an edit waits for a prop; adding one lets it go on."""

    def begin(source: str = WAITING_BLOCK):
        document = window.bench.document
        console.run(source)
        qtbot.waitUntil(lambda: document.project.performers["performer 0"].position == (3.0, 0.0), timeout=PATIENCE)
        return document

    yield begin
    console.session.stop()
    qtbot.waitUntil(lambda: not console.session.running, timeout=PATIENCE)


def end_of(block_document, qtbot, console):
    with qtbot.waitSignal(console.session.ended, timeout=PATIENCE):
        block_document.add("props", Prop("Box"), "Add box")
    QTest.qWait(0)


def test_an_edit_of_the_user_within_a_block_outlasts_its_error(block, qtbot, console) -> None:
    document = block(WAITING_BLOCK + "    1 / 0\n")
    end_of(document, qtbot, console)
    assert [prop.name for prop in document.project.props.values()] == ["Box"]
    assert document.project.performers["performer 0"].position == (3.0, 0.0)
    assert [document.undo_stack.text(k) for k in range(document.undo_stack.count())] == ["Move", "Add box"]


def test_undo_within_a_block_takes_back_what_it_has_done_and_all_steps_lead_back_to_the_beginning(
    block, qtbot, console, window
) -> None:
    document = window.bench.document
    performer = document.project.performers["performer 0"]
    begin = document.project
    document.replace("performers", "performer 0", replace(performer, name="Mine"), "Rename")
    block()
    document.undo_stack.undo()
    assert document.project.performers["performer 0"] == replace(performer, name="Mine")
    end_of(document, qtbot, console)
    assert document.project.performers["performer 0"].position == (4.0, 0.0)
    while document.undo_stack.canUndo():
        document.undo_stack.undo()
    assert document.project == begin


def test_a_block_leaves_a_project_alone_that_is_opened_meanwhile(block, qtbot, console) -> None:
    document = block()
    document.new(Project())
    end_of(document, qtbot, console)
    assert document.undo_stack.count() == 1
    assert not document.project.performers


def test_stop_at_any_moment_ends_a_statement_once_and_leaves_no_step_open(qtbot, console, window) -> None:
    chance, document = random.Random(0), window.bench.document
    endless = (
        "while True:\n    with scene.undo_step('Move'): scene.change('performers', 'performer 0', position=(1, 0))"
    )
    begin = document.project
    ended = []
    console.session.ended.connect(lambda: ended.append(1))
    for turn in range(60):
        console.run("sum(range(20000))" if turn % 2 else endless)
        until = time.monotonic() + 0.004 * chance.random()
        while time.monotonic() < until:
            pass
        console.session.stop()
        console.session.stop()
        qtbot.waitUntil(lambda: not console.session.running, timeout=PATIENCE)
    assert len(ended) == 60
    document.add("props", Prop("Box"), "Add box")
    assert document.undo_stack.undoText() == "Add box"
    while document.undo_stack.canUndo():
        document.undo_stack.undo()
    assert document.project == begin
