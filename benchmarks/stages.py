"""Growth of the cost of a stage with its performers: rows of clips with constraints, on one core."""

import time
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from benchmarks.growth import CHARACTERS, Growth, fitted
from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology
from studio.core.captures.capture import Capture
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.own_place import OwnPlace
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.mesh.character import Character
from studio.core.normalized.motion import NormalizedMotion
from studio.core.solver.adapt import adapt
from studio.core.solver.performers.rows import timing_of
from studio.core.solver.performers.staged_performances import PrepareCapture, adapt_performers
from studio.core.stage.clip import Clip
from studio.core.stage.project import Performer, Project
from studio.jobs.performances import prepared_capture
from studio.library.scenes.fight import fight_training
from studio.library.scenes.stagehand import BUNDLED_FRAME_RATE, source_motions, varied_characters
from studio.live.playing_stage import LiveStage

ROW = Clip("walk", 100, 160, 0.0, "before"), Clip("walk", 300, 370, 0.8, "after", mirrored=True)
"""Two clips that blend; a row of two seconds."""
STEPS, FIGHT_STEPS, KICK = 20, 600, 180
"""Steps of a stage of which the least counts, of the fight, and after how many of these they kick."""
WRISTS = tuple(BodyPoint(BodyPart(f"{side}_forearm"), at_end=True) for side in ("left", "right"))


def with_performers() -> Growth:
    """Microseconds for one frame of a stage of 1 to 1,000 performers, bodies in turn."""
    stage = prepared_stage(varied_characters(5))
    costs = []
    for count in (1, *CHARACTERS):  # the first one loads what all need
        keys = list(stage.performers)[:count]
        start = time.process_time()
        made = adapt_performers(stage, keys, prepared_capture, adapt)
        spent = time.process_time() - start
        assert not made.failures
        costs.append(1e6 * spent / (timing_of(stage, stage.performers[keys[0]]).last + 1))
    return fitted(list(CHARACTERS), np.array([costs[1:]]))


def played_live() -> Growth:
    """The same of one step of a stage that plays live, solver in the loop, the least of a few steps."""
    stage = prepared_stage(varied_characters(5))
    costs = []
    for count in (1, *CHARACTERS):
        keys = list(stage.performers)[:count]
        live = LiveStage(replace(stage, performers={key: stage.performers[key] for key in keys}), kept())
        live.step(0.0)
        costs.append(1e6 * min(_step(live) for _ in range(STEPS)))
    return fitted(list(CHARACTERS), np.array([costs[1:]]))


def fight_live() -> tuple[float, float, float]:
    """Milliseconds of a step of the fight training, median, 95 of 100 and most, where all in white kick at times."""
    live = LiveStage(fight_training(), kept(), 1.0)
    live.step(0.0)
    spent = []
    for step in range(FIGHT_STEPS):
        if step % KICK == 0:
            live.press("X")
        spent.append(1e3 * _step(live))
    median, most_often, most = np.percentile(spent, [50, 95, 100]).tolist()
    return median, most_often, most


def _step(live: LiveStage) -> float:
    start = time.process_time()
    live.step(1.0 / BUNDLED_FRAME_RATE)
    return time.process_time() - start


def kept() -> PrepareCapture:
    """Motions of captures, each found once."""
    known: dict[int, tuple[Capture, tuple[NormalizedMotion, Morphology]]] = {}

    def prepare(capture: Capture) -> tuple[NormalizedMotion, Morphology]:
        if id(capture) not in known:
            known[id(capture)] = capture, prepared_capture(capture)
        return known[id(capture)][1]

    return prepare


def prepared_stage(characters: Mapping[str, Character]) -> Project:
    """As many performers as are measured at most, who play one row of two clips and lift both hands in it."""
    stuff = source_motions(walk=("Walk and turn", "walk_turn"))
    names = list(characters)
    performers = {
        f"performer {number}": Performer(f"Performer {number}", names[number % len(names)], ROW, (1.2 * number, 0.0))
        for number in range(CHARACTERS[-1])
    }
    constraints = {
        f"wish {index}": PositionConstraint(
            "walk", f"Hand {index}", wrist, Chain(trunk=0.3), 0, ActivationCurve(2.0, 2.3, 6.0, 6.2),
            target=OwnPlace(wrist, 2.2, (0.1, 0.0, 0.15)),
        )
        for index, wrist in enumerate(WRISTS)
    }  # fmt: skip
    return Project(stuff.captures, stuff.motions, characters, performers, constraints, stuff.contacts)


def beyond_linear(stage: Growth) -> float:
    """Ratio of the cost of one of the most to that of one of ten."""
    each = [cost / count for cost, count in zip(stage.costs, stage.counts, strict=True)]
    return each[-1] / each[stage.counts.index(10)]
