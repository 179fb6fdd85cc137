"""Report of the monkey's rounds: faults, long turns of the event loop, memory."""

import faulthandler
import os
import threading
import time
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryFile

GAP = 1.0
"""Seconds that a turn of the event loop may take of this process's own making, on the machine of the limits."""
WORK, WORK_SECONDS = 2_000_000, 0.03
"""Numbers whose sum is a piece of work, and the seconds that it takes on the machine of the limits."""
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


@dataclass(frozen=True)
class Schedule:
    """Seconds for which a thread has run, and for which it could have run while others had the processor."""

    ran: float
    waited: float
    draws: bool
    """True for a thread of OpenGL in software, for which the window's waits."""


def schedules() -> dict[int, Schedule]:
    """Schedule of each thread of this process by its id; the window's has the id of the process."""
    found = {}
    for task in Path("/proc/self/task").iterdir():
        try:
            ran, waited, _ = (task / "schedstat").read_text().split()
            draws = (task / "comm").read_text().startswith("llvmpipe")
        except (OSError, ValueError):  # it has ended
            continue
        found[int(task.name)] = Schedule(int(ran) / 1e9, int(waited) / 1e9, draws)
    return found


def seconds_of_own(passed: float, before: Mapping[int, Schedule], now: Mapping[int, Schedule], window: int) -> float:
    """Seconds, of those that have passed, that the window was kept by this process and not by a busy machine.

    It was kept while its thread ran, and then one that draws for it; or while nothing of the process waited for a
    processor, since whoever waited may have been who the window waited for.
    """
    both = [(before[thread], each, thread == window) for thread, each in now.items() if thread in before]
    worked = sum(each.ran - earlier.ran for earlier, each, is_window in both if is_window)
    drew = max((each.ran - earlier.ran for earlier, each, _ in both if each.draws), default=0.0)
    waited = sum(each.waited - earlier.waited for earlier, each, _ in both)
    return max(worked + drew, passed - waited)


def slowness() -> float:
    """Times as long as on the machine of the limits, at least 1, that a piece of work takes on this one now."""
    begun = time.thread_time()
    sum(range(WORK))
    return max((time.thread_time() - begun) / WORK_SECONDS, 1.0)


def resident() -> int:
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


class Clock(threading.Thread):
    """Looks from another thread at how long a turn takes, and keeps the stack of one that takes too long."""

    def __init__(self) -> None:
        super().__init__(daemon=True)
        self.begun, self.stack = time.monotonic(), ""
        self.schedules = schedules()
        self.stopped = threading.Event()

    def turn(self) -> tuple[float, str]:
        """Seconds since the last turn that are this process's own making, and the stack of a long one."""
        now, later = time.monotonic(), schedules()
        took = seconds_of_own(now - self.begun, self.schedules, later, os.getpid())
        stack = f"within {now - self.begun:.2f} s by the clock\n{self.stack}"
        self.begun, self.schedules, self.stack = now, later, ""
        return took, stack

    def run(self) -> None:
        while not self.stopped.wait(0.05):
            if time.monotonic() - self.begun > 0.7 * GAP and not self.stack:
                with TemporaryFile("w+") as file:  # a frame that this thread held would let go of its things here
                    faulthandler.dump_traceback(file)
                    file.seek(0)
                    self.stack = file.read()
