"""Time that a capture of 60 MB takes to open, stage by stage, and longest time without an answer of the window.

    python benchmarks/long_capture.py [CAPTURE.bvh] [--lengths]

The long file is made of a short one, played to and fro, in a temporary folder. Stages are measured one by one without
a window, then what an animator does with it in the window. With ``--lengths`` takes of 1 to 60 minutes at 120 Hz are
opened and adapted to five bodies instead, each in a process of its own: processor time, memory, and how well a straight
line fits the time.
"""

import argparse
import json
import os
import re
import resource
import subprocess
import sys
import tempfile
import time
import tracemalloc
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))
os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

from studio.startup.process import prepare_process  # noqa: E402

prepare_process()

import numpy as np  # noqa: E402

from benchmarks.growth import fitted  # noqa: E402
from benchmarks.listening import TICK, Silences, run_window  # noqa: E402
from benchmarks.machine import machine  # noqa: E402
from benchmarks.report import table  # noqa: E402
from studio.app import capture_import, exporting  # noqa: E402
from studio.app.application import freeze_loaded_objects, import_views, make_application, make_window, show_views  # noqa: E402
from studio.app.main_window import MainWindow  # noqa: E402
from studio.app.sample import empty_project  # noqa: E402
from studio.app.settings import Settings  # noqa: E402
from studio.core.body.canonical import BodyPart  # noqa: E402
from studio.core.captures.annotations import Annotations  # noqa: E402
from studio.core.captures.capture import Capture  # noqa: E402
from studio.core.constraints.base import BodyPoint, Chain, Constraint  # noqa: E402
from studio.core.constraints.own_place import OwnPlace  # noqa: E402
from studio.core.constraints.position import PositionConstraint  # noqa: E402
from studio.core.curves.activation import ActivationCurve  # noqa: E402
from studio.core.solver.request import AdaptRequest  # noqa: E402
from studio.document.document import Document  # noqa: E402
from studio.engine.live_adaptation import normalized_with_actor  # noqa: E402
from studio.engine.saving import save_in_background  # noqa: E402
from studio.engine.standing_solver import GroundingSolver  # noqa: E402
from studio.io.bvh.reader import read_bvh  # noqa: E402
from studio.io.importing import ImportOptions, known_of_motion, load_capture  # noqa: E402
from studio.io.project.character_file import bundled_characters  # noqa: E402
from studio.startup import first_run  # noqa: E402
from studio.timeline.curves import Quantity  # noqa: E402

BYTES = 60_000_000
LENGTHS, LENGTHS_RATE = (1, 4, 18, 60), 120
"""Minutes of the takes whose cost is compared, and their frames a second."""
PATIENCE = 120.0
LISTENED = 1500
"""Milliseconds after each deed in which the window is still listened to."""
LONG = 1000
"""Frames that no motion has but the long one."""


def long_file(source: Path, target: Path, count: int | None = None) -> int:
    """Write ``source`` to and fro for ``count`` frames, by default until it is 60 MB long; returns the frames."""
    head, _, rows = source.read_text().partition("MOTION")
    lines = rows.strip().splitlines()
    step, turns = lines[1], lines[2:] + lines[-2:2:-1]
    count = count or BYTES * len(turns) // (sum(map(len, turns)) + len(turns))
    with target.open("w") as file:
        file.write(f"{head}MOTION\nFrames: {count}\n{re.sub('^ +', '', step)}\n")
        file.writelines(f"{turns[frame % len(turns)]}\n" for frame in range(count))
    return count


def stages(path: Path) -> str:
    """Seconds of each stage by itself, by the clock and of all processors."""
    rows: list[list[str]] = []

    def timed(name: str, work: Callable[[], Any]) -> Any:
        start, computed = time.perf_counter(), time.process_time()
        result = work()
        rows.append([name, f"{time.perf_counter() - start:.2f}", f"{time.process_time() - computed:.2f}"])
        return result

    timed("the file's numbers", lambda: read_bvh(path))
    capture: Capture = timed("the capture, numbers included", lambda: load_capture(path))
    found: Annotations = timed("its contacts", lambda: known_of_motion(capture, Annotations(), ""))
    motion, actor = timed("normalised", lambda: normalized_with_actor(capture))
    solver, held = GroundingSolver(), []
    tracemalloc.start()
    for character in bundled_characters().values():
        request = AdaptRequest(motion, character.morphology, found.contacts or (), (one_moment(),), actor=actor)
        held.append(timed(f"adapted: {character.name}", lambda request=request: solver(request, 0, None)))
    kept = tracemalloc.get_traced_memory()[0] / len(held) / motion.frame_count
    tracemalloc.stop()
    return table(("stage", "seconds", "of one processor"), rows) + f"\nKept: {kept:.0f} bytes a frame and body.\n"


def one_moment() -> Constraint:
    """A constraint for a moment at the very beginning, so that a body's motion is not the standing one."""
    point = BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True)
    place, curve = OwnPlace(point, 0.0, (0.1, 0.0, 0.1)), ActivationCurve(0.0, 0.0, 0.5, 1.0)
    return PositionConstraint("", "wrist", point, Chain(), 0, curve, target=place)


def in_the_window(path: Path, folder: Path) -> str:
    """Steps of an animator with the file: seconds by the clock and of all processors, and the longest silence."""
    window = make_window(Settings(folder / "studio.ini"), Document(journal_folder=folder))
    window.resize(1400, 900)
    window.show()
    window.bench.document.new(empty_project())
    import_views()
    show_views(window)
    first_run.run()
    freeze_loaded_objects(window)
    run_window(2000)
    # The other bodies come while the first is there already: they are waited for at once.
    rows = [measured(*deed, LISTENED if index else 0) for index, deed in enumerate(deeds(window, path, folder))]
    window.close_without_saving()
    return table(("in the window", "seconds", "of one processor", "longest silence, ms", "at second"), rows)


