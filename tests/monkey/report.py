"""Report of the monkey's rounds: faults, long turns of the event loop, memory."""

import faulthandler
import os
import threading
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryFile

GAP = 1.0
"""Seconds that a turn of the event loop may take of this process's own making."""
SETTLED = 10
"""Rounds after which memory is to be flat."""
GROWTH = 50e6
"""Bytes that the middle of the last rounds may lie above that of the first ones after ``SETTLED``."""


@dataclass
class Report:
    """Findings; ``faults`` are tracebacks and sentences, each with the event at which it came."""

    events: int = 0
    faults: list[str] = field(default_factory=list)
    gaps: list[str] = field(default_factory=list)
    memory: list[int] = field(default_factory=list)
    """Bytes of the process after each round."""
    kinds: Counter[str] = field(default_factory=Counter)
    windows: Counter[str] = field(default_factory=Counter)
    """Events by what was done, and by what stood in front then."""

    @property
    def growth(self) -> float:
        """Bytes by which the process has grown since it was settled; 0 while there are too few rounds."""
        flat = self.memory[SETTLED:]
        part = len(flat) // 3
        return sum(flat[-part:]) / part - sum(flat[:part]) / part if part else 0.0

    @property
    def right(self) -> bool:
        return not self.faults and not self.gaps and self.growth < GROWTH


def waits() -> dict[str, float]:
    """Seconds in which the window's thread, and those that draw for it, could have run and were not let by others."""
    return {task.name: _waited(task) for task in Path("/proc/self/task").iterdir() if _draws(task)}


def _waited(task: Path) -> float:
    try:
        return int((task / "schedstat").read_text().split()[1]) / 1e9
    except (OSError, IndexError, ValueError):  # it has ended
        return 0.0


def _draws(task: Path) -> bool:
    """True if a thread is the window's, or one of OpenGL in software."""
    try:
        return task.name == str(os.getpid()) or (task / "comm").read_text().startswith("llvmpipe")
    except OSError:
        return False


def resident() -> int:
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


class Clock(threading.Thread):
    """Looks from another thread at how long a turn takes, and keeps the stack of one that takes too long."""

    def __init__(self) -> None:
        super().__init__(daemon=True)
        self.main = threading.get_ident()
        self.begun, self.worked, self.stack = time.monotonic(), time.thread_time(), ""
        self.waited: dict[str, float] = {}
        self.stopped = threading.Event()

    def turn(self) -> tuple[float, str]:
        """Seconds since the last turn without those for which others had the processor, and the stack of a long one."""
        now, waited, worked = time.monotonic(), waits(), time.thread_time()
        longer = {thread: waited[thread] - before for thread, before in self.waited.items() if thread in waited}
        window = longer.pop(str(os.getpid()), 0.0)
        took = now - self.begun - window - max(longer.values(), default=0.0)
        stack = f"of which {worked - self.worked:.2f} s of the processor\n{self.stack}"
        self.begun, self.worked, self.waited, self.stack = now, worked, waited, ""
        return took, stack

    def run(self) -> None:
        while not self.stopped.wait(0.05):
            if time.monotonic() - self.begun > 0.7 * GAP and not self.stack:
                with TemporaryFile("w+") as file:  # a frame that this thread held would let go of its things here
                    faulthandler.dump_traceback(file)
                    file.seek(0)
                    self.stack = file.read()
