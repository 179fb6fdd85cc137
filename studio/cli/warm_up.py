"""Kernels are compiled or fetched from their cache in the background while the window opens.

Compiled once a machine, by processes beside the window's: ``python -m studio.cli.warm_up MODULE FUNCTION``, which
tells how far it is, a share of one a line. First what draws a body, then the solver, by two of them.
"""

import gc
import os
import sys
import threading
import time
from collections.abc import Callable, Iterable
from concurrent.futures import CancelledError
from contextlib import ExitStack, suppress
from importlib import import_module
from pathlib import Path
from subprocess import PIPE

from studio.cli.printing import progress_line
from studio.cli.process import COLLECTED_AFTER
from studio.io.child_process import child_process

KERNELS = "studio.core.kernels."
LOOKED_AT_EVERY = 0.1
LONGEST_HELD = 10.0
"""Seconds after which what is shown first has failed."""
LONG = 3.0
"""Seconds after which it is plain that the kernels are compiled and not fetched."""
TRANSLATED = 0.8
"""How far it is when every kernel has been translated and what constraints call is optimised, in one go."""
PICTURE = ("first_picture", "run")
HALVES = (("first_run", "run_standing"), ("first_run", "run_constraints"))
FAR_BEHIND = 10
"""How much nicer than the window's the processes are that compile the solver: it is to be used meanwhile."""
CHILD = (sys.executable, "-m", "studio.cli.warm_up")
COMPLETE, LAST_TO_READ = "complete", "normalize.encode_frames-*.nbc"
"""What stands in a cache that is full, and in one of which a capture has been read."""


class WarmUp:
    """Begins at once; whoever needs a kernel sooner waits for that one only. Stop it before the process ends."""

    def __init__(self, held: bool = False) -> None:
        """While it is ``held`` other processes compile, but this one is left to what is shown first."""
        self._stopped, self._ready = threading.Event(), threading.Event()
        self._let_go, self._drawable = threading.Event(), threading.Event()
        if not held:
            self.go_on()
        self._shares = dict.fromkeys(HALVES, 0.0)
        # Imported on the thread: numba alone takes a third of a second, which the window need not wait for.
        self._thread = threading.Thread(target=self._run, name="warm-up", daemon=True)
        self._thread.start()

    @property
    def running(self) -> bool:
        """Whether there is something left to do."""
        return self._thread.is_alive()

    @property
    def ready(self) -> bool:
        """Whether every scene's kernels are there."""
        return self._ready.is_set()

    def join(self) -> None:
        """Wait until every scene's kernels are there. Raises CancelledError when they are not to be any more."""
        self._ready.wait()
        if self._stopped.is_set():
            raise CancelledError

    def join_picture(self) -> None:
        """Wait until bodies can be drawn without compiling, or nobody is going to see to that."""
        self._drawable.wait()

    def go_on(self) -> None:
        """Fetch the kernels, if it was held until now."""
        self._let_go.set()

    def stop(self, patience: float | None = None) -> None:
        """End it, and the processes; a kernel that is compiled in this one is waited for, ``patience`` seconds."""
        self._stopped.set()
        self._ready.set()
        self._drawable.set()
        self.go_on()
        self._thread.join(patience)

    def follow(self, report: Callable[[float, str], None]) -> None:
        """Tell how far it is until it is done: a job for the ``TaskRunner``."""
        begun, share = time.monotonic(), 0.0
        while self.running:
            # Kernels that are loaded meanwhile are still to be compiled: what was told is not taken back.
            share = max(share, TRANSLATED * min(ready_share() + sum(self._shares.values()), 1.0))
            report(share, "once on this machine" if time.monotonic() - begun > LONG else "")
            time.sleep(LOOKED_AT_EVERY)

    def _run(self) -> None:
        try:
            if is_cold():
                self._compile_beside(PICTURE, behind=0)
            self._drawable.set()
            if is_cold():
                self._compile_beside(*HALVES, behind=FAR_BEHIND)
            self._let_go.wait(LONGEST_HELD)
            if not self._stopped.is_set():
                self._first_run("run")  # what a child failed in fails here again, and is told
        finally:
            self._drawable.set()
            self._ready.set()
        if not self._stopped.is_set():
            self._first_run("run_seldom")
            if folder := os.environ.get("NUMBA_CACHE_DIR"):
                Path(folder, COMPLETE).touch()

    def _first_run(self, part: str) -> None:
        getattr(import_module("studio.cli.first_run"), part)()

    def _compile_beside(self, *parts: tuple[str, str], behind: int) -> None:
        with ExitStack() as stack:
            children = [
                stack.enter_context(child_process((*CHILD, *part), stdout=PIPE, behind=behind)) for part in parts
            ]
            for part, child in zip(parts, children, strict=True):
                threading.Thread(target=self._listen, args=(part, child.stdout), daemon=True).start()
            while any(child.poll() is None for child in children) and not self._stopped.wait(LOOKED_AT_EVERY):
                pass

    def _listen(self, part: tuple[str, str], lines: Iterable[bytes]) -> None:
        with suppress(ValueError):  # of a process that is ended the last line is cut, or its stream closed
            for line in lines:
                if part in HALVES:
                    self._shares[part] = float(line)


def compile_first() -> None:
    """Compile all kernels where there are none yet, and tell on standard error what is waited for and how far it is."""
    if not is_cold():
        return
    tell, warming = progress_line(), WarmUp()
    try:
        warming.follow(lambda share, _: tell(share, "The solver is compiled, once on this machine"))
    finally:
        warming.stop()
    tell(1.0, "The solver is ready")


def tell_what_reading_waits_for() -> None:
    """Say on standard error that what reads captures is compiled, where it is not there yet: that takes a while."""
    if is_cold(LAST_TO_READ):
        print("What reads motions is compiled, once on this machine: some ten seconds.", file=sys.stderr)


def is_cold(last: str = COMPLETE) -> bool:
    """Whether there is something still to be compiled; by itself anything that the warm-up compiles."""
    folder = os.environ.get("NUMBA_CACHE_DIR")
    return folder is not None and not any(Path(folder).rglob(last))


def ready_share() -> float:
    """The part of all loaded kernels that has been compiled or fetched."""
    modules = [module for name, module in sys.modules.copy().items() if name.startswith(KERNELS)]
    items = [item for module in modules for item in [*vars(module).values()]]  # copied: other threads import meanwhile
    found = {id(item): item for item in items if hasattr(item, "signatures")}
    return sum(bool(item.signatures) for item in found.values()) / max(len(found), 1)


def main() -> None:
    """Compile one part, for the process that listens."""
    gc.set_threshold(*COLLECTED_AFTER)
    threading.Thread(target=_tell, daemon=True).start()
    module, function = sys.argv[1:]
    getattr(import_module(f"studio.cli.{module}"), function)()


def _tell() -> None:
    try:
        while True:
            os.write(sys.stdout.fileno(), b"%.3f\n" % ready_share())  # a lock of print's might be held at Python's end
            time.sleep(LOOKED_AT_EVERY)
    except BrokenPipeError:
        os._exit(0)  # whoever listened is gone, and needs no kernels


if __name__ == "__main__":
    main()
