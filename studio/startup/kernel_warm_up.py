"""Compilation of kernels, or loading from their cache, in the background while the window opens.

They are compiled once on each machine, by child processes, ``python -m studio.startup.kernel_warm_up MODULE.FUNCTION
...``, which report their function and progress. Drawing a body comes first; then grounding bodies, and in another
process the solver of constraints, which takes longest.
"""

import gc
import os
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import ExitStack, contextmanager, suppress
from importlib import import_module
from pathlib import Path
from subprocess import PIPE, Popen
from typing import TYPE_CHECKING

from studio.io.child_process import child_process
from studio.startup.process import COLLECTION_THRESHOLDS, KERNELS_FOLDER
from studio.startup.progress import progress_line

if TYPE_CHECKING:
    from studio.startup.compile_work import CompileWork

CHILDREN_POLL_SECONDS, PROGRESS_LINE_SECONDS = 0.1, 0.5
"""Seconds between two polls of the child processes, and between two progress lines that they write."""
LONGEST_HELD_SECONDS = 10.0
"""Seconds after which the kernels are loaded although the warm-up is still held."""
PICTURE_FUNCTIONS = ("first_picture.run",)
"""Functions of this package that compile the kernels for drawing a body."""
WARM_STANDING, WARM_REST, WARM_CONSTRAINTS = "first_run.run_standing", "first_run.run_rest", "first_run.run_constraints"
WARM_UPS_BY_PROCESS = ((WARM_STANDING, WARM_REST), (WARM_CONSTRAINTS,))
"""Functions of this package that each child process runs in turn."""
COMPILED_FRACTION = 0.98
"""Progress (0 to 1) at which all kernels are compiled; the rest is loading them from their cache."""
CHILD_COMMAND = (sys.executable, "-m", "studio.startup.kernel_warm_up")
"""Command that starts a child process, without its functions."""
COMPLETE_MARK_FILE, READING_KERNEL_PATTERN = "complete", "encode_channels.encode_frames-*.nbc"
"""Name of the file that marks a complete cache, and pattern of a kernel that is cached once a capture has been read."""


class WarmUp:
    """Warm-up of the kernels on a thread that starts at once.

    A caller that needs some kernels sooner waits for those only. The warm-up must be stopped before the process ends.
    """

    def __init__(self, held: bool = False) -> None:
        """Start the thread. While it is ``held``, this process loads no kernels, but child processes compile them."""
        self.cold = is_cold()
        """True if kernels had to be compiled when the warm-up began."""
        self._stopped, self._ready, self._grounded = threading.Event(), threading.Event(), threading.Event()
        self._let_go, self._drawable = threading.Event(), threading.Event()
        if not held:
            self.release()
        self._shares = dict.fromkeys(WARM_UPS_BY_PROCESS, 0.0)
        self._running = {part: part[0] for part in WARM_UPS_BY_PROCESS}
        """The function that each process runs now."""
        # Imported on the thread: numba alone takes a third of a second, which the window need not wait for.
        self._thread = threading.Thread(target=self._run, name="warm-up", daemon=True)
        self._thread.start()

    @property
    def running(self) -> bool:
        """True until the warm-up has finished or was stopped."""
        return self._thread.is_alive()

    @property
    def grounded(self) -> bool:
        """True once the kernels of grounding are loaded."""
        return self._grounded.is_set()

    @property
    def ready(self) -> bool:
        """True once the kernels that every scene needs are loaded."""
        return self._ready.is_set()

    def join(self) -> None:
        """Wait until the kernels of every scene are loaded. Raises CancelledError if the warm-up was stopped."""
        self._wait_for(self._ready)

    def join_grounded(self) -> None:
        """Wait until bodies can be grounded. Raises CancelledError if the warm-up was stopped."""
        self._wait_for(self._grounded)

    def join_picture(self) -> None:
        """Wait until bodies can be drawn without compiling, or the warm-up has ended."""
        self._drawable.wait()

    def release(self) -> None:
        """Let this process load the kernels if it was held."""
        self._let_go.set()

    def stop(self, patience: float | None = None) -> None:
        """Stop the thread and the child processes; wait ``patience`` seconds for a kernel that this process
        compiles.
        """
        self._stopped.set()
        self._end_waiting()
        self.release()
        self._thread.join(patience)

    def follow(self, report: Callable[[float, str], None]) -> None:
        """Report progress until the work is done; runs as a job of ``TaskRunner``."""
        while self.running:
            report(self.fraction, self.words)
            time.sleep(CHILDREN_POLL_SECONDS)

    @property
    def fraction(self) -> float:
        """Progress from 0 to 1 of the process that is farthest from its end."""
        return COMPILED_FRACTION * min(self._shares.values()) if self.cold else 0.5 * self.grounded

    @property
    def words(self) -> str:
        """Text shown beside the progress; empty if everything was compiled before."""
        return "once on this machine" if self.cold else ""

    def _wait_for(self, event: threading.Event) -> None:
        event.wait()
        if self._stopped.is_set():
            raise CancelledError

    def _end_waiting(self) -> None:
        for event in (self._drawable, self._grounded, self._ready):
            event.set()

    def _run(self) -> None:
        try:
            if self.cold:
                with self._processes(PICTURE_FUNCTIONS) as running:
                    self._wait_while(running, lambda: True)
            self._drawable.set()
            if self.cold:
                with self._processes(*WARM_UPS_BY_PROCESS) as running:
                    first = WARM_UPS_BY_PROCESS[0]
                    self._wait_while(running, lambda: first in running and self._running[first] == WARM_STANDING)
                    self._fetch(WARM_STANDING, self._grounded)
                    self._wait_while(running, lambda: True)
            self._fetch(WARM_STANDING, self._grounded)  # what a process failed in fails here again, and is told
            self._fetch("first_run.run", self._ready)
        finally:
            self._end_waiting()
        self._fetch(WARM_REST)
        if not self._stopped.is_set() and (folder := os.environ.get("NUMBA_CACHE_DIR")):
            Path(folder, COMPLETE_MARK_FILE).touch()

    def _fetch(self, function: str, event: threading.Event | None = None) -> None:
        """Run a function in this process, once, and then set ``event``."""
        self._let_go.wait(LONGEST_HELD_SECONDS)
        if not self._stopped.is_set() and not (event and event.is_set()):
            run(function)
            if event is not None:
                event.set()

    @contextmanager
    def _processes(self, *parts: Sequence[str]) -> Iterator[dict[Sequence[str], "Popen[bytes]"]]:
        """Context with child processes that compile, by their functions.

        They have the priority of this process, which waits for them, so that they get half of two processors that
        others keep busy.
        """
        with ExitStack() as stack:
            running = {
                part: stack.enter_context(child_process((*CHILD_COMMAND, *part), stdout=PIPE, behind=0))
                for part in parts
            }
            for part, child in running.items():
                threading.Thread(target=self._listen, args=(part, child.stdout), daemon=True).start()
            yield running

    def _wait_while(self, running: dict[Sequence[str], "Popen[bytes]"], goes_on: Callable[[], bool]) -> None:
        """Wait while processes run and ``goes_on`` returns True; remove those that have ended from ``running``."""
        while running and goes_on() and not self._stopped.wait(CHILDREN_POLL_SECONDS):
            for part, child in [*running.items()]:
                if child.poll() is not None:
                    del running[part]
                    self._shares |= {part: 1.0} if part in self._shares else {}

    def _listen(self, part: Sequence[str], lines: Iterable[bytes]) -> None:
        with suppress(ValueError):  # of a process that is ended the last line is cut, or its stream closed
            for line in lines:
                function, share = line.decode().split()
                if part in self._shares:
                    self._running[part], self._shares[part] = function, max(float(share), self._shares[part])


