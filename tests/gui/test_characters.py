"""Characters as a person brings them: dropped on the window, made of an actor, played by others, saved and back."""

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QMimeData, QPointF, Qt, QUrl
from PySide6.QtGui import QDropEvent
from PySide6.QtWidgets import QPushButton
from scipy.spatial.transform import Rotation

from studio.app.character_import import add_read_character
from studio.core.body.canonical import BodyPart
from studio.core.mesh.appearance import Material
from studio.core.mesh.skin import Blending, bound_pose
from studio.core.solver.request import AdaptedMotion
from studio.core.stage.project import Performer
from studio.document.commands.replace import same_value
from studio.engine.posed_performer import Placement, PosedPerformer
from studio.io.importing import load_character
from studio.io.project.project_file import new_document_id, read_project, write_project
from studio.viewport.bodies import BodyVisual
from tests.io.character_files import PIXEL, Gltf, vrml
from tests.patience import PATIENCE


@pytest.fixture
def hero(tmp_path):
    path = tmp_path / "my_hero.glb"
    path.write_bytes(Gltf().glb())
    return path


def drop(qtbot, window, path):
    content = QMimeData()
    content.setUrls([QUrl.fromLocalFile(str(path))])
    event = QDropEvent(
        QPointF(400, 300), Qt.DropAction.CopyAction, content, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
    )
    window.dropEvent(event)
    qtbot.waitUntil(lambda: not window.bench.runner.running, timeout=PATIENCE)


def newest(window):
    """The performer that is selected and its character."""
    project = window.bench.document.project
    [key] = window.bench.document.selection.of("performers")
    return project.performers[key], project.characters[project.performers[key].character_id]


def test_a_dropped_character_stands_beside_the_others_and_plays_with_them_as_one_undo_step(qtbot, window, hero):
    document = window.bench.document
    before = document.project
    others = list(before.performers.values())
    drop(qtbot, window, hero)
    performer, character = newest(window)
    assert window.strip.text == ""
    assert (performer.name, character.name) == ("my hero", "my hero")
    assert performer.clips == others[0].clips
    assert performer.position[1] > max(other.position[1] for other in others) + 1.0
    assert document.history == ("Import my_hero.glb",)
    document.undo_stack.undo()
    assert same_value(document.project, before)


def test_a_broad_character_stands_clear_of_its_neighbour(qtbot, window, tmp_path):
    """Trunk and head, whatever they wear, with room for arms between them."""
    character = next(iter(window.bench.document.project.characters.values()))
    skin = character.skin
    broad = replace(character, skin=replace(skin, vertices=skin.vertices * np.float32([1.0, 8.0, 1.0])), name="Broad")
    wide = float(np.abs(broad.skin.vertices[broad.skin.segments[:, 0] == 0, 1]).max())
    outermost = max(each.position[1] for each in window.bench.document.project.performers.values())
    add_read_character(window.bench.document, broad, "Import")
    assert newest(window)[0].position[1] - outermost > max(1.2, wide + 0.5)


def test_what_was_repaired_is_told_in_the_strip(qtbot, window, tmp_path):
    path = tmp_path / "hero.wrl"
    path.write_text(vrml().replace("skinCoordIndex [ 32 33 34 35 36 37 38 39 ]", "skinCoordIndex [ ]", 1))
    drop(qtbot, window, path)
    assert window.strip.text.startswith("hero.wrl was read with 1 repair: 8 points of the skin had no joint")


def test_the_motion_that_came_along_is_offered(qtbot, window, tmp_path):
    path = tmp_path / "dancer.glb"
    path.write_bytes(Gltf().moving().glb())
    drop(qtbot, window, path)
    assert window.strip.text == "dancer.glb also contains animation."
    [offer] = [button for button in window.strip.findChildren(QPushButton) if button.text() == "Import animation"]
    offer.click()
    qtbot.waitUntil(lambda: not window.bench.runner.running, timeout=PATIENCE)
    document = window.bench.document
    assert document.history == ("Import dancer.glb", "Import dancer.glb")
    assert len(document.project.captures) == 2


def test_a_bad_character_leaves_the_project_as_it_was(qtbot, window, hero):
    before = window.bench.document.project
    hero.write_bytes(hero.read_bytes()[:-100])
    drop(qtbot, window, hero)
    assert "my_hero.glb is cut off" in window.strip.text
    assert window.strip.text.endswith("Your project was not changed.")
    assert window.bench.document.project is before


