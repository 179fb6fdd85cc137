"""The markers of a C3D in the real window: a map finished by clicks, saved and used again; steps; signals."""

from dataclasses import replace

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest

from studio.app.application import show_views
from studio.app.marker_dialog import open_markers
from studio.core.markers.cleaning import LowPass
from studio.core.markers.trial import AnalogSignals, ForcePlate, Trial, TrialEvent
from studio.io.c3d.writer import write_c3d
from studio.io.markers.maps import known_maps, maps_folder
from tests.builders import make_project
from tests.core.markers.made import FRAMES, RATE, made_trial
from tests.io.trials import make_trial
from tests.patience import PATIENCE, SECONDS

KNEE, MARKER = "left_knee", "P_left_knee"


@pytest.fixture
def project():
    return make_project(characters=1)


def nameless() -> Trial:
    """Legs and arms of the made body under labels that say nothing, with a plate and an event."""
    trial, marker_map = made_trial()
    of_label = {labels[0]: f"P_{role}" for role, labels in marker_map.markers.items()}
    made = make_trial()
    samples = made.analog.samples[:1].repeat(FRAMES * 4, axis=0)
    return replace(
        trial,
        labels=tuple(of_label[label][::-1] for label in trial.labels),
        analog=AnalogSignals(made.analog.labels, made.analog.units, 4 * RATE, samples),
        plates=(ForcePlate(2, made.plates[0].corners, made.plates[0].origin, (0, 1, 2, 3, 4, 5)),),
        events=(TrialEvent("Foot Strike", "Left", 0.5),),
    )


@pytest.fixture
def dialog(qtbot, window, tmp_path):
    """The nameless trial, dropped on the window, with its markers on show."""
    write_c3d(tmp_path / "walk.c3d", nameless())
    project = window.bench.document.project
    known = set(project.captures)
    window.open_paths([tmp_path / "walk.c3d"])
    qtbot.waitUntil(lambda: set(window.bench.document.project.captures) != known, timeout=PATIENCE)
    [capture_id] = set(window.bench.document.project.captures) - known
    return open_markers(window.bench, capture_id)


def capture_of(window, dialog):
    return window.bench.document.project.captures[dialog._capture_id]


def put(dialog, role: str) -> None:
    """Click a place on the figure, then its marker in the list, by mouse."""
    figure, markers = dialog.assistant.figure, dialog.assistant.list
    QTest.mouseClick(figure, Qt.MouseButton.LeftButton, pos=figure.place_of(role).toPoint())
    [item] = markers.findItems(f"P_{role}"[::-1], Qt.MatchFlag.MatchExactly, 0)
    markers.scrollToItem(item)
    place = markers.visualItemRect(item).center()
    QTest.mouseClick(markers.viewport(), Qt.MouseButton.LeftButton, pos=QPoint(20, place.y()))


LEGS = [f"{side}_{part}" for side in ("left", "right") for part in ("front_hip", "back_hip", "knee", "ankle", "toe")]


def test_a_map_is_finished_by_clicks_applied_and_undone(qtbot, window, dialog) -> None:
    assert capture_of(window, dialog).body_map is None
    assert "Still missing: left front of the pelvis" in dialog.words.text()
    assert not dialog.apply.isEnabled()
    for role in LEGS:
        put(dialog, role)
    assert dialog.words.text() == "The legs can be solved; the arms will stay in the rest pose."
    qtbot.mouseClick(dialog.apply, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: capture_of(window, dialog).body_map is not None, timeout=PATIENCE)
    document = window.bench.document
    assert not dialog.apply.isEnabled()
    assert all(performer.clips for performer in document.project.performers.values())
    document.undo_stack.undo()
    assert capture_of(window, dialog).body_map is None


