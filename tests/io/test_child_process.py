"""Processes beside the studio: how far they stand behind it."""

import subprocess
import sys

import pytest

from tests.architecture.sources import ROOT

SCRIPT = """
import os
from studio.io.child_process import child_process
with child_process(("sleep", "9"), behind={behind}) as child:
    print(os.getpriority(os.PRIO_PROCESS, child.pid) - os.getpriority(os.PRIO_PROCESS, 0))
"""


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no niceness")
@pytest.mark.parametrize(("behind", "found"), [(0, 0), (5, 5), (19, 15)])
def test_a_child_stands_behind_a_studio_that_was_started_nicely_itself(behind: int, found: int) -> None:
    """It may not be brought before it: only root can do that, and nobody has asked."""
    command = ("nice", "-n", "4", sys.executable, "-c", SCRIPT.format(behind=behind))
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    assert int(done.stdout) == found
