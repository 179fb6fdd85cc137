"""Processes beside the studio: how far they stand behind it."""

import subprocess
import sys

import pytest

from studio.io import child_process
from studio.io.child_process import GREATEST_NICENESS, POSIX
from tests.architecture.sources import ROOT

SCRIPT = """
import os
from studio.io.child_process import child_process
with child_process(("sleep", "9"), behind={behind}) as child:
    print(os.getpriority(os.PRIO_PROCESS, 0), os.getpriority(os.PRIO_PROCESS, child.pid))
"""


@pytest.mark.skipif(not POSIX, reason="there is no niceness")
@pytest.mark.parametrize("behind", [0, 5, 19])
def test_a_child_stands_behind_a_studio_that_was_started_nicely_itself(behind: int) -> None:
    """It may not be brought before it: only root can do that, and nobody has asked."""
    command = ("nice", "-n", "4", sys.executable, "-c", SCRIPT.format(behind=behind))
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    own, child = map(int, done.stdout.split())
    assert child == own + behind or child == GREATEST_NICENESS < own + behind


def test_a_child_runs_where_there_are_no_groups_and_no_niceness(monkeypatch):
    """As on Windows, whose Popen refuses a group and whose os has no priorities."""
    monkeypatch.setattr(child_process, "POSIX", False)
    monkeypatch.delattr(child_process.os, "setpriority")
    command = (sys.executable, "-c", "print('done')")
    with child_process.child_process(command, stdout=subprocess.PIPE) as child:
        assert child.stdout.read() == b"done\n"
