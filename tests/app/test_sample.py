"""The stored answers that the studio opens with equal those that it solves."""

import numpy as np
import pytest

from studio.app import sample
from studio.core.constraints.own_place import OwnPlace
from studio.core.normalized.normalize import detected_contacts
from studio.engine.posed_performer import posed_performers
from studio.engine.target_context import TargetContext
from studio.io.adapted_file import read_adapted, write_adapted
from studio.io.importing import load_capture
from studio.jobs.performances import adapted_performers
from studio.viewport.body_points import body_joints, point_path
from studio.viewport.new_constraints import NewConstraintContext, constraint_here
from tests.architecture.sources import ROOT

CLOSE = 5e-3
"""Metres by which a solver may have changed since the sample was made: nobody sees them."""


def test_the_sample_is_as_the_solver_has_it():
    project, shown = sample.read_sample()
    solved = adapted_performers(project)
    assert shown.keys() == solved.keys() == project.performers.keys()
    for key, motion in shown.items():
        away = np.linalg.norm(motion.positions - solved[key].positions, axis=-1).max()
        turned = np.abs(motion.rotations - solved[key].rotations).max()
        assert away < CLOSE, f"{key}: {1000 * away:.1f} mm. Run `make examples`."
        assert turned < 10 * CLOSE, f"{key}. Run `make examples`."


def test_the_sample_is_the_bundled_capture_with_its_contacts():
    project, _ = sample.read_sample()
    kept, capture = project.captures[sample.SAMPLE_MOTION_ID], load_capture(sample.capture_file())
    assert np.allclose(kept.poses.local_rotations, capture.poses.local_rotations, atol=1e-9)
    assert np.allclose(kept.poses.local_translations, capture.poses.local_translations, atol=1e-9)
    assert set(project.contacts.values()) == set(detected_contacts(capture, sample.SAMPLE_MOTION_ID))


def test_c_on_the_sample_gives_each_body_its_own_place_before_anything_is_solved():
    project, shown = sample.read_sample()
    posed = posed_performers(project, shown.get, 154 / 60)
    ball = next(each for each in body_joints(posed["child"].motion.morphology.layout) if "ball" in each.name)
    for pose in posed.values():
        made = constraint_here(NewConstraintContext(TargetContext(project, posed, pose), ball), "position")
        assert isinstance(made.target, OwnPlace)


def test_c_on_the_sample_leaves_every_limb_its_speed():
    project, shown = sample.read_sample()
    for frame in (60, 100, 148, 154, 160, 200):
        posed = posed_performers(project, shown.get, frame / 60)
        for key in ("child", "giant"):
            here = TargetContext(project, posed, posed[key])
            for joint in body_joints(posed[key].motion.morphology.layout):
                made = constraint_here(NewConstraintContext(here, joint), "position")
                path = point_path(shown[key], joint.point)
                drawn = path + made.activation.at(np.arange(len(path)) / 60)[:, None] * (path[frame] - path)
                near = slice(max(frame - 70, 0), frame + 70)
                speed, before = (
                    60 * np.linalg.norm(np.diff(each[near], axis=0), axis=1).max() for each in (drawn, path)
                )
                assert speed < 1.1 * max(before, 0.1) + 1e-6, f"{key}, {joint.name}, frame {frame}"


@pytest.mark.parametrize("frame", [140, 148, 152, 154, 165])
def test_c_on_the_kicking_foot_leaves_it_its_speed_as_the_engine_solves_it(frame):
    project, shown = sample.read_sample()
    posed = posed_performers(project, shown.get, frame / 60)
    here = TargetContext(project, posed, posed["child"])
    ball = next(
        each for each in body_joints(posed["child"].motion.morphology.layout) if each.name == "right ball of foot"
    )
    held = project.with_entity("constraints", "held", constraint_here(NewConstraintContext(here, ball), "position"))
    near, solved = slice(frame - 60, frame + 60), adapted_performers(held)
    for key in ("child", "giant"):
        paths = (point_path(each[key], ball.point) for each in (shown, solved))
        before, after = (60 * np.linalg.norm(np.diff(path[near], axis=0), axis=1).max() for path in paths)
        assert after < 1.1 * before, key


def test_adapted_motions_come_back_as_finely_as_anybody_sees(tmp_path):
    project, shown = sample.read_sample()
    write_adapted(tmp_path / "again.npz", shown)
    bodies = {key: each.morphology for key, each in project.characters.items()}
    again = read_adapted(tmp_path / "again.npz", bodies, 60.0)
    for key, motion in shown.items():
        assert np.abs(again[key].positions - motion.positions).max() < 1e-4
        assert np.abs(again[key].rotations - motion.rotations).max() < 2e-4


def test_the_sample_is_small():
    assert sum(path.stat().st_size for path in (ROOT / "examples" / "sample").iterdir()) < 1_000_000