def deeds(
    window: MainWindow, path: Path, folder: Path
) -> Iterator[tuple[str, Callable[[], object], Callable[[], bool]]]:
    """Steps one after the other: name, how each begins, and whether it is done."""
    bench = window.bench
    document, frames = bench.document, range(0, 100_000, 2_500)

    def bodies() -> int:
        results = [bench.live.result(key) for key in document.project.performers]
        return sum(result is not None and result.frame_count > LONG for result in results)

    def scrub() -> None:
        for frame in frames:
            document.playhead.set_frame(frame)
            run_window(TICK)

    def idle() -> bool:
        return not bench.runner.running and not bench.live._scheduler.busy

    yield "opened: the first body is there", lambda: capture_import.import_motion(bench, path), lambda: bodies() > 0
    yield "all five bodies are there", lambda: None, lambda: bodies() == len(document.project.performers)
    yield f"scrubbed to {len(frames)} places", scrub, idle
    document.playhead.set_frame(0)
    yield "played for 3 s", document.playhead.play, lambda: document.playhead.time > 3.0
    document.playhead.pause()
    tracks = bench.timeline.tracks
    for quantity in (Quantity.KNEE_SPEED, Quantity.SLIDE, Quantity.OFF_SUPPORT):
        choose = partial(tracks.set_quantity, quantity)
        yield f"plotted: {quantity.value.lower()}", choose, lambda: len(tracks.picture.plot.curves) == bodies()
    yield "import undone", document.undo_stack.undo, idle
    yield "import done again", document.undo_stack.redo, lambda: idle() and bodies() > 0
    yield "saved", lambda: save_in_background(document, bench.runner, folder / "long.studio"), idle
    chosen = exporting.chosen_performers(bench)[0]
    yield "one body exported as BVH", lambda: exporting.export(bench, {chosen: folder / "out.bvh"}), idle


def measured(name: str, work: Callable[[], object], done: Callable[[], bool], listened: int) -> list[str]:
    """One row; silences are listened to ``listened`` milliseconds longer."""
    silences, computed = Silences(), time.process_time()
    work()
    while not done() and time.perf_counter() < silences.begun + PATIENCE:
        run_window(5)
    seconds, computed = time.perf_counter() - silences.begun, time.process_time() - computed
    run_window(listened)
    silences.stop()
    silence, at = silences.longest
    return [name, f"{seconds:.2f}", f"{computed:.2f}", f"{1000.0 * silence:.0f}", f"{at:.1f}"]


def cost_of(source: Path, minutes: int) -> dict[str, float]:
    """Processor seconds to open a take of ``minutes`` and to adapt it to five bodies, and the peak of memory in MB."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "long.bvh"
        long_file(source, path, 60 * minutes * LENGTHS_RATE)
        first_run.run()
        known_of_motion(load_capture(source), Annotations(), "")
        begun = time.process_time()
        capture = load_capture(path, ImportOptions(frame_rate=LENGTHS_RATE))
        contacts = known_of_motion(capture, Annotations(), "").contacts or ()
        motion, actor = normalized_with_actor(capture)
        opened, solver = time.process_time(), GroundingSolver()
        held = [
            solver(AdaptRequest(motion, each.morphology, contacts, (one_moment(),), actor=actor), 0, None)
            for each in bundled_characters().values()
        ]
        adapted = time.process_time()
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return {"opened": opened - begun, f"adapted to {len(held)} bodies": adapted - opened, "peak": peak}


def lengths(source: Path) -> str:
    """Costs of takes of several lengths, and R squared of the straight lines through the times."""
    command = sys.executable, __file__, str(source), "--minutes"
    costs = [json.loads(subprocess.check_output((*command, str(each)))) for each in LENGTHS]
    rows = [
        [str(minutes), *(f"{value:.1f}" for value in cost.values())]
        for minutes, cost in zip(LENGTHS, costs, strict=True)
    ]
    times = [name for name in costs[0] if name != "peak"]
    fits = [fitted([*LENGTHS], np.array([[cost[name] for cost in costs]])).fit for name in times]
    rows.append(["R squared", *(f"{fit:.4f}" for fit in fits), ""])
    return table(("minutes", *(f"{name}, processor s" for name in times), "peak, MB"), rows)


def main() -> None:
    """Make the file, read it, work with it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("capture", nargs="?", type=Path, default=ROOT / "examples" / "captures" / "walk_turn.bvh")
    parser.add_argument("--lengths", action="store_true")
    parser.add_argument("--minutes", type=int, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    source: Path = arguments.capture
    if arguments.minutes:
        print(json.dumps(cost_of(source, arguments.minutes)))
        return
    if arguments.lengths:
        print(f"{machine()}; load {os.getloadavg()[0]:.1f}\n\n{lengths(source)}")
        return
    make_application()
    first_run.run()
    normalized_with_actor(load_capture(source))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "long.bvh"
        frames = long_file(source, path)
        print(f"{path.stat().st_size / 1e6:.0f} MB, {frames} frames; {machine()}; load {os.getloadavg()[0]:.1f}\n")
        print(stages(path))
        print(in_the_window(path, Path(folder)))


if __name__ == "__main__":
    main()