def compile_first() -> None:
    """Compile all kernels if there are none yet; the reason and the progress are printed on standard error."""
    if not is_cold():
        return
    tell, warming = progress_line(), WarmUp()
    try:
        warming.follow(lambda share, words: tell(share, f"Compiling the solver, {words}"))
    finally:
        warming.stop()
    tell(1.0, "The solver is ready")


def print_wait_reason() -> None:
    """Print on standard error that the kernels for reading captures are being compiled, if they are not cached yet."""
    if is_cold(READING_KERNEL_PATTERN):
        print("Compiling the file readers, once on this computer: about ten seconds.", file=sys.stderr)


def is_cold(last: str = COMPLETE_MARK_FILE) -> bool:
    """True if kernels are still to be compiled: the cache has no file ``last`` (default: the mark of a complete cache).

    Numba rejects kernels compiled before a kernel source file was written (in a fresh checkout, for example).
    """
    if (folder := os.environ.get("NUMBA_CACHE_DIR")) is None:
        return False
    written = max(file.stat().st_mtime for file in KERNELS_FOLDER.rglob("*.py"))
    return not any(found.stat().st_mtime >= written for found in Path(folder).rglob(last))


def run(function: str) -> None:
    """Run ``MODULE.FUNCTION`` of this package."""
    module, name = function.split(".")
    getattr(import_module(f"studio.startup.{module}"), name)()


def main() -> None:
    """Run the functions named by the arguments in turn, and report the progress to the parent process."""
    gc.set_threshold(*COLLECTION_THRESHOLDS)
    functions = sys.argv[1:]
    if functions[0] not in PICTURE_FUNCTIONS:
        threading.Thread(target=_tell, args=(functions, _work_of(functions)), daemon=True).start()
    while functions:
        run(functions[0])
        functions.pop(0)


def _work_of(functions: Sequence[str]) -> "CompileWork":
    """Work of compiling the kernels of the solver for ``WARM_CONSTRAINTS``, or all others for the other functions."""
    from studio.core.kernels.solve_clip import solve_frames
    from studio.startup.compile_work import LINKING_TIME_RATIO, CompileWork, all_kernels, kernels_below

    solver = kernels_below([solve_frames])
    if WARM_CONSTRAINTS in functions:
        return CompileWork(solver.values(), LINKING_TIME_RATIO)
    return CompileWork(each for each in all_kernels() if id(each) not in solver)


def _tell(functions: list[str], work: "CompileWork") -> None:
    """Write the running one of ``functions`` and the finished fraction of all work, until the last one has ended."""
    try:
        while left := [*functions]:
            # A lock of print's might be held at Python's end.
            os.write(sys.stdout.fileno(), b"%s %.3f\n" % (left[0].encode(), work.fraction_done(time.process_time())))
            time.sleep(PROGRESS_LINE_SECONDS)
    except BrokenPipeError:
        os._exit(0)  # whoever listened is gone, and needs no kernels


if __name__ == "__main__":
    main()