def test_a_saved_map_is_used_for_the_next_file_of_its_set(qtbot, window, dialog, tmp_path) -> None:
    for role in LEGS:
        put(dialog, role)
    dialog.assistant.name.setText("Backwards")
    dialog.assistant.save()
    try:
        assert "Backwards" in [known.name for known in known_maps()]
        known = set(window.bench.document.project.captures)
        window.open_paths([tmp_path / "walk.c3d"])
        qtbot.waitUntil(lambda: set(window.bench.document.project.captures) != known, timeout=PATIENCE)
        [added] = set(window.bench.document.project.captures) - known
        capture = window.bench.document.project.captures[added]
        assert capture.markers.marker_map.name == "Backwards"
        assert capture.body_map is not None
    finally:
        (maps_folder() / "Backwards.json").unlink()


def test_a_marker_is_taken_from_its_place_by_a_second_click_or_by_clear(dialog) -> None:
    put(dialog, "left_knee")
    assert dialog.assistant.marker_map.markers["left_knee"]
    put(dialog, "left_knee")
    assert "left_knee" not in dialog.assistant.marker_map.markers
    put(dialog, "left_thigh")
    dialog.assistant.put_marker("P_left_shank"[::-1])
    assert len(dialog.assistant.marker_map.markers["left_thigh"]) == 2
    dialog.assistant.clear_role()
    assert "left_thigh" not in dialog.assistant.marker_map.markers


def test_every_place_can_be_hit_with_the_mouse(dialog) -> None:
    from studio.core.markers.roles import ROLES

    figure = dialog.assistant.figure
    assert [figure.role_at(figure.place_of(role.id)) for role in ROLES] == [role.id for role in ROLES]


def test_a_recorded_marker_is_clicked_on_to_the_chosen_place_and_a_drag_turns_them(dialog) -> None:
    cloud, label = dialog.assistant.cloud, "P_neck_back"[::-1]
    dialog.assistant.choose_role("neck_back")
    dots = cloud.dots()
    assert dots[label].y() < dots["P_left_ankle"[::-1]].y()
    QTest.mouseClick(cloud, Qt.MouseButton.LeftButton, pos=dots[label].toPoint())
    assert dialog.assistant.marker_map.markers["neck_back"] == (label,)
    before = dict(dialog.assistant.marker_map.markers)
    QTest.mousePress(cloud, Qt.MouseButton.LeftButton, pos=QPoint(40, 40))
    QTest.mouseMove(cloud, QPoint(80, 40))
    QTest.mouseMove(cloud, QPoint(300, 40))
    QTest.mouseRelease(cloud, Qt.MouseButton.LeftButton, pos=QPoint(300, 40))
    assert cloud.dots()[label] != dots[label]
    assert dict(dialog.assistant.marker_map.markers) == before


def test_recorded_markers_are_seen_from_behind_once_sides_are_known(dialog) -> None:
    for role in LEGS:
        put(dialog, role)
    dialog.assistant._face()
    dots = dialog.assistant.cloud.dots()
    for part in ("knee", "wrist", "shoulder"):
        assert dots[f"P_left_{part}"[::-1]].x() < dots[f"P_right_{part}"[::-1]].x()


def test_a_step_is_added_tried_and_applied(qtbot, window, dialog) -> None:
    for role in LEGS:
        put(dialog, role)
    before = len(dialog.steps.steps)
    dialog.steps.add.value_chosen.emit(LowPass)
    assert len(dialog.steps.steps) == before + 1
    qtbot.waitUntil(lambda: len(dialog.steps._reports) == before + 1, timeout=PATIENCE)
    assert dialog.steps._reports[-1].summary.startswith("Smoothed at 8 Hz")
    qtbot.mouseClick(dialog.apply, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: capture_of(window, dialog).markers.steps[-1] == LowPass(), timeout=PATIENCE)
    assert any(guess.subject == "smooth" for guess in capture_of(window, dialog).guesses)


