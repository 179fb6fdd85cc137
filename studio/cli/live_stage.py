"""``live --stage``: play a project's stage live without a window, with its behaviours, and report the results."""

import math
import time
from argparse import Namespace
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from studio.cli.printing import INTERRUPTED_EXIT_CODE, print_json, print_table
from studio.core.constraints.base import Constraint
from studio.core.curves.activation import LEAST_FULL_ACTIVATION
from studio.core.errors import StudioError
from studio.core.names import counted_noun
from studio.core.stage.project import Project
from studio.io.json_text import JsonObject
from studio.jobs.adapt_report import MET_DEGREES, MET_MILLIMETRES, residual_record
from studio.jobs.bundled_scenes import open_project
from studio.jobs.performances import prepared_capture
from studio.live.playing_stage import LiveStage
from studio.startup.kernel_warm_up import compile_first

LIVE_STAGE_STEP_SECONDS = 1.0 / 60.0


@dataclass
class ConstraintTally:
    """Counts of a constraint: steps in which it was fully active (``asked``) and met (``held``), and its worst
    residual.
    """

    constraint: Constraint
    asked: int = 0
    held: int = 0
    worst: float = 0.0

    def add(self, miss: float) -> None:
        """Count one step in which the constraint was fully active, with its residual ``miss`` (metres or radians)."""
        factor, met = (math.degrees(1.0), MET_DEGREES) if self.constraint.unit == "rad" else (1000.0, MET_MILLIMETRES)
        self.asked, self.held = self.asked + 1, self.held + (factor * miss <= met)
        self.worst = max(self.worst, miss)

    @property
    def record(self) -> JsonObject:
        """Record for the report."""
        counts = {"steps_asked": self.asked, "steps_held": self.held}
        reached = {"reached": self.held == self.asked}
        return {"name": self.constraint.name, **residual_record(self.constraint, self.worst), **counts, **reached}


@dataclass
class PerformerTally:
    """Results of one performer: steps, takeovers, steps in each state, and counts of its constraints."""

    name: str
    steps: int = 0
    takeovers: int = 0
    states: dict[str, int] = field(default_factory=dict)
    held: dict[str, ConstraintTally] = field(default_factory=dict)
    failure: str = ""

    @property
    def record(self) -> JsonObject:
        """Record for the report."""
        return {
            "name": self.name,
            "steps": self.steps,
            "takeovers": self.takeovers,
            "states": self.states,
            "constraints": [each.record for each in self.held.values()],
            "error": self.failure or None,
        }


def run_live_stage(arguments: Namespace) -> int:
    """Play and report; returns 1 if a performer failed, while the others play on."""
    project = open_project(arguments.stage)
    presses = sorted(arguments.press)
    compile_first()
    report = live_stage_report(project, arguments.seconds, presses)
    if arguments.json:
        print_json({"source": str(arguments.stage), **report})
    else:
        print_report(report)
    if report["stopped"]:
        return INTERRUPTED_EXIT_CODE
    return 0 if report["ok"] else 1


def live_stage_report(project: Project, seconds: float, presses: Iterable[tuple[float, str]] = ()) -> JsonObject:
    """Report of a stage played live for ``seconds`` of its own time, as fast as it can be solved.

    ``presses`` are pressed keys with their times. Ctrl-C ends it early, with the report of the steps until then.
    """
    stage, waiting = LiveStage(project, prepared_capture), list(presses)
    parts = {key: PerformerTally(each.name) for key, each in project.performers.items() if each.visible and each.clips}
    if not parts:
        raise StudioError("No visible character has a clip: there is nothing to play live.")
    stage.step(0.0)
    stage.record()
    spent: list[float] = []
    stopped = False
    try:
        for _ in range(max(round(seconds / LIVE_STAGE_STEP_SECONDS), 1)):
            while waiting and waiting[0][0] <= stage.seconds:
                stage.press(waiting.pop(0)[1])
            begun = time.thread_time()
            stage.step(LIVE_STAGE_STEP_SECONDS)
            spent.append(time.thread_time() - begun)
            _note(stage, parts)
    except KeyboardInterrupt:
        stopped = True
    take = stage.recorded()
    for key, begun_then in take.begun if take else ():
        parts[key].takeovers += not begun_then.own
    return {
        "ok": not any(each.failure for each in parts.values()),
        "steps": len(spent),
        "steps_a_second": len(spent) / max(sum(spent), 1e-9),
        "slowest_step_ms": 1000.0 * max(spent, default=0.0),
        "stopped": stopped,
        "performers": [each.record for each in parts.values()],
    }


def _note(stage: LiveStage, parts: dict[str, PerformerTally]) -> None:
    """Add one step to the results of all performers."""
    for key, part in parts.items():
        part.failure = stage.failures.get(key, part.failure)
        result = stage.results.get(key)
        if result is None:
            continue
        part.steps += 1
        if key in stage.running:
            state = stage.running[key].state
            part.states[state] = part.states.get(state, 0) + 1
        for (name, constraint, share), miss in zip(stage.active_constraints(key), result.residuals[:, 0], strict=True):
            if name and share >= LEAST_FULL_ACTIVATION and np.isfinite(miss):
                part.held.setdefault(name, ConstraintTally(constraint)).add(float(miss))


def print_report(report: JsonObject) -> None:
    """Print the speed, one line for each performer and each constraint, and the failures."""
    print(
        f"{counted_noun(report['steps'], 'step')}, {report['steps_a_second']:.0f} per second of CPU time, slowest"
        f" {report['slowest_step_ms']:.1f} ms\n"
    )
    performers = report["performers"]
    rows = [
        [each["name"], str(each["steps"]), str(each["takeovers"]), ", ".join(each["states"])] for each in performers
    ]
    print_table(("performer", "steps", "takeovers", "states"), rows)
    lines = [
        [asked["name"], each["name"], f"{asked['steps_held']} of {asked['steps_asked']}", _worst(asked)]
        for each in performers
        for asked in each["constraints"]
    ]
    if lines:
        print()
        print_table(("constraint", "character", "steps met", "worst error"), lines)
    for each in performers:
        if each["error"]:
            print(f"\n{each['name']} failed: {each['error']}")


def _worst(asked: JsonObject) -> str:
    if asked["residual_mm"] is None:
        return f"{asked['residual_deg']:.1f} deg"
    return f"{asked['residual_mm']:.1f} mm"
