"""The window closes at once, whatever is under way: seen from outside, as a process."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.architecture.sources import ROOT
from tests.patience import PATIENCE

AT_MOST, TRIES = 1.0, 3
"""Seconds; a busy machine takes longer now and then, the program always."""
CHILD = """
import os, sys, time
from studio.startup.process import prepare_process
prepare_process()
from PySide6.QtCore import QTimer
from studio.app import application
from studio.app.main_window import MainWindow

def tell_time():  # less what the window's thread waited for a processor that others had
    with open("/proc/thread-self/schedstat") as waits:
        print(time.monotonic() - int(waits.read().split()[1]) / 1e9, flush=True)

def close():
    [window] = [each for each in qt.topLevelWidgets() if isinstance(each, MainWindow)]
    tell_time()
    window.close_without_saving()

def end(code, end=os._exit):
    tell_time()
    end(code)

os._exit = end

qt = application.make_application()
QTimer.singleShot(int(1000 * float(sys.argv[1])), close)
application.main([])
"""

OPEN = """
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)  # a job in the background inherits that it is ignored
sys.path.insert(0, {!r})
from studio.startup.process import prepare_process
prepare_process()
from PySide6.QtCore import QTimer
from studio.app import application
qt = application.make_application()
QTimer.singleShot(3000, lambda: print("open", flush=True))
application.main([])
"""


def seconds_to_end(folder: Path, cold: bool, after: float) -> float:
    settings = {f"XDG_{kind}_HOME": str(folder / kind) for kind in ("CONFIG", "DATA", "STATE")}
    kernels = {"NUMBA_CACHE_DIR": str(folder / "kernels")} if cold else {}
    command = [sys.executable, "-c", CHILD, str(after)]
    done = subprocess.run(
        command, cwd=ROOT, env={**os.environ, **settings, **kernels}, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    closed, ended = map(float, done.stdout.split())
    return ended - closed


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="Linux says how long a thread waited")
@pytest.mark.parametrize(("cold", "after"), [(False, 0.0), (False, 2.0), (True, 0.5), (True, 4.0)])
def test_the_window_closes_within_a_second_kernels_compiling_or_not(tmp_path: Path, cold: bool, after: float) -> None:
    took = []
    while len(took) < TRIES and min(took, default=AT_MOST) >= AT_MOST:
        took.append(seconds_to_end(tmp_path / str(len(took)), cold, after))
    assert min(took) < AT_MOST, took


@pytest.mark.skipif(os.name != "posix", reason="A terminal of Windows interrupts all of its processes")
def test_ctrl_c_in_the_terminal_closes_a_window_at_rest(tmp_path: Path) -> None:
    """It ended in a segmentation fault: Qt called Python, where the exception of Ctrl-C was raised."""
    settings = {f"XDG_{kind}_HOME": str(tmp_path / kind) for kind in ("CONFIG", "DATA", "STATE")}
    command = [sys.executable, "-c", OPEN.format(str(ROOT))]
    with subprocess.Popen(
        command, env={**os.environ, **settings}, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as window:
        try:
            assert window.stdout is not None
            assert window.stdout.readline() == "open\n"
            window.send_signal(signal.SIGINT)
            _, told = window.communicate(timeout=PATIENCE / 1000)
        finally:
            window.kill()
    assert window.returncode == 0, told
    assert "Fatal" not in told