def test_signals_and_events_are_plotted_and_a_click_moves_the_playhead(window, dialog) -> None:
    dialog.tabs.setCurrentIndex(2)
    signals = dialog.signals
    assert signals.plotted_names() == ["Plate 1"]
    signals.tick("Mx1")
    names = [curve.name() for curve in signals.plot.getPlotItem().listDataItems()]
    assert names == ["Plate 1 x", "Plate 1 y", "Plate 1 z", "Mx1"]
    assert "1 events" in signals.note.text()
    dialog._seek(0.3)
    assert window.bench.document.playhead.time == pytest.approx(0.3)
    assert signals._playhead.value() == pytest.approx(0.3)


def test_with_another_project_it_closes(window, dialog) -> None:
    window.bench.document.new(make_project())
    assert not dialog.isVisible()


def test_without_an_optical_capture_it_says_what_to_do(window) -> None:
    from studio.core.errors import StudioError

    with pytest.raises(StudioError, match="Import a C3D file"):
        open_markers(window.bench)


def test_a_body_is_read_otherwise_without_its_file(qtbot, window, dialog, tmp_path) -> None:
    """The recording is in the project: an up axis said in the inspector needs nothing else."""
    for role in LEGS:
        put(dialog, role)
    dialog.solve()
    qtbot.waitUntil(lambda: capture_of(window, dialog).body_map is not None, timeout=PATIENCE)
    (tmp_path / "walk.c3d").unlink()
    window.inspector.reimport_requested.emit(dialog._capture_id, {"floor": 0.25})
    qtbot.waitUntil(lambda: capture_of(window, dialog).floor == 0.25, timeout=PATIENCE)
    assert capture_of(window, dialog).markers.marker_map == dialog.assistant.marker_map


@pytest.fixture
def view(window, dialog):
    """The 3D view of the window with the nameless trial."""
    show_views(window)
    return window.bench.viewport


def test_markers_that_show_no_body_are_seen_in_the_3d_view_and_the_chosen_one_stands_out(qtbot, dialog, view):
    qtbot.waitUntil(lambda: view._recorded is not None, timeout=PATIENCE)
    assert len(view._recorded.points) == len(nameless().markers)
    assert view.notice == ""
    put(dialog, KNEE)
    assert view.recording.marked == (MARKER[::-1],)
    dialog.assistant.choose_role("right_knee")
    assert view.recording.marked == ()
    dialog.tabs.setCurrentWidget(dialog.signals)
    dialog.signals.tick(MARKER[::-1])
    assert view.recording.marked == (MARKER[::-1],)
    dialog.close()
    assert view.recording.marked == ()


def test_the_markers_behind_a_motion_are_shown_on_demand(qtbot, window, dialog, view):
    window.resize(1280, 720)  # chips that have no room are not shown
    for role in LEGS:
        put(dialog, role)
    dialog.apply.click()
    qtbot.waitUntil(lambda: capture_of(window, dialog).body_map is not None, timeout=PATIENCE)
    dialog.close()
    window.bench.document.selection.clear()
    actions = window.actions_by_id.by_id
    assert window.bench.live.wait_until_solved(SECONDS)
    qtbot.waitUntil(lambda: view.posed and view._chips.markers.isVisibleTo(view), timeout=PATIENCE)
    assert view._recorded is None
    actions["recorded_markers"].trigger()
    qtbot.waitUntil(lambda: view._recorded is not None, timeout=PATIENCE)
    assert actions["recorded_markers"].isChecked()
    assert view._recorded.used.sum() == len(LEGS)
    actions["marker_names"].trigger()
    assert view.recording.named
    actions["recorded_markers"].trigger()
    qtbot.waitUntil(lambda: view._recorded is None, timeout=PATIENCE)


def test_steps_that_were_tried_as_the_dialog_closes_are_shown_nowhere(qtbot, window, dialog) -> None:
    failed = []
    window.bench.runner.failed.connect(lambda _, words: failed.append(words))
    dialog.steps.changed.emit()
    with qtbot.waitSignal(dialog.destroyed):
        dialog.close()
    qtbot.waitUntil(lambda: not window.bench.runner.running, timeout=PATIENCE)
    assert not failed
