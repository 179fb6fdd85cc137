"""``live --stage``: a project's stage plays live without a window, and what became of it is counted."""

import json
from dataclasses import replace

from studio.cli.live_stage import live_stage_report
from studio.cli.main import main
from studio.core.stage.behaviour import Transition
from studio.core.stage.conditions import ClipEndCondition, EventCondition, KeyCondition, TimeCondition
from studio.io.project.project_file import write_project
from studio.live.playing_stage import LiveStage
from tests.live.test_live_stage import GUARD, KICK, STEP_BACK, of_two, reaching


def fighting():
    ways = (
        Transition("guard", "back", (EventCondition("attack"),)),
        Transition("guard", "kick", (KeyCondition("K"),)),
        Transition("kick", "guard", (ClipEndCondition(),)),
        Transition("back", "guard", (TimeCondition(0.5),)),
    )
    return of_two((GUARD, KICK, STEP_BACK), ways).project


def test_a_stage_plays_for_so_many_seconds_and_tells_of_steps_states_and_takeovers():
    report = live_stage_report(fighting(), 2.0, [(0.4, "K")])
    assert report["ok"]
    assert report["steps"] == 120
    assert report["steps_a_second"] > 0.0
    for each in report["performers"]:
        assert each["steps"] == 120
        assert set(each["states"]) == {"guard", "kick"}
        assert sum(each["states"].values()) == 120
        assert each["takeovers"] >= 2


def test_what_is_asked_is_counted_where_it_is_asked_wholly_and_where_it_is_met():
    asked = {"near": reaching("straight_punch", (0.4, -0.2, 1.1)), "far": reaching("straight_punch", (4.0, 0.0, 1.1))}
    project = replace(fighting(), constraints=asked)
    near, far = live_stage_report(project, 0.4)["performers"][0]["constraints"]
    assert near["steps_asked"] == far["steps_asked"]
    assert near["reached"] != far["reached"]


def test_who_fails_is_told_and_the_rest_plays_on(tmp_path, capsys):
    project = fighting()
    broken = replace(project.captures["straight_punch"], body_map=None)
    lonely = replace(project.performers["two"], clips=(replace(GUARD.clip, motion_id="reach_grasp"),))
    project = project.with_entity("captures", "straight_punch", broken).with_entity("performers", "two", lonely)
    project = replace(project, behaviours={})
    path = tmp_path / "fight.studio"
    write_project(path, project, "fight")
    assert main(["live", "--stage", str(path), "--seconds", "0.2", "--json"]) == 1
    one, two = json.loads(capsys.readouterr().out)["performers"]
    assert one["error"]
    assert not two["error"]
    assert two["steps"] == 12


def test_ctrl_c_ends_a_stage_with_the_report_of_the_steps_until_then(tmp_path, capsys, monkeypatch):
    path = tmp_path / "fight.studio"
    write_project(path, fighting(), "fight")
    step, steps = LiveStage.step, []

    def step_until_stopped(stage, seconds):
        steps.append(seconds)
        if len(steps) == 12:
            raise KeyboardInterrupt
        return step(stage, seconds)

    monkeypatch.setattr(LiveStage, "step", step_until_stopped)
    assert main(["live", "--stage", str(path), "--seconds", "60", "--json"]) == 130
    report = json.loads(capsys.readouterr().out)
    assert report["stopped"]
    assert report["steps"] == 10
    assert [each["steps"] for each in report["performers"]] == [10, 10]
