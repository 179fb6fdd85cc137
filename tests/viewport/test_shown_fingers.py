"""Fingers of a character's own rig wherever its skin is shown or picked: the body, its ghosts, its coarse skin."""

from dataclasses import replace
from typing import cast

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint
from studio.core.solver.adapt import body_point_positions
from studio.core.stage.project import Project
from studio.core.stage.prop import InHand, Prop
from studio.engine.posed_performer import PosedPerformer, pose_of, posed_performers
from studio.jobs.performances import stage_performances
from studio.viewport.bodies import pose_skin
from studio.viewport.camera import OrbitCamera
from studio.viewport.coarse import coarse_skin, coarse_triangles
from studio.viewport.ghost_bodies import GhostBody
from studio.viewport.onion_skins import OnionSkins, onion_ghosts
from studio.viewport.skin_picking import skin_point_at
from tests.io.test_finger_export import hero

__all__ = ["hero"]
OPEN, CLOSED = 0.0, 50 / 60


def posed(project: Project, time: float) -> PosedPerformer:
    [(key, performance)] = stage_performances(project).performances.items()
    return pose_of(project, key, performance.adapted, time)


def moved(project: Project, pose: PosedPerformer) -> np.ndarray:
    """(V,) metres by which fingers move the vertices."""
    character = project.characters[pose.performer.character_id]
    shown, stiff = (pose_skin(character.skin, character, each)[0] for each in (pose, replace(pose, captures=())))
    return np.linalg.norm(shown - stiff, axis=1)


def test_ghosts_have_the_fingers_of_their_moment(hero: Project) -> None:
    [performance] = stage_performances(hero).performances.values()
    poses = posed_performers(hero, lambda _: performance.adapted, OPEN)
    *_, ghost = onion_ghosts(hero, poses, OnionSkins(0, 2, 25), OPEN, 60.0)
    character = hero.characters["character 0"]
    body = GhostBody(character)
    body.show(ghost, character)
    assert np.array_equal(body._mesh.points, pose_skin(character.skin, character, posed(hero, CLOSED))[0])
    assert moved(hero, ghost.pose).max() > 0.02


def test_ghosts_of_a_body_that_holds_a_prop_close_their_hands_as_the_body_does(hero: Project) -> None:
    key = next(iter(hero.performers))
    hand = BodyPoint(BodyPart.RIGHT_HAND)
    stick = Prop("Stick", (0.03, 0.03, 1.0), (0.0, 0.0, 1.0), held=InHand(key, hand))
    pose = posed(hero.with_entity("props", "stick", stick), OPEN)
    assert pose.holding == 1.0


def test_a_finger_is_picked_where_it_is_shown(hero: Project) -> None:
    pose = posed(hero, CLOSED)
    character = hero.characters["character 0"]
    triangles = character.skin.triangles
    corners = pose_skin(character.skin, character, pose)[0][
        triangles[moved(hero, pose)[triangles].mean(axis=1).argmax()]
    ]
    across = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    place = pose.placement.to_stage(corners.mean(axis=0).astype(float))
    out = pose.placement.rotation @ (across / np.linalg.norm(across))

    class Camera:
        def ray(self, *_: object) -> tuple[np.ndarray, np.ndarray]:
            return place + 0.002 * out, -out

    picked = skin_point_at(hero, {"performer 0": pose}, cast(OrbitCamera, Camera()), (8.0, 6.0), 4.0, 3.0)
    assert picked is not None
    hands = (BodyPart.LEFT_HAND, BodyPart.RIGHT_HAND)
    assert picked.joint.point.part in hands
    found = pose.placement.to_stage(body_point_positions(picked.joint.point, pose.motion)[pose.row])
    assert found == pytest.approx(place, abs=1e-3)


def test_a_coarse_skin_keeps_its_rig(hero: Project) -> None:
    skin = replace(hero.characters["character 0"].skin, appearance=None)
    coarse = coarse_skin(skin)
    kept = np.unique(coarse_triangles(skin))
    assert len(kept) < len(skin.vertices)
    character, pose = hero.characters["character 0"], posed(hero, CLOSED)
    some, whole = pose_skin(coarse, character, pose)[0], pose_skin(skin, character, pose)[0]
    assert some == pytest.approx(whole[kept], abs=1e-6)
