"""Motions out of the window: every kind of file by its one dialog."""

import pytest
from PySide6.QtCore import Qt

from studio.core.captures.annotations import Label
from studio.io.importing import load_capture
from tests.gui.window_use import wait_until_idle
from tests.patience import SECONDS

LEFT = Qt.MouseButton.LeftButton
CONTROL, SHIFT = Qt.KeyboardModifier.ControlModifier, Qt.KeyboardModifier.ShiftModifier


def test_the_adapted_motion_of_a_character_is_exported_as_bvh(qtbot, window, tmp_path):
    from studio.app import exporting

    assert window.bench.live.wait_until_solved(SECONDS)
    path = tmp_path / "out.bvh"
    exporting.export(window.bench, {"performer 0": path})
    wait_until_idle(qtbot, window)
    assert "out.bvh" in window.strip.text
    assert load_capture(path).frame_count == 30


@pytest.mark.parametrize("suffix", [".bvh", ".s4d", ".glb", ".c3d", ".npz"])
def test_every_kind_of_file_goes_out_by_the_one_dialog(qtbot, window, tmp_path, monkeypatch, suffix):
    from studio.app import export_dialog

    asked = []
    monkeypatch.setattr(export_dialog, "ask_folder", lambda bench, title, then: asked.append(title) or then(tmp_path))
    window.actions_by_id.by_id["export"].trigger()
    dialog = window.findChild(export_dialog.ExportDialog)
    dialog.choose(export_dialog.ExportContent.ADAPTED, suffix)
    dialog.names.show_value("unreal")
    dialog.go.click()
    wait_until_idle(qtbot, window)
    assert asked == ["Export 2 adapted motions into a folder"]
    assert sorted(path.name for path in tmp_path.glob("*" + suffix)) == [f"Walk body {k}{suffix}" for k in (0, 1)]
    assert "Exported 2 files" in window.strip.text
    again = export_dialog.open_export_dialog(window.bench)
    assert (again.kind.value.suffix, again.names.value) == (suffix, "unreal")
    again.reject()
    if suffix in (".bvh", ".s4d"):
        assert "upperarm_l" in load_capture(tmp_path / f"Walk body 0{suffix}").skeleton.names


@pytest.mark.parametrize("suffix", [".fbx", ".glb"])
def test_the_whole_stage_goes_out_in_one_file_with_what_is_chosen(qtbot, window, tmp_path, monkeypatch, suffix):
    from studio.app import export_dialog

    path = tmp_path / f"play{suffix}"
    monkeypatch.setattr(export_dialog, "ask_new_file", lambda bench, title, kind, name, then, suffix: then(path))
    window.actions_by_id.by_id["export"].trigger()
    dialog = window.findChild(export_dialog.ExportDialog)
    dialog.choose(export_dialog.ExportContent.STAGE, suffix)
    for choice, value in ((dialog.root, "floor"), (dialog.range, "timeline"), (dialog.frame_rate, 30.0)):
        assert choice.isVisible()
        choice.show_value(value)
    assert not dialog.position.isVisible()
    window.bench.document.playhead.set_range(6, 18)
    dialog.go.click()
    wait_until_idle(qtbot, window)
    capture = load_capture(path)
    assert (capture.frame_count, capture.frame_rate) == (7, 30.0)
    assert any("root" in name for name in capture.skeleton.names)
    again = export_dialog.open_export_dialog(window.bench)
    assert (again.what.value, again.root.value, again.frame_rate.value) == (
        export_dialog.ExportContent.STAGE,
        "floor",
        30.0,
    )
    again.reject()


def test_the_motion_itself_goes_out_with_its_contacts_and_constraints(qtbot, window, tmp_path, monkeypatch):
    from studio.app import export_dialog
    from studio.io.importing import read_capture

    path = tmp_path / "walk.s4d"
    window.bench.document.add("labels", Label("kick", 3, 8, "motion"), "Add label")
    monkeypatch.setattr(export_dialog, "ask_new_file", lambda bench, title, kind, name, then, suffix: then(path))
    window.actions_by_id.by_id["export"].trigger()
    dialog = window.findChild(export_dialog.ExportDialog)
    dialog.choose(export_dialog.ExportContent.MOTION, ".s4d")
    assert not dialog.names.isVisible()
    dialog.go.click()
    wait_until_idle(qtbot, window)
    project = window.bench.document.project
    stored = read_capture(path).annotations.of_motion("motion")
    assert stored.constraints == tuple(project.constraints_of("motion").values())
    assert stored.labels == tuple(project.labels_of("motion").values())
    assert set(stored.contacts) == set(project.contacts_of("motion").values())


def test_a_cancelled_export_leaves_nothing_behind(qtbot, window, tmp_path):
    from studio.app import exporting

    task = exporting.export(window.bench, {"performer 0": tmp_path / "a.glb", "performer 1": tmp_path / "b.glb"})
    window.bench.runner.cancel(task)
    wait_until_idle(qtbot, window)
    assert list(tmp_path.iterdir()) == []
