"""How long a capture of 60 MB takes to open, and for how long the window is kept from answering meanwhile.

    python benchmarks/long_capture.py [CAPTURE.bvh]

The long file is made of a short one, played to and fro, in a temporary folder.
"""

import os
import re
import sys
import tempfile
import threading
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))
os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

from studio.cli.process import prepare_process  # noqa: E402

prepare_process()

from PySide6.QtCore import QTimer  # noqa: E402
from PySide6.QtTest import QTest  # noqa: E402

from studio.app import importing  # noqa: E402
from studio.app.application import import_views, make_application, make_window, settle, show_views  # noqa: E402
from studio.app.sample import empty_project  # noqa: E402
from studio.app.settings import Settings  # noqa: E402
from studio.document.document import Document  # noqa: E402
from studio.io.importing import load_capture  # noqa: E402

BYTES = 60_000_000
TICK = 2
PATIENCE = 120.0


def long_file(source: Path, target: Path) -> int:
    """Write ``source`` to and fro until it is 60 MB long; returns the frames."""
    head, _, rows = source.read_text().partition("MOTION")
    lines = rows.strip().splitlines()
    step, turns = lines[1], lines[2:] + lines[-2:2:-1]
    count = BYTES * len(turns) // (sum(map(len, turns)) + len(turns))
    text = "\n".join(turns[frame % len(turns)] for frame in range(count))
    target.write_text(f"{head}MOTION\nFrames: {count}\n{re.sub('^ +', '', step)}\n{text}\n")
    return count


class Gaps:
    """The longest times for which the window did not answer, and what its thread computed in them.

    On a busy machine a silence is longer than what is computed in it.
    """

    def __init__(self) -> None:
        self._timer = QTimer(interval=TICK)
        self._timer.timeout.connect(self._tick)
        self._last = self.begun = time.perf_counter()
        self._computed = time.thread_time()
        self.gaps: list[tuple[float, float, float]] = []
        self._timer.start()

    def _tick(self) -> None:
        now, computed = time.perf_counter(), time.thread_time()
        self.gaps.append((1000.0 * (now - self._last), 1000.0 * (computed - self._computed), self._last - self.begun))
        self._last, self._computed = now, computed

    def worst(self, count: int = 6) -> str:
        """``52 ms (31 computed) at 1.2 s``, the longest first."""
        longest = sorted(self.gaps, reverse=True)[:count]
        return ", ".join(f"{gap:.0f} ms ({computed:.0f} computed) at {at:.2f} s" for gap, computed, at in longest)


def read_alone(path: Path) -> None:
    """Seconds to read it, with what the thread computes."""
    reports: list[float] = []
    start, computed = time.perf_counter(), time.process_time()
    load_capture(path, progress=lambda share, _text: reports.append(share))
    seconds, computed = time.perf_counter() - start, time.process_time() - computed
    print(f"read: {seconds:.2f} s ({computed:.2f} s of one core), {len(reports)} reports of progress")


def read_in_window(path: Path, folder: Path) -> None:
    """Seconds until the motion is in the project, and the longest silences of the window."""
    application = make_application()
    window = make_window(Settings(folder / "studio.ini"), Document())
    window.resize(1400, 900)
    window.show()
    window.bench.document.new(empty_project())
    import_views()
    show_views(window)
    settle()
    QTest.qWait(2000)
    gaps = Gaps()
    captures = len(window.bench.document.project.captures)
    importing.import_motion(window.bench, path)
    while len(window.bench.document.project.captures) == captures and time.perf_counter() < gaps.begun + PATIENCE:
        application.processEvents()
    shown = time.perf_counter() - gaps.begun
    QTest.qWait(4000)
    print(f"in the window: {shown:.2f} s until it is there; the longest silences: {gaps.worst()}")
    window.leave()


def main() -> None:
    """Make the file, read it, open it."""
    source = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "examples" / "captures" / "walk_turn.bvh"
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "long.bvh"
        frames = long_file(source, path)
        print(f"{path.stat().st_size / 1e6:.0f} MB, {frames} frames, threads {threading.active_count()}")
        load_capture(source)
        read_alone(path)
        read_in_window(path, Path(folder))


if __name__ == "__main__":
    main()
