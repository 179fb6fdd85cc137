"""Compile time of each kernel: ``python -m benchmarks.compile_costs``.

Processor seconds in one process with an empty cache: of each kernel's translation, for all types of arguments that it
is called with and without the kernels it calls, and of linking and optimising what Python calls.
"""

import os
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from importlib import import_module
from typing import Any

DEAREST = 20


class Costs:
    """Seconds and number of calls by step and kernel; what a call within a call takes is counted there alone."""

    def __init__(self) -> None:
        """Before anything is compiled."""
        self.seconds, self.calls = Counter[tuple[str, str]](), Counter[tuple[str, str]]()
        self._within = [0.0]

    def measured(self, step: str, function: Callable[..., Any]) -> Callable[..., Any]:
        """A method of a kernel's compiler that counts."""

        def run(compiler: Any, *arguments: Any) -> Any:
            begun, kernel = time.process_time(), (step, f"{compiler.py_func.__module__}.{compiler.py_func.__name__}")
            self._within.append(0.0)
            try:
                return function(compiler, *arguments)
            finally:
                spent = time.process_time() - begun
                self.seconds[kernel] += spent - self._within.pop()
                self.calls[kernel] += 1
                self._within[-1] += spent

        return run


def main() -> int:
    """Compile everything, and print the dearest kernels and the sums."""
    with tempfile.TemporaryDirectory(prefix="morpho-studio-bench-") as folder:
        os.environ["NUMBA_CACHE_DIR"] = folder
        costs, compiler = Costs(), import_module("studio.core.kernels.compiling.linked_kernels").PartCompiler
        compiler._make_part = costs.measured("translate", compiler._make_part)
        compiler._compile_core = costs.measured("link", compiler._compile_core)
        first_run = import_module("studio.startup.first_run")
        for part in (first_run.run_constraints, first_run.run_standing, first_run.run_rest, first_run.run):
            part()
    from benchmarks.report import table  # late: it imports numba, which reads the name of its cache once

    total = sum(costs.seconds.values())
    rows = [
        [kernel.removeprefix("studio.core.kernels."), step, str(costs.calls[step, kernel]), f"{spent:.2f}"]
        for (step, kernel), spent in costs.seconds.most_common(DEAREST)
    ]
    print(table(("kernel", "step", "times", "processor s"), rows))
    for step in ("translate", "link"):
        spent = sum(value for (each, _), value in costs.seconds.items() if each == step)
        count = sum(value for (each, _), value in costs.calls.items() if each == step)
        print(f"{step}: {count} times, {spent:.0f} s, {100 * spent / total:.0f} %")
    return 0


if __name__ == "__main__":
    sys.exit(main())
