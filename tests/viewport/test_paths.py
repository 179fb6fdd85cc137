from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.captures.contacts import ContactPoint
from studio.core.constraints.base import BodyPoint
from studio.core.curves.keyed import KeyedPlace
from studio.core.grounds.steps import Steps
from studio.engine.posed_performer import posed_performers
from studio.viewport.opening import CHIPS_HEIGHT_PX, opening_camera
from studio.viewport.paths import contact_marks, selection_rings, trail_keys, trails
from tests.builders import make_constraint, make_contact, make_project
from tests.viewport.standing import RATE, results_of

WRIST = BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True)


@pytest.fixture
def stage():
    project = make_project(characters=2, contacts=0)
    return project, posed_performers(project, results_of(project).get, 0.2)


def test_a_trail_passes_through_the_point_of_each_body_now_and_is_strongest_there(stage):
    project, posed = stage
    for path, pose in zip(trails(project, posed, WRIST), posed.values(), strict=True):
        now = pose.points[pose.motion.morphology.layout.wrist_point(1)]
        nearest = np.linalg.norm(path.points - now, axis=1).argmin()
        assert path.points[nearest] == pytest.approx(now, abs=1e-9)
        assert path.opacity.argmax() == nearest
    assert trails(project, posed, None) == []


def test_keys_of_a_target_are_marked_on_the_trail_where_the_body_is_at_their_times(stage):
    project, posed = stage
    keyed = KeyedPlace((0.1, 0.3, 30.0), ((0.0, 0.0, 1.0), (0.1, 0.0, 1.0), (0.2, 0.0, 1.0)))
    project = project.with_entity("constraints", "keyed", make_constraint(target=keyed))
    marks = trail_keys(project, posed, WRIST, "keyed")
    assert len(marks) == len(posed)
    for mark, path in zip(marks, trails(project, posed, WRIST), strict=True):
        assert len(mark.points) >= 2
        away = np.linalg.norm(mark.points[:, None] - path.points, axis=2).min(axis=1)
        assert away == pytest.approx(0.0, abs=1e-9)
        assert mark.colour == path.colour
    plain = project.with_entity("constraints", "keyed", make_constraint(activation=None))
    assert trail_keys(plain, posed, WRIST, "gone") == []


def test_a_mark_lies_on_the_ground_under_a_foot_only_while_it_is_in_contact(stage):
    project, posed = stage
    frame = round(0.2 * RATE)
    touching = project.with_entity("contacts", "now", make_contact(first=frame, last=frame))
    later = project.with_entity("contacts", "later", make_contact(first=frame + 1, last=frame + 2))
    marks = contact_marks(touching, posed)
    assert contact_marks(later, posed) == []
    for mark, pose in zip(marks, posed.values(), strict=True):
        ankle = pose.points[pose.motion.morphology.layout.ankle_point(0)]
        assert mark.points[:-1, :2].mean(axis=0) == pytest.approx(ankle[:2], abs=1e-9)
        assert mark.points[:, 2] == pytest.approx(0.0, abs=0.01)


def test_a_foot_that_steps_where_a_clip_takes_over_has_no_mark_until_it_stands(stage):
    project, posed = stage
    frame = round(0.2 * RATE)
    heel, hand = (
        make_contact(point=each, first=frame, last=frame) for each in (ContactPoint.LEFT_HEEL, ContactPoint.LEFT_HAND)
    )
    row = SimpleNamespace(contacts=(heel, hand))  # what the clips say
    for stands, count in (((heel,), 2), ((), 1)):
        in_row = {
            key: replace(each, motion=replace(each.motion, composite=row, contacts=stands))
            for key, each in posed.items()
        }
        assert len(contact_marks(project, in_row)) == count * len(posed)


def test_a_ring_is_drawn_round_selected_performers_and_no_others(stage):
    project, posed = stage
    (ring,) = selection_rings(project, posed, ("performer 1", "gone"))
    assert ring.points[:-1, :2].mean(axis=0) == pytest.approx(posed["performer 1"].points[0, :2], abs=1e-9)


def test_the_opening_camera_looks_at_the_faces_and_holds_every_body(stage):
    _, posed = stage
    size = (1200.0, 700.0)
    camera = opening_camera(posed, size)
    assert camera.axes[2, 0] > 0.5
    pixels, _ = camera.project(np.concatenate([pose.points for pose in posed.values()]), size)
    assert ((pixels > 0) & (pixels < size)).all()


@pytest.mark.parametrize("covered", [40.0, 110.0, 180.0])
def test_the_opening_camera_shows_every_body_between_the_chips_and_a_sentence_below(stage, covered):
    _, posed = stage
    for size in ((1200.0, 700.0), (700.0, 560.0)):
        camera = opening_camera(posed, size, covered_below=covered)
        pixels, _ = camera.project(np.concatenate([pose.points for pose in posed.values()]), size)
        assert (pixels[:, 1] >= CHIPS_HEIGHT_PX - 1.0).all()
        assert (pixels[:, 1] <= size[1] - covered + 1.0).all()


def test_the_opening_camera_sees_the_risers_of_steps_before_the_bodies(stage):
    _, posed = stage
    size = (1200.0, 700.0)
    flat, steps = Steps(rise=0.1, count=1, start=(50.0, 0.0)), Steps(rise=0.17, tread=0.2, start=(0.1, 0.0))
    assert opening_camera(posed, size, ground=flat) == opening_camera(posed, size)
    camera = opening_camera(posed, size, ground=steps)
    assert camera.axes[2, 0] < 0.0  # risers face -X
    pixels, _ = camera.project(np.concatenate([pose.points for pose in posed.values()]), size)
    assert ((pixels > 0) & (pixels < size)).all()
