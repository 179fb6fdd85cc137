"""A point of a skin is picked by the mouse and constrained where it is."""

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt

from studio.core.body.canonical import BodyPart
from studio.core.mesh.skin import skin_vertices, with_grip
from studio.core.solver.adapt import body_point_positions
from tests.gui.test_ten_tasks import CTRL, SHIFT, staged, user
from tests.gui.viewport_use import drag, on_arrow, settle

__all__ = ["user"]


def skin_of(viewport, document, performer_id):
    """Skin and its vertices (V, 3) on the stage, as they are drawn."""
    pose = viewport.posed[performer_id]
    character, row = document.project.characters[pose.performer.character_id], pose.row
    skin = with_grip(character.skin, pose.grip(character.grip))
    vertices, normals = skin_vertices(
        skin, character.build, pose.motion.morphology_at(row), pose.motion.positions[row], pose.motion.rotations[row]
    )
    return skin, pose.placement.to_stage(vertices), normals @ pose.placement.rotation.T


def seen_vertex(viewport, document, performer_id, part):
    """Stage position of a vertex that moves with a segment alone and faces the camera."""
    skin, vertices, normals = skin_of(viewport, document, performer_id)
    segment = viewport.posed[performer_id].motion.morphology.layout.segment_of_part(part)
    own = (skin.segments[:, 0] == segment) & (skin.weights[:, 0] > 0.99)
    sight = viewport.camera.eye - vertices
    facing = (normals * sight).sum(axis=1) / np.linalg.norm(sight, axis=1)
    return vertices[np.where(own, facing, -1.0).argmax()]


def pick(user, place):
    user.press(Qt.Key.Key_J, CTRL | SHIFT)
    assert user.viewport.picks_skin
    user.click(user.viewport.widget_point(place).toPoint(), user.viewport)


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("project", [staged()])
def test_the_back_of_a_forearm_is_picked_constrained_and_moved(user, mirrored):
    first, _ = user.project.performers
    if mirrored:
        performer = user.project.performers[first]
        clips = tuple(replace(each, mirrored=True) for each in performer.clips)
        user.document.replace("performers", first, replace(performer, clips=clips), "Mirror")
    user.go_to(160)
    user.document.selection.set(("performers", first))
    user.press(Qt.Key.Key_F)
    settle(user.viewport)
    place = seen_vertex(user.viewport, user.document, first, BodyPart.RIGHT_FOREARM)
    pick(user, place)
    picked = user.viewport.joint_picked
    assert (picked.performer_id, picked.joint.point.part) == (first, BodyPart.RIGHT_FOREARM)
    assert np.linalg.norm(picked.joint.point.offset) > 0.02
    user.press(Qt.Key.Key_C)
    [constraint] = user.project.constraints.values()
    part = BodyPart.LEFT_FOREARM if mirrored else BodyPart.RIGHT_FOREARM
    assert (constraint.name, constraint.point.part) == (f"{part.label} skin", part)
    settle(user.viewport)
    target = next(each.target for each in user.viewport.handles() if each.performer_id == first)
    assert target == pytest.approx(place, abs=0.004)  # of a pixel
    drag(user.viewport, on_arrow(user.viewport, "z", 0.7), on_arrow(user.viewport, "z", 1.3))
    user.solved()
    raised = next(each.target for each in user.viewport.handles() if each.performer_id == first)
    assert raised[2] - target[2] > 0.03
    _, vertices, _ = skin_of(user.viewport, user.document, first)
    assert np.linalg.norm(vertices - raised, axis=1).min() < 0.006
    body = user.solved()[first]
    point = picked.joint.point
    pose = user.viewport.posed[first]
    assert pose.placement.to_stage(body_point_positions(point, body)[pose.row]) == pytest.approx(raised, abs=0.002)


@pytest.mark.parametrize("project", [staged()])
def test_esc_ends_the_pick_and_a_click_beside_all_bodies_goes_on_with_it(user):
    user.press(Qt.Key.Key_J, CTRL | SHIFT)
    user.click(QPoint(20, user.viewport.height() - 20), user.viewport)
    assert user.viewport.picks_skin
    assert "Esc" in user.viewport.notice
    user.press(Qt.Key.Key_Escape)
    assert not user.viewport.picks_skin
    assert user.viewport.joint_picked is None
    assert not user.project.constraints
