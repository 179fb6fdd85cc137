"""The status line counts what the user did, not how the mouse moved."""

from dataclasses import replace

from PySide6.QtWidgets import QLabel

from studio.document.document import Document
from studio.panels.status_line import ProgressLine, StatusLine, journal_words
from tests.builders import make_project


def test_one_drag_is_one_edit(qapp, tmp_path):
    document = Document(make_project(), journal_folder=tmp_path)
    gesture = document.new_gesture()
    for step in range(5):
        constraint = document.project.constraints["constraint 0"]
        moved = replace(constraint, target=(0.1 * step, 0.0, 1.0))
        document.replace("constraints", "constraint 0", moved, "Move target", gesture)
    assert document.journal.flush()
    assert journal_words(document) == "All changes backed up · 1 edit"
    document.undo_stack.undo()
    assert document.journal.flush()
    assert journal_words(document) == "All changes backed up · 0 edits"
    document.close()


def test_without_a_journal_there_are_only_edits(qapp):
    assert journal_words(Document(make_project())) == "0 edits"


def test_the_newest_job_is_told_and_the_one_before_when_that_ends(qtbot):
    line = ProgressLine()
    qtbot.addWidget(line)
    line.begin(1, "Opening walk.bvh")
    line.show_share(1, 0.25, "reading")
    line.begin(2, "Preparing the solver")
    assert line.now == ("Preparing the solver", 0.0)
    line.end(2)
    assert line.now == ("Opening walk.bvh · reading", 0.25)
    line.end(1)
    assert line.now == ("", 0.0)


def test_a_text_of_two_lines_is_told_in_one_and_never_widens_the_window(qtbot):
    status = StatusLine(Document(make_project()))
    qtbot.addWidget(status)
    status.show()
    status.show_hint("kick")
    status.layout().activate()
    least = status.minimumSizeHint().width()
    status.show_hint(f"kick: frames 0 to 251\nDrag to trim. {'Later clips move along. ' * 20}")
    status.layout().activate()
    assert any(each.text().startswith("kick: frames 0 to 251 · Drag to trim.") for each in status.findChildren(QLabel))
    assert status.minimumSizeHint().width() == least


def test_every_long_job_tells_the_time_left_from_its_first_progress_on(qtbot):
    """Only the preparation of the solver did; a video of minutes did not."""
    clock = [100.0]
    line = ProgressLine(lambda: clock[0])
    qtbot.addWidget(line)
    line.begin(1, "Video")
    told = []
    for seconds, share in ((30, 0.0), (40, 0.1), (41, 0.11), (45, 0.2), (50, 0.3), (85, 0.5)):
        clock[0] = 100.0 + seconds
        line.show_share(1, share, f"Frame {round(100 * share)}")
        told.append(line.now[0])
    assert told == [
        "Video · Frame 0", "Video · Frame 10", "Video · Frame 11",
        "Video · Frame 20 · about 40 s left", "Video · Frame 30 · about 40 s left", "Video · Frame 50",
    ]  # fmt: skip


def test_no_time_left_is_told_while_the_pace_changes(qtbot):
    """It said 133 s, and later 454 s, as others began to use the machine."""
    clock = [0.0]
    line = ProgressLine(lambda: clock[0])
    qtbot.addWidget(line)
    line.begin(1, "Export")
    slow_from, slow_until = 20, 340
    told = {}
    for second in range(slow_until):
        clock[0] = second
        share = 0.01 + (0.01 * second if second < slow_from else 0.19 + 0.0025 * (second - slow_from))
        line.show_share(1, share, "")
        told[second] = line.now[0].removeprefix("Export").removeprefix(" · ")
    assert told[10] == "about 90 s left"
    assert {told[second] for second in range(35, 100)} == {""}
    for second in range(100, slow_until):
        if told[second]:
            number, unit = told[second].split()[1:3]
            seconds = float(number) * (60.0 if unit == "min" else 1.0)
            assert abs(seconds - (slow_until - second)) <= 60.0
    assert told[250]


def test_the_time_left_is_told_in_minutes_if_it_is_long_and_anew_where_the_progress_goes_back(qtbot):
    clock = [0.0]
    line = ProgressLine(lambda: clock[0])
    qtbot.addWidget(line)
    line.begin(1, "Export")
    told = []
    for seconds, share in ((1, 0.1), (11, 0.125), (20, 0.05), (21, 0.06), (30, 0.55), (31, 1.0)):
        clock[0] = seconds
        line.show_share(1, share, "")
        told.append(line.now[0])
    assert told == ["Export", "Export · about 6 min left", "Export", "Export", "Export · about 10 s left", "Export"]
