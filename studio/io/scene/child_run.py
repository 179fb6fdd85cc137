"""Run of a child process that reads a scene, with limited memory; an error is one line on standard error."""

import os
import sys
import traceback
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

MOST_FRAME_VALUES = 1 << 27
"""Maximum number of numbers of all frames and joints together."""
SPARE_MEMORY_BYTES = 3 << 30
"""Bytes of address space in addition to twenty times the file: for Python and NumPy, and half a gigabyte."""


def run_child(main: Callable[[str, str, str], None]) -> None:
    """Call ``main`` with the arguments of the process, which then exits without cleaning up its libraries."""
    code = 0
    try:
        source, target, what = sys.argv[1:]
        _limit_memory(Path(source).stat().st_size)
        main(source, target, what)
    except SystemExit as refusal:
        print(refusal, file=sys.stderr)
        code = 1
    except Exception:  # noqa: BLE001 - whatever it is, its last line is told
        traceback.print_exc()
        code = 1
    sys.stderr.flush()
    os._exit(code)


def _limit_memory(size: int) -> None:
    """Limit the memory of this process, for files with wrong sizes."""
    try:
        import resource
    except ImportError:  # Windows has no such limit; time is limited there as here
        return
    with suppress(ValueError, OSError):  # macOS has the name, but keeps no such limit
        resource.setrlimit(resource.RLIMIT_AS, (SPARE_MEMORY_BYTES + 20 * size,) * 2)
