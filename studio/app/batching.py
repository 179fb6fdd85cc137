"""The verb ``batch`` beside the window: started as a process of its own, followed line by line, ended with it."""

import json
import queue
import re
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Sequence
from typing import IO, Any

from studio.core.errors import StudioError

Progress = Callable[[float, str], None]

_START = "import sys; from studio.cli.main import main; sys.exit(main())"
_LINE = re.compile(r"\[(\d+)/(\d+)\] (.*)")
_POLL = 0.1
"""Seconds between two looks at whether the user wants to stop."""
_PATIENCE = 10.0
"""Seconds for the workers to end by themselves."""


def run_batch(arguments: Sequence[str], progress: Progress) -> dict[str, Any]:
    """Run ``batch`` with ``arguments``; returns what it prints with ``--json``.

    ``progress`` hears each file; when it raises, the process and its workers end, and what is done stays. Raises
    StudioError with the sentence of the verb.
    """
    command = [sys.executable, "-c", _START, "batch", *arguments, "--json"]
    with tempfile.TemporaryFile("w+", encoding="utf-8") as answer:
        process = subprocess.Popen(
            command, stdout=answer, stderr=subprocess.PIPE, text=True, encoding="utf-8", errors="replace"
        )
        try:
            last = _follow(process, progress)
        finally:
            _end(process)
        answer.seek(0)
        return _answer(answer.read(), last)


def _follow(process: "subprocess.Popen[str]", progress: Progress) -> str:
    """Pass lines on until there are no more; returns the last, which may say why it ended."""
    lines: queue.Queue[str | None] = queue.Queue()
    assert process.stderr is not None
    reader = threading.Thread(target=_read, args=(process.stderr, lines), daemon=True)
    reader.start()
    share, text, last = 0.0, "Starting the workers", ""
    while True:
        progress(share, text)
        try:
            line = lines.get(timeout=_POLL)
        except queue.Empty:
            continue
        if line is None:
            return last
        last = line.strip() or last
        if found := _LINE.match(last):
            share, text = int(found[1]) / int(found[2]), f"{found[1]} of {found[2]}: {found[3]}"


def _read(stream: IO[str], lines: "queue.Queue[str | None]") -> None:
    for line in stream:
        lines.put(line)
    lines.put(None)


def _end(process: "subprocess.Popen[str]") -> None:
    if process.poll() is None:
        process.terminate()
    try:
        process.wait(_PATIENCE)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
    if process.stderr is not None:
        process.stderr.close()


def _answer(text: str, last: str) -> dict[str, Any]:
    try:
        answer: dict[str, Any] = json.loads(text)
    except ValueError:
        raise StudioError(f"The batch ended without an answer. It said last: {last or 'nothing'}") from None
    if "error" in answer:
        raise StudioError(str(answer["error"]))
    return answer
