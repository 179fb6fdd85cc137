"""The whole measurement in one run: ``make bench``, or ``python -m benchmarks.bench [--quick]``.

Writes what it found to ``docs/benchmark.json``, tables to ``docs/benchmark.md`` and into the marked places of
``docs/evidence.md``, the growth of the cost to ``docs/pictures/growth.svg``, and prints the tables.
"""

import json
import os
import statistics
import sys
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from benchmarks.charts import draw_growth
from benchmarks.clips import REAL, ROOT, load_clips
from benchmarks.growth import SHORT, with_characters, with_constraints
from benchmarks.machine import machine
from benchmarks.peers import PEERS, our_answer, run_peers
from benchmarks.quality import Quality, quality
from benchmarks.report import fill, tables
from benchmarks.stages import fight_live, played_live, with_performers
from benchmarks.start_up import start_up
from studio.cli.bench import frame_cases
from studio.cli.bench_cases import clip_of, make_tasks
from studio.cli.bench_timing import time_jobs
from studio.core.mesh.character import Character
from studio.core.solver.source import source_motion
from studio.io.project.character_file import bundled_characters
from studio.jobs.adaptation import ReadyCapture

DOCS = ROOT / "docs"
ROUNDS, QUICK_ROUNDS = 9, 3
JUDGED = "adult_woman", "child"
"""Characters on which the quality is judged; times are those of the first."""
FEW = 150
"""Frames on which many constraints are timed."""

Record = dict[str, Any]


def main(arguments: Sequence[str]) -> int:
    """Measure, write, print."""
    rounds = QUICK_ROUNDS if "--quick" in arguments else ROUNDS
    clips, characters = load_clips(), bundled_characters()
    body = characters[JUDGED[0]]
    say("times")
    times = {name: timed(clip, body, rounds) for name, clip in clips.items()}
    say("quality, with the numerical optimum")
    judged = [judge(clip, characters[name]) for clip in clips.values() for name in JUDGED]
    say("growth")
    most = max(clips, key=lambda name: clips[name].motion.frame_count)
    longest = clips[most]
    constraints = with_constraints(*clip_of(longest, FEW), body, QUICK_ROUNDS)
    crowd = with_characters(*clip_of(longest, SHORT), list(characters.values()))
    say("a stage of a thousand")
    stage, live = with_performers(), played_live()
    say("peers")
    tasks = make_tasks(*clip_of(longest), body.morphology)
    own = {case["name"]: case["median"] for case in times[most]}
    peers = {"Morpho Studio": {task.name: our_answer(task, own[task.name]) for task in tasks}, **run_peers(tasks)}
    say("start-up")
    record = {
        "machine": machine(),
        "clips": {name: clip_of(clip)[0].frame_count for name, clip in clips.items()},
        "captures": "real captures" if REAL.is_dir() else "the bundled examples",
        "rounds": rounds,
        "rows": rows(times, judged),
        "constraints": asdict(constraints),
        "characters": asdict(crowd),
        "stage": asdict(stage),
        "live": asdict(live),
        "fight": fight_live(),
        "peers": peers,
        "peer_notes": {peer.name: peer.note for peer in PEERS},
        "peer_clip": most,
        "start_up": asdict(start_up()),
        "load": os.getloadavg()[0],
    }
    (DOCS / "benchmark.json").write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    draw_growth(constraints, crowd, stage, live, DOCS / "pictures" / "growth.svg")
    fill(record, DOCS)
    print(tables(record))
    return 0


def say(what: str) -> None:
    """Say on standard error which step runs now."""
    print(f"... {what}", file=sys.stderr, flush=True)


def timed(clip: ReadyCapture, character: Character, rounds: int) -> list[Record]:
    """Times of everything that is done for each frame of one clip."""
    cases = frame_cases(clip, character)
    timings = time_jobs([case.job for case in cases], rounds)
    return [
        {"name": case.job.name, "paper": case.paper, "aim": case.aim, "median": timing.median, "best": timing.best}
        for case, timing in zip(cases, timings, strict=True)
    ]


def judge(clip: ReadyCapture, character: Character) -> dict[str, Quality]:
    """Quality of every task on one clip and one character."""
    motion, contacts = clip_of(clip)
    source = source_motion(motion, clip.actor)
    return {task.name: quality(task, source) for task in make_tasks(motion, contacts, character.morphology)}


def rows(times: dict[str, list[Record]], judged: Sequence[dict[str, Quality]]) -> list[Record]:
    """One row a job: the median over the clips of each clip's median, and the worst quality of all clips and bodies."""
    found = []
    for cases in zip(*times.values(), strict=True):
        row = {key: cases[0][key] for key in ("name", "paper", "aim")}
        row["median"] = statistics.median(case["median"] for case in cases)
        row["best"] = min(case["best"] for case in cases)
        row["clips"] = {name: case["median"] for name, case in zip(times, cases, strict=True)}
        row["quality"] = worst([each[row["name"]] for each in judged if row["name"] in each])
        found.append(row)
    return found


def worst(found: Sequence[Quality]) -> Record | None:
    """The worst of each figure; of the excess the median of medians and the largest."""
    if not found:
        return None
    excesses = [each.excess for each in found if each.excess is not None]

    def most(name: str) -> float | None:
        return max((value for each in found if (value := getattr(each, name)) is not None), default=None)

    return {
        **{name: most(name) for name in ("reachable", "slide", "balance", "acceleration", "segment_acceleration")},
        "excess": [statistics.median(e[0] for e in excesses), max(e[1] for e in excesses)] if excesses else None,
    }


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
