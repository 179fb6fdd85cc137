"""Readers of scenes in a child process, in which a crash, an endless loop or a damaged file does no harm."""

import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError
from studio.io.child_process import child_process
from studio.io.registry import Progress

SCENE_ADVICE = "Export the animation as BVH or GLB from the program that made it."
_PATIENCE, _BYTES_A_SECOND = 30.0, 1 << 20
"""Seconds for any file, and bytes for which there is one more."""
_POLL = 0.1

Arrays = Mapping[str, NDArray[Any]]


@dataclass(frozen=True)
class SceneReader:
    """Reader of one scene format: the module that runs in a child process, and the package that it needs."""

    format: str
    module: str
    """``python -m MODULE IN OUT.npz motion|figure|either``."""
    package: str
    """Name by which Python imports the package."""
    distribution: str
    """Name by which pip installs the package, an extra of the studio."""

    def read(self, path: Path, what: str, progress: Progress) -> Arrays:
        """Arrays of the ``motion``, the ``figure`` or ``either`` in the file, as ``what`` says. Raises StudioError with
        what to do.
        """
        if find_spec(self.package) is None:
            raise StudioError(
                f"{path.name}: {self.format} is read with the package '{self.distribution}' (`pip install"
                f" morpho-studio[{self.format.lower()}]`). Or: {SCENE_ADVICE}"
            )
        with tempfile.TemporaryDirectory() as folder:
            target = Path(folder) / "read.npz"
            self._run(path, target, what, lambda: progress(0.1, f"Reading {path.name}"))
            try:
                with np.load(target, allow_pickle=False) as read:
                    return {name: read[name] for name in read.files}
            except (OSError, ValueError, KeyError) as error:
                raise self._refusal(path, str(error)) from error

    def _run(self, path: Path, target: Path, what: str, alive: Callable[[], object]) -> None:
        """Run the child process; a crash, an endless loop or a cancelled import ends with it."""
        try:
            seconds = _PATIENCE + path.stat().st_size / _BYTES_A_SECOND
        except OSError as error:
            raise StudioError(
                f"{path.name} could not be read: {error.strerror}. Check the file and try again."
            ) from error
        command = [sys.executable, "-m", self.module, str(path.resolve()), str(target), what]
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
            raise StudioError(
                f"{path.name} takes longer than {seconds:.0f} s to be read as {self.format}. {SCENE_ADVICE}"
            )
        said = answer.decode("utf-8", "replace").strip()
        raise self._refusal(
            path, said.splitlines()[-1][:200] if said and child.returncode > 0 else "its reader crashed"
        )

    def _refusal(self, path: Path, reason: str) -> StudioError:
        return StudioError(f"{path.name} could not be read as {self.format}: {reason.rstrip('.')}. {SCENE_ADVICE}")
