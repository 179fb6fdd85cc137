"""Sets the scene before Qt, VTK or numba are imported: no display, no user's folders, kernels that last."""

import os
import sys
import tempfile
from pathlib import Path

import pytest

from studio.cli.process import has_display, prepare_process

ROOT = Path(__file__).resolve().parents[1]
CAPTURES = ROOT.parent / "shared" / "captures"

# A cold compile takes many seconds, so kernels outlive the run: their folder is named before the others move.
prepare_process()

_folders = tempfile.TemporaryDirectory(prefix="morpho-studio-tests-")
for _kind in ("CACHE", "CONFIG", "DATA", "STATE"):
    os.environ[f"XDG_{_kind}_HOME"] = str(Path(_folders.name) / _kind.lower())

if sys.platform == "linux" and not has_display():
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
    os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")


@pytest.fixture(scope="session")
def captures() -> Path:
    """The folder of real captures beside the repository; they are not ours to copy into it."""
    if not CAPTURES.is_dir():
        pytest.skip(f"the shared captures are not here ({CAPTURES})")
    return CAPTURES
