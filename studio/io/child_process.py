"""Child processes: followed line by line, and ended together with their parent."""

import os
import queue
import subprocess
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

STUDIO_ROOT = Path(__file__).resolve().parents[2]
"""Folder in which ``python -m studio...`` finds this studio."""
CHILD_NICENESS = 5
"""Niceness of a child above this process by default: of two that want a processor, it gets a quarter."""
POSIX = os.name == "posix"
"""Process groups and niceness exist; Windows has neither."""
MOST_NICENESS = 19
"""The nicest that a process can be."""
POLL = 0.05
"""Seconds between two looks at whether the user wants to stop."""

Streams = IO[bytes] | int | None


@contextmanager
def child_process(
    command: Sequence[str],
    stdin: Streams = None,
    stdout: Streams = None,
    stderr: Streams = None,
    behind: int = CHILD_NICENESS,
) -> Iterator["subprocess.Popen[bytes]"]:
    """Process that is killed at the end of the block, unless it has ended by itself.

    If processors are scarce it has a lower priority than this one, which may have a window. Ctrl-C in a terminal ends
    only this process, and so both.
    """
    group = 0 if POSIX else None
    process = subprocess.Popen(command, stdin=stdin, stdout=stdout, stderr=stderr, cwd=STUDIO_ROOT, process_group=group)
    try:
        if POSIX:
            own = os.getpriority(os.PRIO_PROCESS, 0)  # which only root may go below
            os.setpriority(os.PRIO_PROCESS, process.pid, min(own + behind, MOST_NICENESS))
        yield process
    finally:
        process.kill()
        process.wait()
        for stream in (process.stdin, process.stdout, process.stderr):
            if stream is not None:
                with suppress(BrokenPipeError):  # what it had not read is of no use any more
                    stream.close()


def output_lines(stream: IO[bytes]) -> Iterator[str | None]:
    """Lines as they arrive, until the stream ends; None now and then without any, so that the caller
    can do other work.
    """
    lines: queue.Queue[bytes | None] = queue.Queue()
    threading.Thread(target=_read, args=(stream, lines), daemon=True).start()
    while True:
        try:
            line = lines.get(timeout=POLL)
        except queue.Empty:
            yield None
            continue
        if line is None:
            return
        yield line.decode("utf-8", "replace").strip()


def wait_for(process: "subprocess.Popen[bytes]", alive: Callable[[], object]) -> int:
    """Exit code of a process; ``alive`` is called while waiting and may raise to stop."""
    while True:
        alive()
        try:
            return process.wait(POLL)
        except subprocess.TimeoutExpired:
            continue


def _read(stream: IO[bytes], lines: "queue.Queue[bytes | None]") -> None:
    for line in stream:
        lines.put(line)
    lines.put(None)
