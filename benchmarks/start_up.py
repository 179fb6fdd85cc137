"""How long the kernels take to be there: compiled into an empty cache, and fetched from a full one."""

import json
import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass

from benchmarks.clips import ROOT

_FIRST_CALL = """
import json, time
start = time.perf_counter()
from studio.engine import first_run
imported, spent = time.perf_counter(), time.process_time()
first_run.run()
print(json.dumps([time.perf_counter() - imported, time.process_time() - spent, imported - start]))
"""


@dataclass(frozen=True)
class StartUp:
    """Seconds for all that a moved slider or target will call, once, in a new process.

    Processor time for the compilation (a compiler works on one core, and a busy machine makes it wait); of a warm
    cache also what the clock showed.
    """

    cold: float
    warm: float
    warm_by_the_clock: float
    imports: float
    """Seconds by the clock for importing the packages before."""


def start_up() -> StartUp:
    """Run both in processes of their own, with a cache folder of their own."""
    with tempfile.TemporaryDirectory(prefix="morpho-studio-bench-") as folder:
        _, cold, _ = _first_call(folder)
        clock, warm, imports = min(_first_call(folder) for _ in range(3))
    return StartUp(cold, warm, clock, imports)


def _first_call(cache: str) -> list[float]:
    environment = {**os.environ, "NUMBA_CACHE_DIR": cache, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, "-c", _FIRST_CALL], env=environment, check=True, capture_output=True, text=True
    )
    seconds: list[float] = json.loads(done.stdout)
    return seconds