def test_the_actor_of_a_capture_becomes_a_character_of_the_same_measures_with_one_click(qtbot, window):
    document = window.bench.document
    [capture_id] = document.project.captures
    document.selection.set(("captures", capture_id))
    window.inspector.editor._actor.click()
    qtbot.waitUntil(lambda: not window.bench.runner.running, timeout=PATIENCE)
    performer, character = newest(window)
    assert performer.name == "Actor of walk"
    assert character.build.leg == pytest.approx(np.array([[0.43, 0.42], [0.43, 0.42]]), abs=0.05)
    assert len(document.history) == 1
    heights = character.skin.vertices[:, 2]
    assert heights.max() - heights.min() == pytest.approx(character.build.stature, rel=0.06)


def test_another_character_can_play_a_performer(qtbot, window, hero):
    drop(qtbot, window, hero)
    document = window.bench.document
    _, character = newest(window)
    first = next(iter(document.project.performers))
    document.selection.set(("performers", first))
    cast = window.inspector.editor._cast
    cast.setCurrentIndex(cast.findText("my hero"))
    cast.activated.emit(cast.currentIndex())
    performer = document.project.performers[first]
    assert document.project.characters[performer.character_id] is character
    assert performer.name == "my hero"
    assert document.history[-1].endswith(" to my hero")


def test_nothing_of_a_character_is_lost_in_the_project_file(qtbot, window, hero, tmp_path):
    drop(qtbot, window, hero)
    project = window.bench.document.project
    [key] = set(project.characters) - {"character 0", "character 1"}
    dual = replace(project.characters[key], blending=Blending.DUAL_QUATERNIONS)
    project = project.with_entity("characters", key, dual)
    write_project(tmp_path / "saved.studio", project, new_document_id())
    opened = read_project(tmp_path / "saved.studio")
    assert opened.problems == ()
    assert same_value(opened.project.characters[key], dual)
    look = opened.project.characters[key].skin.appearance
    assert look.materials[0].texture.tobytes() == PIXEL


def test_each_material_is_drawn_in_its_colour_and_texture(tmp_path):
    made = Gltf()
    made.root["materials"].append({"pbrMetallicRoughness": {"baseColorFactor": [1.0, 0.0, 0.0, 1.0]}})
    primitive = made.root["meshes"][0]["primitives"][0]
    made.root["meshes"][0]["primitives"].append({**primitive, "material": 1})
    (tmp_path / "hero.glb").write_bytes(made.glb())
    character = load_character(tmp_path / "hero.glb").character
    textured, red = BodyVisual(character).skin_actors
    assert textured.texture is not None
    assert red.texture is None
    assert red.prop.color.hex_rgb == "#ff0000"
    assert isinstance(character.skin.appearance.materials[1], Material)


def test_the_skin_that_is_drawn_bends_as_was_chosen(tmp_path):
    (tmp_path / "hero.glb").write_bytes(Gltf().glb())
    linear = load_character(tmp_path / "hero.glb").character
    weights = np.full_like(linear.skin.weights, 0.0)
    weights[:, :2] = 0.5
    segments = linear.skin.segments.copy()
    hand = linear.build.layout.segment_of_part(BodyPart.LEFT_HAND)
    segments[:, 1] = np.where(segments[:, 0] == hand, hand - 1, segments[:, 0])
    linear = replace(linear, skin=replace(linear.skin, weights=weights, segments=segments))
    positions, rotations = (part[None].copy() for part in bound_pose(linear.skin, linear.build))
    rotations[0, hand] = rotations[0, hand] @ Rotation.from_rotvec([0.0, 0.0, 2.5]).as_matrix()
    motion = AdaptedMotion(linear.build, 30.0, 0, positions, rotations, np.empty((0, 1)))
    posed = PosedPerformer(Performer("hero", "hero"), motion, 0, Placement())
    visual = BodyVisual(linear)
    drawn = []
    for blending in Blending:
        visual.take_skin(replace(linear, blending=blending))
        visual.pose(posed, bones=False)
        drawn.append(np.array(visual.skin_actors[0].mapper.dataset.points))
    moved = np.linalg.norm(drawn[1] - drawn[0], axis=1)
    assert moved[segments[:, 0] == hand].max() > 0.01
    assert moved[segments[:, 0] != hand].max() < 1e-5
