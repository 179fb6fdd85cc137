"""The table of constraints by body, and the tour of the problems in it by keys."""

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from studio.app.problem_tour import ProblemTour
from studio.app.workbench import Workbench
from studio.core.errors import INTERNAL_ERROR
from studio.core.solver.performers.rows import timing_of
from studio.document.document import Document
from studio.engine.problem_search import ProblemSearch
from studio.engine.quality_summary import WHOLE_MOTION, problems_in, summary_of
from studio.panels.problem_table import ProblemTable
from tests.builders import make_constraint, make_project
from tests.patience import PATIENCE
from tests.viewport.standing import StandingLive, results_of


class Bench(Workbench):
    """A workbench without an engine that works."""

    def __init__(self, document, live):
        super(Workbench, self).__init__()
        self.document, self.live = document, live


@pytest.fixture
def stage(qtbot):
    """Two bodies that stand and slide forward, with two targets that they miss; what is shown of that."""
    project = make_project(characters=2, constraints=1)
    far = make_constraint(name="Far", priority=3, target=(3.0, -0.3, 1.2))
    document = Document(project.with_entity("constraints", "far", far))
    live = StandingLive(document)
    search = ProblemSearch(document, live)
    bench = Bench(document, live)
    tour, table = ProblemTour(bench, search, bench), ProblemTable(search)
    table.problem_chosen.connect(tour.show)
    qtbot.addWidget(table)
    yield document, live, search, bench, tour, table
    search.close()
    document.close()


def test_every_constraint_has_a_row_on_every_body_with_its_worst_residual(stage):
    document, *_ = stage
    project = document.project
    results = results_of(project)
    rows = summary_of(project, results, {})
    assert {(row.performer_id, row.name) for row in rows} == {
        (key, name) for key in project.performers for name in (WHOLE_MOTION, "Target 0", "Far")
    }
    far = next(row for row in rows if row.name == "Far" and row.performer_id == "performer 1")
    index = [each.name for each in project.constraints_of("motion").values()].index("Far")
    worst = results["performer 1"].residuals[index][6:19].max()  # fully active from 0.1 to 0.3 s at 60 Hz
    assert far.findings["residual"].amount == pytest.approx(worst)


def test_bodies_that_slide_are_told_with_the_moment_and_the_capture_itself_has_no_peak(stage):
    document, *_ = stage
    project = document.project
    results = results_of(project)
    rows = summary_of(project, results, results and {"motion": results["performer 0"]})
    whole = {row.performer_id: row for row in rows if row.constraint_id is None}
    timing = timing_of(project, project.performers["performer 0"])
    slide = whole["performer 0"].findings["slide"]
    assert slide.amount > 0.02  # the standing bodies are moved 0.3 m forward in half a second
    assert timing.begin <= slide.time <= timing.begin + 0.5
    assert whole["performer 0"].findings["peak"].amount == pytest.approx(0.0, abs=1e-6)


def test_a_foot_that_skates_is_a_problem_also_where_no_contact_says_that_it_stands(stage):
    document, *_ = stage
    free = replace(document.project, contacts={}, constraints={})
    results = results_of(free)
    first = next(iter(summary_of(free, results, {})))
    assert "slide" not in first.findings
    slower = {key: replace(each, positions=each.positions * [0.7, 1.0, 1.0]) for key, each in results.items()}
    skating = summary_of(free, slower, {})
    found = problems_in(skating)[0]
    assert found.sentence == f"{found.row.body}: foot sliding 210 mm, {WHOLE_MOTION}"
    in_the_air = {
        key: replace(each, positions=np.add(each.positions, (0.0, 0.0, 0.01))) for key, each in slower.items()
    }
    assert not problems_in(summary_of(free, in_the_air, {}))


def test_problems_are_in_the_order_of_their_weight_and_each_is_named_once(stage):
    document, *_ = stage
    found = problems_in(summary_of(document.project, results_of(document.project), {}))
    weights = [each.finding.weight for each in found]
    assert weights == sorted(weights, reverse=True)
    assert len({each.key for each in found}) == len(found)
    assert {each.aspect for each in found} >= {"residual", "slide"}


