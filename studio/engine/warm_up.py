"""Kernels are compiled or fetched from their cache in the background while the window opens.

Compiled once a machine, by two processes: what constraints call by ``python -m studio.engine.warm_up``, a share of how
far it is a line, the rest here.
"""

import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterable
from importlib import import_module
from pathlib import Path

from studio.io.child_process import child_process

KERNELS = "studio.core.kernels."
LOOKED_AT_EVERY = 0.1
LONG = 3.0
"""Seconds after which it is plain that the kernels are compiled and not fetched."""
TRANSLATED = 0.8
"""How far it is when every kernel has been translated and what constraints call is optimised, in one go."""
CHILD = (sys.executable, "-m", "studio.engine.warm_up")
LONGEST_TO_COMPILE = "adapt.solve_frames-*.nbc"
"""What stands in a cache that is full."""


class WarmUp:
    """Begins at once; whoever needs a kernel sooner waits for that one only. Stop it before the process ends."""

    def __init__(self) -> None:
        self._stopped = threading.Event()
        self._share_of_child = 0.0
        # Imported on the thread: numba alone takes a third of a second, which the window need not wait for.
        self._thread = threading.Thread(target=self._run, name="warm-up", daemon=True)
        self._thread.start()

    @property
    def running(self) -> bool:
        """Whether there is something left to do."""
        return self._thread.is_alive()

    def join(self) -> None:
        """Wait until all kernels are there."""
        self._thread.join()

    def stop(self) -> None:
        """End it; what this process is compiling right now is waited for."""
        self._stopped.set()
        self.join()

    def follow(self, report: Callable[[float, str], None]) -> None:
        """Tell how far it is until it is done: a job for the ``TaskRunner``."""
        begun = time.monotonic()
        while self.running:
            share = TRANSLATED * min(ready_share() + self._share_of_child, 1.0)
            report(share, "once, about half a minute" if time.monotonic() - begun > LONG else "")
            time.sleep(LOOKED_AT_EVERY)

    def _run(self) -> None:
        if is_cold():
            with child_process(CHILD, stdout=subprocess.PIPE) as child:
                assert child.stdout is not None
                threading.Thread(target=self._listen, args=(child.stdout,), daemon=True).start()
                import_module("studio.engine.first_run").run_standing()
                while child.poll() is None and not self._stopped.wait(LOOKED_AT_EVERY):
                    pass
        if not self._stopped.is_set():
            import_module("studio.engine.first_run").run()  # what the child failed in fails here again, and is told

    def _listen(self, lines: Iterable[bytes]) -> None:
        for line in lines:
            self._share_of_child = float(line)


def is_cold() -> bool:
    """Whether most kernels are still to be compiled."""
    folder = os.environ.get("NUMBA_CACHE_DIR")
    return folder is not None and not any(Path(folder).rglob(LONGEST_TO_COMPILE))


def ready_share() -> float:
    """The part of all loaded kernels that has been compiled or fetched."""
    modules = [module for name, module in sys.modules.copy().items() if name.startswith(KERNELS)]
    found = {id(item): item for module in modules for item in vars(module).values() if hasattr(item, "signatures")}
    return sum(bool(item.signatures) for item in found.values()) / max(len(found), 1)


def main() -> None:
    """Compile what constraints call, for the process that listens."""
    threading.Thread(target=_tell, daemon=True).start()
    import_module("studio.engine.first_run").run_constraints()


def _tell() -> None:
    while True:
        os.write(sys.stdout.fileno(), b"%.3f\n" % ready_share())  # a lock of print's might be held when Python ends
        time.sleep(LOOKED_AT_EVERY)


if __name__ == "__main__":
    main()
