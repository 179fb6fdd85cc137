"""``bench``: measure the times of the studio's jobs on this machine, beside the paper's figures and our aims."""

import sys
from argparse import Namespace
from dataclasses import dataclass
from pathlib import Path

from studio.cli.bench_cases import clip_of, make_tasks
from studio.cli.bench_timing import BenchJob, JobTiming, time_jobs
from studio.cli.printing import print_json, print_table
from studio.core.body.kinematics import joint_world
from studio.core.errors import StudioError
from studio.core.mesh.character import Character
from studio.core.mesh.skin import skin_vertices
from studio.core.normalized.normalize import normalize_capture
from studio.core.normalized.realize import realize_motion
from studio.core.rigs.character_skeleton import character_poses, character_skeleton
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptRequest
from studio.io.importing import GUESS_ALL, load_capture
from studio.io.json_text import JsonObject
from studio.jobs.adaptation import ReadyCapture, chosen_characters, ready_capture
from studio.resources_folder import example_captures_folder

BENCH_EXAMPLE_FILE = "reach_grasp.bvh"


@dataclass(frozen=True, eq=False)
class Case:
    """Timed job, with the microseconds that the paper took for one unit of it, and our aim."""

    job: BenchJob
    paper: float | None = None
    aim: float | None = None


def run(arguments: Namespace) -> int:
    """Measure every case in processor time, and print the results."""
    path = arguments.capture or bundled_capture()
    [character] = chosen_characters([arguments.character]).values()
    print(f"Measuring on {path.name}; the first run compiles, which may take a minute.", file=sys.stderr)
    cases = [*frame_cases(ready := ready_capture(path, GUESS_ALL), character), *file_cases(path, ready, character)]
    timings = time_jobs([case.job for case in cases], arguments.runs)
    records = [_record(case, timing) for case, timing in zip(cases, timings, strict=True)]
    if arguments.json:
        print_json(records)
        return 0
    print(f"Processor time, median of {arguments.runs} runs; {path.name} on {character.name}, conversion included.\n")
    print_table(("job", "microseconds", "best", "paper", "aim", "time / aim"), [_row(record) for record in records])
    return 0


def bundled_capture() -> Path:
    """Path of the example to measure on: a body that stands and reaches, or the first one there is."""
    files = sorted(
        example_captures_folder().glob("*.bvh"), key=lambda file: (file.name != BENCH_EXAMPLE_FILE, file.name)
    )
    if not files:
        raise StudioError("No example capture is bundled. Name one: `bench CAPTURE`.")
    return files[0]


def frame_cases(ready: ReadyCapture, character: Character) -> list[Case]:
    """Cases that run for every frame of a clip: whole clips with conversion, and forward kinematics as a
    lower bound.
    """
    motion, contacts = clip_of(ready)
    body, count = character.morphology, motion.frame_count
    standing = AdaptRequest(motion, body, contacts)
    skeleton, poses = character_skeleton(body), character_poses(adapt(standing))
    return [
        Case(BenchJob("forward kinematics alone", lambda: joint_world(skeleton, poses), count)),
        Case(BenchJob("retarget a posture", lambda: realize_motion(motion, body), count), 21.0, 0.5),
        Case(BenchJob("retarget, feet held on the ground", lambda: adapt(standing), count)),
        *(
            Case(BenchJob(task.name, lambda task=task: adapt(task.request), count), task.paper, task.aim)  # type: ignore[misc]
            for task in make_tasks(motion, contacts, body)
        ),
    ]


def file_cases(path: Path, ready: ReadyCapture, character: Character) -> list[Case]:
    """Cases that run occasionally: skin, import and normalisation."""
    body = character.morphology
    adapted = adapt(AdaptRequest(ready.motion, body, ready.contacts))
    pose = adapted.positions[0].copy(), adapted.rotations[0].copy()
    return [
        Case(BenchJob("skin of one character", lambda: skin_vertices(character.skin, character.build, body, *pose))),
        Case(BenchJob(f"import of {path.name}", lambda: load_capture(path))),
        Case(BenchJob(f"normalise {path.name}", lambda: normalize_capture(ready.capture))),
    ]


def _record(case: Case, timing: JobTiming) -> JsonObject:
    return {
        "name": case.job.name,
        "microseconds": timing.median,
        "best": timing.best,
        "paper": case.paper,
        "aim": case.aim,
        "ratio": None if case.aim is None else timing.median / case.aim,
    }


def _row(record: JsonObject) -> list[str]:
    return [
        record["name"],
        *(f"{record[key]:,.2f}" for key in ("microseconds", "best")),
        *("-" if record[key] is None else f"{record[key]:.1f}" for key in ("paper", "aim", "ratio")),
    ]
