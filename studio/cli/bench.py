"""``bench``: how long the studio's jobs take on this machine, beside the paper's figures and our aims."""

import statistics
import sys
import time
from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import Any

from studio.cli.adaptation import chosen_characters, ready_capture
from studio.cli.bench_cases import FRAMES, Case, make_cases
from studio.cli.printing import print_json, print_table
from studio.core.errors import StudioError
from studio.io.importing import GUESS_ALL
from studio.resources_folder import example_captures_folder

Record = dict[str, Any]

USUAL = "reach_grasp.bvh"
ROUND = 0.02
"""Seconds of work at least between two looks at the clock."""


def add_arguments(parser: ArgumentParser) -> None:
    """On what, how often."""
    parser.add_argument(
        "capture",
        nargs="?",
        type=Path,
        help="a human motion that stays in place, as the targets do; a bundled one by default",
    )
    parser.add_argument("--character", default="adult_woman", metavar="NAME|FILE", help="adult_woman by default")
    parser.add_argument("--runs", type=int, default=9, metavar="N", help="runs of which the median counts; 9")
    parser.add_argument(
        "--json",
        action="store_true",
        help="a list of {name, microseconds, reference, ratio}; below 1 is faster than the reference",
    )


def run(arguments: Namespace) -> int:
    """Measure every case on one core, and print."""
    if arguments.runs < 1:
        raise StudioError("--runs needs one run at least.")
    path = arguments.capture or bundled_capture()
    [character] = chosen_characters([arguments.character]).values()
    print(f"Measuring on {path.name}; the first run compiles, which may take a minute.", file=sys.stderr)
    cases = make_cases(path, ready_capture(path, GUESS_ALL), character)
    records = [measured(case, arguments.runs) for case in cases]
    if arguments.json:
        print_json(records)
        return 0
    print(f"Median of {arguments.runs} runs on one core; clips of {FRAMES:,} frames on {character.name}.\n")
    titles = ("job", "microseconds", "whole clip", "reference", "ratio", "reference is")
    print_table(titles, [_row(record) for record in records])
    return 0


def bundled_capture() -> Path:
    """The example to measure on: a body that stands and reaches, or whichever there is."""
    files = sorted(example_captures_folder().glob("*.bvh"), key=lambda file: (file.name != USUAL, file.name))
    if not files:
        raise StudioError("No example capture is bundled. Name one: `bench CAPTURE`.")
    return files[0]


def measured(case: Case, runs: int) -> Record:
    """Microseconds for one of what the case does; the first call, which compiles, does not count."""
    case.work()
    start = time.perf_counter()
    case.work()
    repeats = max(1, round(ROUND / max(time.perf_counter() - start, 1e-7)))
    times = [seconds(case, repeats) for _ in range(runs)]
    microseconds = 1e6 * statistics.median(times) / case.count
    return {
        "name": case.name,
        "microseconds": microseconds,
        "reference": case.reference,
        "ratio": None if case.reference is None else microseconds / case.reference,
        "best": 1e6 * min(times) / case.count,
        "clip_milliseconds": 1e3 * statistics.median(times) if case.count > 1 else None,
        "reference_is": case.reference_is or None,
    }


def seconds(case: Case, repeats: int) -> float:
    """Seconds for one call of the case's work, the mean over ``repeats``."""
    start = time.perf_counter()
    for _ in range(repeats):
        case.work()
    return (time.perf_counter() - start) / repeats


def _row(record: Record) -> list[str]:
    clip, reference = record["clip_milliseconds"], record["reference"]
    return [
        record["name"],
        f"{record['microseconds']:,.2f}",
        "-" if clip is None else f"{clip:.2f} ms",
        "-" if reference is None else f"{reference:.1f}",
        "-" if reference is None else f"{record['ratio']:.2f}",
        record["reference_is"] or "",
    ]
