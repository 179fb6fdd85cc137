"""A scene of a script: edits by id, undo steps, results on the stage, and sentences for what cannot be."""

import inspect
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from studio import api

ROOT = Path(__file__).resolve().parents[2]
KICK = api.example_captures_folder() / "front_kick.bvh"


def _with_kick() -> tuple[api.Scene, str, str]:
    scene = api.new_scene()
    motion = scene.add_capture(KICK)
    return scene, motion, scene.add_performer(scene.add_character("child"), motion)


def reach(motion: str, target: tuple[float, float, float]) -> api.PositionConstraint:
    activation = api.ActivationCurve(0.2, 0.5, 0.8, 1.1)
    point = api.BodyPoint(api.BodyPart.RIGHT_HAND)
    return api.PositionConstraint(motion, "Reach", point, api.Chain(), 0, activation, target=target)


def test_every_edit_is_one_undo_step_that_restores_the_project_exactly() -> None:
    scene, motion, body = _with_kick()
    before = scene.project
    edits = (
        lambda: scene.add_constraint(reach(motion, (0.3, 0.0, 1.0))),
        lambda: scene.add_contact(motion, "left_toe", 3, 9),
        lambda: scene.change("performers", body, position=(1.0, 2.0)),
        lambda: scene.remove("performers", body),
        lambda: scene.play(body, motion, motion),
    )
    for edit in edits:
        edit()
        assert scene.project != before
        scene.undo()
        assert scene.project == before


def test_edits_of_a_block_are_one_step_and_an_exception_takes_them_back() -> None:
    scene, motion, body = _with_kick()
    before = scene.project
    with scene.undo_step("Two edits"):
        scene.change("performers", body, position=(1.0, 0.0))
        scene.add_constraint(reach(motion, (0.3, 0.0, 1.0)))
    scene.undo()
    assert scene.project == before

    def fail() -> None:
        with scene.undo_step("One that fails"):
            scene.change("performers", body, position=(1.0, 0.0))
            scene.change("performers", "nobody", position=(1.0, 0.0))

    with pytest.raises(api.StudioError, match="'nobody'"):
        fail()
    assert scene.project == before


def test_a_placed_performer_is_measured_where_it_stands_on_the_stage() -> None:
    scene, _, body = _with_kick()
    wrist = api.BodyPoint(api.BodyPart.LEFT_HAND)
    at_origin = scene.adapt(body)[body].place_of(wrist)
    scene.change("performers", body, position=(2.0, -1.0), heading=np.pi / 2)
    x, y, z = at_origin.T
    np.testing.assert_allclose(scene.adapt(body)[body].place_of(wrist), np.stack([2.0 - y, -1.0 + x, z], 1), atol=1e-9)


def test_a_residual_is_the_distance_from_the_target_and_nan_outside_its_activation() -> None:
    scene, motion, body = _with_kick()
    constraint = reach(motion, (0.6, -0.2, 1.9))
    key = scene.add_constraint(constraint)
    adapted = scene.adapt(body)[body]
    frame = adapted.frame_at(0.65)
    distance = np.linalg.norm(adapted.place_of(constraint.point)[frame] - constraint.target)
    assert adapted.residuals[key][frame] == pytest.approx(distance, abs=1e-6)
    assert distance > 0.1
    assert np.isnan(adapted.residuals[key][0])


def test_what_is_saved_is_opened_again(tmp_path: Path) -> None:
    scene, motion, _ = _with_kick()
    scene.add_constraint(reach(motion, (0.3, 0.0, 1.0)))
    scene.save(tmp_path / "kick.studio")
    opened = api.open_scene(tmp_path / "kick.studio").project
    assert opened.constraints == scene.project.constraints
    assert opened.performers == scene.project.performers


@pytest.mark.parametrize(
    ("wrong", "sentence"),
    [
        (lambda scene: scene.add_capture("nowhere.bvh"), "nowhere.bvh"),
        (lambda scene: scene.add_character("nobody"), "No character is called 'nobody'"),
        (lambda scene: scene.add_performer("nobody"), "There is no character 'nobody'"),
        (lambda scene: scene.play("nobody", "nothing"), "There is no motion 'nothing'"),
        (lambda scene: scene.adapt("nobody"), "'nobody' is not a visible performer"),
        (lambda scene: scene.add_constraint(reach("nothing", (0.0, 0.0, 1.0))), "nothing"),
        (lambda scene: scene.render("nothing.png"), "nothing to draw"),
        (lambda scene: api.open_scene("no-such-scene"), "There is no project 'no-such-scene'"),
    ],
)
def test_what_cannot_be_is_refused_in_a_sentence(wrong, sentence) -> None:
    with pytest.raises(api.StudioError, match=re.escape(sentence)):
        wrong(api.new_scene())


def test_the_guide_names_every_call_and_the_interface_every_name() -> None:
    guide = (ROOT / "docs" / "scripts.md").read_text(encoding="utf-8")
    calls = [name for name, _ in inspect.getmembers(api.Scene) if not name.startswith("_")]
    assert [name for name in calls if f"scene.{name}" not in guide] == []
    assert {path.name for path in (ROOT / "examples" / "scripts").glob("*.py")} == set(
        re.findall(r"^- \[(\w+\.py)\]", guide, re.MULTILINE)
    )
    assert sorted(api.__all__) == sorted(
        name for name in vars(api) if not name.startswith("_") and name not in ("results", "scene")
    )


def test_a_corrected_pose_is_adapted_and_taken_back_by_undo() -> None:
    scene, _, body = _with_kick()
    before, plain = scene.project, scene.adapt(body)[body]
    key = scene.correct_pose(body, 0.5, {"left_forearm": (0.6, 0.0, 0.0)})
    posed = scene.adapt(body)[body]
    wrist = api.BodyPoint(api.BodyPart.LEFT_FOREARM, at_end=True)
    off = np.linalg.norm(posed.place_of(wrist) - plain.place_of(wrist), axis=1)
    times = plain.times
    assert off[np.abs(times - 0.5).argmin()] > 0.03
    assert not off[np.abs(times - 0.5) > 0.26].any()
    assert scene.correct_pose(body, 0.6, hips=(0.0, 0.0, -0.1)) == key
    assert len(scene.project.corrections[key].keys.times) == 2
    scene.undo()
    scene.undo()
    assert scene.project == before
    with pytest.raises(api.StudioError, match="left_forearm"):
        scene.correct_pose(body, 0.5, {"left elbow": (0.6, 0.0, 0.0)})


def test_kernels_of_a_script_that_python_runs_are_cached_by_the_content_of_their_sources(tmp_path: Path) -> None:
    """Numba by itself keeps an entry point as long as its own file is the same, whatever the kernels it calls."""
    environment = {key: value for key, value in os.environ.items() if key != "NUMBA_CACHE_DIR"}
    said = subprocess.run(
        [sys.executable, "-c", "import studio.api, numba; print(numba.config.CACHE_DIR)"],
        env=environment | {"XDG_CACHE_HOME": str(tmp_path)},
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    assert Path(said.stdout.strip()).is_relative_to(tmp_path)
