"""The verb ``batch`` beside the window: started as a process of its own, followed line by line, ended with it."""

import json
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from typing import Any

from studio.core.errors import StudioError
from studio.io.child_process import said_lines

Progress = Callable[[float, str], None]

_START = "import sys; from studio.cli.main import main; sys.exit(main())"
_LINE = re.compile(r"\[(\d+)/(\d+)\] (.*)")
_PATIENCE = 10.0
"""Seconds for the workers to end by themselves."""


def run_batch(arguments: Sequence[str], progress: Progress) -> dict[str, Any]:
    """Run ``batch`` with ``arguments``; returns what it prints with ``--json``.

    ``progress`` hears each file; when it raises, the process and its workers end, and what is done stays. Raises
    StudioError with the sentence of the verb.
    """
    command = [sys.executable, "-c", _START, "batch", *arguments, "--json"]
    with tempfile.TemporaryFile("w+", encoding="utf-8") as answer:
        process = subprocess.Popen(command, stdout=answer, stderr=subprocess.PIPE)
        try:
            last = _follow(process, progress)
        finally:
            _end(process)
        answer.seek(0)
        return _answer(answer.read(), last)


def _follow(process: "subprocess.Popen[bytes]", progress: Progress) -> str:
    """Pass lines on until there are no more; returns the last, which may say why it ended."""
    share, text, last = 0.0, "Starting the workers", ""
    assert process.stderr is not None
    for line in said_lines(process.stderr):
        last = line or last
        if line and (found := _LINE.match(line)):
            share, text = int(found[1]) / int(found[2]), f"{found[1]} of {found[2]}: {found[3]}"
        progress(share, text)
    return last


def _end(process: "subprocess.Popen[bytes]") -> None:
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
        raise StudioError(f"The batch process ended without an answer. Its last message: {last or 'nothing'}") from None
    if "error" in answer:
        raise StudioError(str(answer["error"]))
    return answer
