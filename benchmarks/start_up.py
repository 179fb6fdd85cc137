"""Time until the kernels are there: compiled into an empty cache, and fetched from a full one."""

import json
import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass

from benchmarks.clips import ROOT

_COLD = """
import json, resource, time
start = time.perf_counter()
from studio.startup.kernel_warm_up import WarmUp
WarmUp().join()
by_the_clock = time.perf_counter() - start
used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
print(json.dumps([by_the_clock, sum(each.ru_utime + each.ru_stime for each in used)]))
"""
_WARM = """
import json, time
start = time.perf_counter()
from studio.startup import first_run
imported, spent = time.perf_counter(), time.process_time()
first_run.run()
print(json.dumps([time.perf_counter() - imported, time.process_time() - spent, imported - start]))
"""


@dataclass(frozen=True)
class StartUp:
    """Seconds for all that a moved slider or target will call, once, in a new process.

    Of an empty cache as the studio fills it, by two processes: by the clock, imports included, and processor time of
    both, which a busy machine does not spoil.
    """

    cold: float
    cold_by_the_clock: float
    warm: float
    warm_by_the_clock: float
    imports: float
    """Seconds by the clock for importing the packages before."""


def start_up() -> StartUp:
    """Run both in processes of their own, with a cache folder of their own."""
    with tempfile.TemporaryDirectory(prefix="morpho-studio-bench-") as folder:
        cold_by_the_clock, cold = _run(_COLD, folder)
        clock, warm, imports = min(_run(_WARM, folder) for _ in range(3))
    return StartUp(cold, cold_by_the_clock, warm, clock, imports)


def _run(script: str, cache: str) -> list[float]:
    environment = {**os.environ, "NUMBA_CACHE_DIR": cache, "PYTHONPATH": str(ROOT)}
    done = subprocess.run([sys.executable, "-c", script], env=environment, check=True, capture_output=True, text=True)
    seconds: list[float] = json.loads(done.stdout)
    return seconds
