"""FBX files as arrays, read by ufbx in a child process."""

import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError
from studio.io.child_process import child_process
from studio.io.registry import Progress

FBX_ADVICE = "Export the animation as BVH or GLB from the program that made it."
_PATIENCE, _BYTES_A_SECOND = 30.0, 1 << 20
"""Seconds for any file, and bytes for which there is one more."""
_POLL = 0.1

Arrays = Mapping[str, NDArray[Any]]


def is_fbx(head: bytes) -> bool:
    """True if a file that begins with ``head`` is an FBX file, binary or text."""
    return head.startswith((b"Kaydara FBX Binary", b"; FBX"))


def read_arrays(path: Path, what: str, progress: Progress) -> Arrays:
    """Arrays that ``child`` has read: ``motion``, ``figure`` or ``either``. Raises StudioError with what to do."""
    if find_spec("ufbx") is None:
        raise StudioError(
            f"{path.name}: FBX is read with the package 'ufbx' (`pip install morpho-studio[fbx]`). Or: {FBX_ADVICE}"
        )
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "read.npz"
        _run_child(path, target, what, lambda: progress(0.1, f"Reading {path.name}"))
        try:
            with np.load(target, allow_pickle=False) as read:
                return {name: read[name] for name in read.files}
        except (OSError, ValueError, KeyError) as error:
            raise StudioError(f"{path.name} could not be read as FBX: {error}. {FBX_ADVICE}") from error


def _run_child(path: Path, target: Path, what: str, alive: Callable[[], object]) -> None:
    """A crash, an endless loop or a cancelled import end with the child."""
    try:
        seconds = _PATIENCE + path.stat().st_size / _BYTES_A_SECOND
    except OSError as error:
        raise StudioError(f"{path.name} could not be read: {error.strerror}. Check the file and try again.") from error
    command = [sys.executable, "-m", "studio.io.fbx.child", str(path.resolve()), str(target), what]
    with child_process(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, behind=0) as child:
        stop = threading.Timer(seconds, child.kill)
        stop.start()
        try:
            while True:
                alive()
                try:
                    _, answer = child.communicate(timeout=_POLL)
                    break
                except subprocess.TimeoutExpired:
                    continue
        finally:
            timed_out = not stop.is_alive()
            stop.cancel()
    if child.returncode == 0:
        return
    if timed_out:
        raise StudioError(f"{path.name} takes longer than {seconds:.0f} s to be read as FBX. {FBX_ADVICE}")
    said = answer.decode("utf-8", "replace").strip()
    reason = said.splitlines()[-1][:200] if said and child.returncode > 0 else "its reader crashed"
    raise StudioError(f"{path.name} could not be read as FBX: {reason.rstrip('.')}. {FBX_ADVICE}")
