"""Sets the scene before Qt, VTK or numba are imported: no display, no user's folders, kernels that last."""

import atexit
import gc
import os
import sys
import tempfile
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from shutil import rmtree

import platformdirs
import pytest
from hypothesis import settings

from studio.startup.process import has_display, prepare_process
from tests.captures import CAPTURES, missing

# A cold compile takes many seconds, so kernels outlive the run: their folder is named before the others move. So
# does the list of fonts that matplotlib makes when it is imported first.
prepare_process()
os.environ.setdefault("MPLCONFIGDIR", platformdirs.user_cache_dir("matplotlib", appauthor=False))

_folders = tempfile.TemporaryDirectory(prefix="morpho-studio-tests-")
atexit.register(_folders.cleanup)
for _kind in ("CACHE", "CONFIG", "DATA", "STATE"):
    os.environ[f"XDG_{_kind}_HOME"] = str(Path(_folders.name) / _kind.lower())

if sys.platform.startswith("linux") and not has_display():
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

# Time on a busy machine says nothing. The same examples are tried every time, on every machine; others are tried by
# pytest --hypothesis-profile=random, and many more by make soak.
settings.register_profile("studio", deadline=None, derandomize=True, max_examples=25)
settings.register_profile("random", deadline=None)
settings.register_profile("deep", deadline=None, max_examples=2000)
settings.load_profile("studio")


def pytest_sessionstart() -> None:
    """Compile what most tests call, before any of them can be timed out for it.

    In this process, where the parts of kernels then serve the tests that call them by themselves.
    """
    first_run = import_module("studio.startup.first_run")
    first_run.run()
    first_run.run_seldom()


def pytest_collection_finish() -> None:
    """Let Python's collector ignore what is loaded by now: it went through all modules and tests again and again."""
    gc.collect()
    gc.freeze()


@pytest.fixture(autouse=True)
def collected() -> Iterator[None]:
    """Once there is an application, garbage is collected between tests alone, on their thread, as a window does.

    A worker that collects a part of a window holds a lock of Qt while it waits for the thread that waits for that lock.
    """
    yield
    widgets = sys.modules.get("PySide6.QtWidgets")
    if widgets is not None and widgets.QApplication.instance():
        gc.disable()
        import_module("studio.app.main_thread_gc").collect_what_is_due()


@pytest.fixture(autouse=True)
def nothing_kept() -> Iterator[None]:
    """Reference poses that one test keeps are none of the next one's."""
    yield
    rmtree(Path(os.environ["XDG_DATA_HOME"]) / "morpho-studio" / "reference_poses", ignore_errors=True)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark every test that uses the folder of captures as one that needs them."""
    for item in items:
        if "captures" in getattr(item, "fixturenames", ()):
            item.add_marker("captures")


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skip a test that needs captures of people where there are none."""
    if item.get_closest_marker("captures") and not CAPTURES.is_dir():
        pytest.skip(missing())


@pytest.fixture(scope="session")
def captures() -> Path:
    """Folder of captures of people."""
    return CAPTURES
