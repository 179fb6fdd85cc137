"""Readers of scenes that are forked from this process: a new Python for each spoilt file takes far longer."""

import os
import resource
import signal
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

from studio.io.scene.child_run import run_child
from studio.io.scene.scene_reader import SceneReader

SECONDS = 20
"""Processor time of a reader; it is killed then, as the studio kills one by the clock."""


def fork_readers() -> None:
    """Fork the children of ``SceneReader`` from now on, with the packages that they import already loaded."""
    for package in ("ufbx", "pxr.Usd", "pxr.UsdGeom", "pxr.UsdSkel", "studio.io.fbx.child", "studio.io.usd.child"):
        import_module(package)
    SceneReader._run = _run  # type: ignore[method-assign]


def _run(self: SceneReader, path: Path, target: Path, what: str, alive: Callable[[], object]) -> None:
    alive()
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        os.dup2(writer, 2)
        resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
        sys.argv = ["", str(path), str(target), what]
        run_child(import_module(self.module).main)
    os.close(writer)
    said = b"".join(iter(lambda: os.read(reader, 65536), b"")).decode("utf-8", "replace").strip()
    os.close(reader)
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    assert code != -signal.SIGKILL, f"more than {SECONDS} seconds"
    if code:
        raise self._refusal(path, said.splitlines()[-1][:200] if said and code > 0 else f"its reader crashed ({code})")
