"""docs/plug_ins.md, walked in an empty folder: its files are written, installed, and every part is used."""

import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from PySide6.QtWidgets import QPushButton

from studio.api import new_scene
from studio.core.constraints.kinds import CONSTRAINT_KINDS
from studio.core.quality.motion_measures import ADDED_MEASURES
from studio.io import plug_ins
from studio.io.plug_ins import PANELS_GROUP, panel_of, plug_in_entries
from studio.panels.constraint_editors import editor_of_kind
from studio.viewport.handle_figures import figure_of
from studio.viewport.rotated_targets import target_of_kind
from tests.api.conftest import ROOT, installed, run_beside
from tests.builders import make_constraint

GUIDE = ROOT / "docs" / "plug_ins.md"
WALK = str(ROOT / "examples" / "captures" / "walk_turn.bvh")
FILE = re.compile(r"^`([\w./]+)`\n\n```\w+\n(.*?)^```$", re.MULTILINE | re.DOTALL)


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """An empty folder with the files of the guide."""
    folder = tmp_path_factory.mktemp("my_folder")
    for name, text in FILE.findall(GUIDE.read_text(encoding="utf-8")):
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def site(folder: Path, tmp_path_factory) -> Path:
    """A folder into which pip has installed the package of the guide."""
    return installed(folder, tmp_path_factory.mktemp("guide_site"))


def test_the_verb_and_the_kind_of_file_of_the_guide_are_there(site: Path) -> None:
    main = str(ROOT / "main.py")
    assert re.search(r"^Child: 0\.\d+ m$", run_beside(site, main, "heights", "child"), re.MULTILINE)
    assert "Hip path" in run_beside(site, main, "formats")


def test_the_script_of_the_guide_adapts_its_constraint_and_writes_its_file(
    folder: Path, site: Path, tmp_path: Path
) -> None:
    out = tmp_path / "hips.path"
    assert float(run_beside(site, str(folder / "use_balloon.py"), WALK, str(out)).splitlines()[-1]) < 2e-4
    assert np.loadtxt(out).shape[1] == 2


def test_the_panel_of_the_guide_numbers_the_performers_as_one_undo_step(site: Path, register, qtbot) -> None:
    register(site)
    scene = new_scene()
    scene.add_performer(scene.add_character("child"), scene.add_capture(WALK))
    [entry] = plug_in_entries(PANELS_GROUP)
    panel = entry.load(panel_of).make(scene)
    qtbot.addWidget(panel)
    assert isinstance(panel, QPushButton)
    panel.click()
    assert [each.name for each in scene.project.performers.values()] == ["Performer 1"]
    scene.undo()
    assert [each.name for each in scene.project.performers.values()] != ["Performer 1"]


def test_the_kind_and_the_measure_of_the_guide_have_all_their_parts(site: Path, register) -> None:
    register(site)
    kind = CONSTRAINT_KINDS["my_balloon"]
    given = make_constraint()
    constraint = kind.value(
        given.motion_id, "Balloon", given.point, given.chain, 0, given.activation, centre=(0.0, 0.0, 1.0)
    )
    assert [len(line) for line in figure_of(constraint, SimpleNamespace(), 0.0).lines] == [49] * 3
    assert target_of_kind(constraint).scales == (True, False, False)
    assert editor_of_kind("my_balloon").__name__ == "BalloonEditor"
    assert kind.make is not None
    assert list(ADDED_MEASURES) == ["Head height"]
    assert plug_ins.load_registered() == ()
    with pytest.raises(ValueError, match="radius above zero"):
        kind.value(given.motion_id, "Balloon", given.point, given.chain, 0, given.activation, radius=0.0)
