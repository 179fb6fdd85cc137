"""A mesh from a file becomes the shape of the selected area, as one step that can be taken back."""

from dataclasses import replace

import pytest

from studio.app.application import make_application, make_window
from studio.app.settings import Settings
from studio.app.verbs.constraining import put_area_mesh
from studio.core.body.canonical import BodyPart
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.curves.activation import ActivationCurve
from studio.core.errors import StudioError
from studio.document.document import Document
from tests.builders import make_project
from tests.patience import PATIENCE

OBJ = "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 0 1 0\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n"


@pytest.fixture
def bench(qtbot, tmp_path):
    make_application()
    project = make_project(characters=1, constraints=0)
    motion_id = next(iter(project.motions))
    point, always = BodyPoint(BodyPart.LEFT_HAND), ActivationCurve(0.0, 0.0, 1.0, 1.0)
    table = AreaConstraint(motion_id, "Table", point, Chain(), 0, always)
    window = make_window(Settings(tmp_path / "studio.ini"), Document(project.with_entity("constraints", "area", table)))
    yield window.bench
    window.close_without_saving()
    window.deleteLater()


def test_a_mesh_becomes_the_shape_of_the_selected_area(qtbot, bench, tmp_path):
    document, path = bench.document, tmp_path / "rock.obj"
    path.write_text(OBJ)
    said = []
    bench.message_posted.connect(lambda message: said.append(message.sentence))
    with pytest.raises(StudioError, match="Select a volume"):
        put_area_mesh(bench, path)
    document.selection.set(("constraints", "area"))
    before = document.project.constraints["area"]
    put_area_mesh(bench, path)
    qtbot.waitUntil(lambda: not bench.runner.running, timeout=PATIENCE)
    area = document.project.constraints["area"]
    assert (area.shape, len(area.mesh.triangles)) == (AreaShape.MESH, 4)
    assert replace(area, shape=before.shape, mesh=None) == before
    assert "4 triangles" in said[-1]
    assert document.history == ("Load rock.obj for Table",)
    document.undo_stack.undo()
    assert document.project.constraints["area"] == before
