from dataclasses import replace

import numpy as np
import pytest

from studio.core.stage.prop import Prop
from studio.engine.posed_performer import posed_performers
from studio.engine.prop_places import props_at
from studio.viewport.body_points import body_joints, point_path
from studio.viewport.camera import OrbitCamera
from studio.viewport.picking import body_at, joint_at, prop_under
from tests.builders import make_project
from tests.viewport.standing import results_of

SIZE = (1200.0, 700.0)
CAMERA = OrbitCamera(target=(0.0, 0.6, 0.9), distance=6.0)


@pytest.fixture
def posed():
    project = make_project(characters=2)
    return posed_performers(project, results_of(project).get, 0.0)


def test_a_click_on_any_joint_of_a_body_finds_that_joint(posed):
    for performer_id, pose in posed.items():
        for joint in body_joints(pose.motion.morphology.layout):
            camera = CAMERA.framing(pose.points[joint.index] + 0.4 * np.vstack([np.eye(3), -np.eye(3)]), SIZE)
            pixel = camera.project(pose.points[joint.index], SIZE)[0][0]
            found = joint_at(posed, camera, SIZE, *pixel)
            assert found is not None
            assert found.performer_id == performer_id
            away = camera.project(pose.points[found.joint.index], SIZE)[0][0] - pixel
            assert found.joint == joint or np.hypot(*away) < 8, joint.name


def test_a_click_on_a_joint_of_a_body_far_away_finds_it_and_not_a_nearer_body_above_or_below_it():
    project = make_project(characters=2)
    far = replace(project.performers["performer 1"], position=(-5.0, 0.0))
    near = replace(project.performers["performer 0"], position=(1.0, 0.0))
    project = project.with_entity("performers", "performer 1", far).with_entity("performers", "performer 0", near)
    posed = posed_performers(project, results_of(project).get, 0.0)
    camera = OrbitCamera(azimuth=0.0, target=(-2.0, 0.0, 0.9), distance=25.0)
    for performer_id, pose in posed.items():
        joints = body_joints(pose.motion.morphology.layout)
        pixels = camera.project(pose.points[[joint.index for joint in joints]], SIZE)[0]
        for joint, pixel in zip(joints, pixels, strict=True):
            found = joint_at(posed, camera, SIZE, *pixel)
            at = camera.project(posed[found.performer_id].points[found.joint.index], SIZE)[0][0]
            assert np.hypot(*(at - pixel)) <= 2.0, (performer_id, joint.name, found)


def test_a_click_beside_every_joint_finds_none_but_may_find_the_body(posed):
    pose = posed["performer 0"]
    knee, ankle = pose.motion.morphology.layout.hip_point(0) + 1, pose.motion.morphology.layout.ankle_point(0)
    pixel = CAMERA.project((pose.points[knee] + pose.points[ankle]) / 2, SIZE)[0][0]
    assert joint_at(posed, CAMERA, SIZE, *pixel) is None
    assert body_at(posed, CAMERA, SIZE, *pixel) == "performer 0"
    assert body_at(posed, CAMERA, SIZE, 3.0, 3.0) is None


def test_the_point_that_a_joint_constrains_is_that_joint(posed):
    motion = posed["performer 0"].motion
    for joint in body_joints(motion.morphology.layout):
        assert point_path(motion, joint.point) == pytest.approx(motion.positions[:, joint.index], abs=1e-12)


def test_the_nearer_of_two_boxes_in_line_is_hit():
    near, far = (Prop(name, position=tuple(CAMERA.eye * share)) for name, share in (("near", 0.6), ("far", 0.1)))
    project = make_project().with_entity("props", "far", far).with_entity("props", "near", near)
    pixel = CAMERA.project(near.position, SIZE)[0][0]
    props = props_at(project, {}, 0.0)
    assert prop_under(props, CAMERA, SIZE, *pixel) == "near"
    assert prop_under(props, CAMERA, SIZE, 2.0, 2.0) is None