def test_next_problem_goes_to_the_worst_then_on_and_previous_back(stage, qtbot):
    document, _, search, bench, tour, _ = stage
    said = []
    bench.message_posted.connect(lambda message: said.append(message.sentence))
    with qtbot.waitSignal(search.found, timeout=PATIENCE):
        tour.go(1)
    first = search.problems[0]
    assert document.playhead.time == pytest.approx(first.finding.time, abs=0.5 / 60.0)
    assert ("performers", first.row.performer_id) in document.selection
    assert said[-1].startswith(f"Problem 1 of {len(search.problems)}. {first.row.body}")
    tour.go(1)
    assert said[-1].startswith("Problem 2 of")
    tour.go(-1)
    tour.go(-1)
    assert said[-1].startswith(f"Problem {len(search.problems)} of")


def test_a_problem_that_is_mended_leaves_the_tour_and_the_worst_that_remains_is_next(stage, qtbot):
    document, live, search, bench, tour, _ = stage
    with qtbot.waitSignal(search.found, timeout=PATIENCE):
        tour.go(1)
    worst = search.problems[0]
    assert worst.row.name == "Far"
    off = replace(document.project.constraints["far"], enabled=False)
    document.replace("constraints", "far", off, "Turn off")
    live.reported_changed.emit()
    said = []
    bench.message_posted.connect(lambda message: said.append(message.sentence))
    with qtbot.waitSignal(search.found, timeout=PATIENCE):
        tour.go(1)
    assert said[-1].startswith("Problem 1 of")
    assert "Far" not in said[-1]


def test_a_column_sorts_by_badness_and_a_click_goes_to_the_frame_and_selects(stage, qtbot):
    document, _, search, _, _, table = stage
    with qtbot.waitSignal(search.found, timeout=PATIENCE):
        table.show()
    grid = table.table
    assert grid.rowCount() == len(search.rows) == 6
    residuals = [grid.item(line, 2).data(Qt.ItemDataRole.UserRole + 2) for line in range(6)]
    assert residuals == sorted(residuals, reverse=True)
    grid.sortByColumn(3, Qt.SortOrder.DescendingOrder)
    slides = [grid.item(line, 3).data(Qt.ItemDataRole.UserRole + 2) for line in range(6)]
    assert slides == sorted(slides, reverse=True)
    line = next(line for line in range(6) if grid.item(line, 1).text() == "Far")
    where = grid.visualItemRect(grid.item(line, 2)).center()
    QTest.mouseClick(grid.viewport(), Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, where)
    row = grid.item(line, 2).data(Qt.ItemDataRole.UserRole)
    assert document.selection.items == (("performers", row.performer_id), ("constraints", "far"))
    assert document.playhead.time == pytest.approx(row.findings["residual"].time, abs=0.5 / 60.0)


def test_a_stage_that_cannot_be_measured_is_told_in_a_sentence_and_logged(stage, qtbot, monkeypatch, caplog):
    _, _, search, _, tour, _ = stage

    def broken(*_):
        raise ValueError("no")

    monkeypatch.setattr("studio.engine.problem_search.summary_of", broken)
    with qtbot.waitSignal(search.failed, timeout=PATIENCE) as caught:
        tour.go(1)
    assert f"{INTERNAL_ERROR}: no" in caught.args[0]
    assert [record.exc_info[0] for record in caplog.records] == [ValueError]
    assert search.rows == ()


def test_a_stage_that_changes_while_it_is_measured_is_measured_again_for_the_key_that_was_pressed(
    stage, qtbot, monkeypatch
):
    document, live, search, _, tour, _ = stage
    measured = []

    def changing(*arguments):
        measured.append(arguments)
        if len(measured) == 1:
            live.reported_changed.emit()
        return summary_of(*arguments)

    monkeypatch.setattr("studio.engine.problem_search.summary_of", changing)
    with qtbot.waitSignal(search.found, timeout=PATIENCE):
        tour.go(1)
    assert len(measured) == 2
    assert document.playhead.time == pytest.approx(search.problems[0].finding.time, abs=0.5 / 60.0)
