"""Questions of the export dialog about a capture that has more than a body."""

from dataclasses import replace

import pytest

from studio.app import export_dialog
from studio.io.importing import load_capture
from tests.builders import make_project
from tests.io.bvh_exports import EXTRAS, with_extras
from tests.patience import PATIENCE


@pytest.fixture
def project():
    """A body that plays a capture with fingers, an eye and a prop."""
    return replace(make_project(characters=1, contacts=0), captures={"capture": with_extras()})


@pytest.mark.parametrize("others", ["carry", "leave"])
def test_fingers_and_props_go_out_with_a_character_unless_they_are_left_out(
    qtbot, window, tmp_path, monkeypatch, others
):
    path = tmp_path / "out.bvh"
    monkeypatch.setattr(export_dialog, "ask_new_file", lambda bench, title, kind, name, then, suffix: then(path))
    dialog = export_dialog.open_export_dialog(window.bench)
    dialog.choose(export_dialog.ExportContent.ADAPTED, ".bvh")
    assert dialog.others.isVisible()
    assert dialog.others.currentText() == "Keep: Eye and 4 more"
    dialog.others.show_value(others)
    dialog.go.click()
    qtbot.waitUntil(lambda: not window.bench.runner.running, timeout=PATIENCE)
    there = set(EXTRAS) & set(load_capture(path).skeleton.names)
    assert there == (set(EXTRAS) if others == "carry" else set())
    again = export_dialog.open_export_dialog(window.bench)
    assert again.others.value == others
    again.choose(export_dialog.ExportContent.ADAPTED, ".csv")
    assert not again.others.isVisible()
    again.reject()
