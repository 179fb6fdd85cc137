"""Child processes whose output is read line by line, and that end together with their parent."""

import os
import queue
import subprocess
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

STUDIO_ROOT = Path(__file__).resolve().parents[2]
"""Folder from which ``python -m studio...`` runs this studio."""
CHILD_NICENESS = 5
"""Default niceness of a child relative to this process: if both want one processor, the child gets a quarter."""
POSIX = os.name == "posix"
"""True if the system has process groups and niceness; Windows has neither."""
GREATEST_NICENESS = 19
"""Greatest niceness of a process."""
CHILD_POLL_SECONDS = 0.05
"""Seconds between two checks for a cancellation by the user."""

Streams = IO[bytes] | int | None


@contextmanager
def child_process(
    command: Sequence[str],
    stdin: Streams = None,
    stdout: Streams = None,
    stderr: Streams = None,
    behind: int = CHILD_NICENESS,
) -> Iterator["subprocess.Popen[bytes]"]:
    """Context with a running process, which is killed at the end of the block unless it has ended by itself.

    Its priority is ``behind`` that of this process, which may have a window. Ctrl-C in a terminal reaches only this
    process, and so ends both.
    """
    group = 0 if POSIX else None
    process = subprocess.Popen(command, stdin=stdin, stdout=stdout, stderr=stderr, cwd=STUDIO_ROOT, process_group=group)
    try:
        if POSIX:
            own = os.getpriority(os.PRIO_PROCESS, 0)  # which only root may go below
            os.setpriority(os.PRIO_PROCESS, process.pid, min(own + behind, GREATEST_NICENESS))
        yield process
    finally:
        process.kill()
        process.wait()
        for stream in (process.stdin, process.stdout, process.stderr):
            if stream is not None:
                with suppress(BrokenPipeError):  # what it had not read is of no use any more
                    stream.close()


def output_lines(stream: IO[bytes]) -> Iterator[str | None]:
    """Lines of ``stream`` as they arrive, until it ends; None from time to time without a line, so that the caller can
    do other work.
    """
    lines: queue.Queue[bytes | None] = queue.Queue()
    threading.Thread(target=_read, args=(stream, lines), daemon=True).start()
    while True:
        try:
            line = lines.get(timeout=CHILD_POLL_SECONDS)
        except queue.Empty:
            yield None
            continue
        if line is None:
            return
        yield line.decode("utf-8", "replace").strip()


def wait_for(process: "subprocess.Popen[bytes]", alive: Callable[[], object]) -> int:
    """Exit code of a process; ``alive`` is called while waiting and may raise an exception to stop."""
    while True:
        alive()
        try:
            return process.wait(CHILD_POLL_SECONDS)
        except subprocess.TimeoutExpired:
            continue


def _read(stream: IO[bytes], lines: "queue.Queue[bytes | None]") -> None:
    for line in stream:
        lines.put(line)
    lines.put(None)
