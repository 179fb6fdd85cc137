"""The window survives anybody: 5,000 events of a seeded monkey; ``make soak`` goes on to 100,000."""

import json
import subprocess
import sys

import pytest

from tests.architecture.sources import ROOT

EVENTS = 5_000


@pytest.mark.timeout(600)
def test_the_window_survives_a_monkey() -> None:
    command = [sys.executable, "-m", "tests.monkey", "--events", str(EVENTS), "--seed", "1"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.stdout, done.stderr[-4000:]
    report = json.loads(done.stdout)
    assert report["events"] >= EVENTS
    assert not report["faults"], "\n".join(report["faults"])
    assert not report["gaps"], "\n".join(report["gaps"])
    assert {"MainWindow", "QMenu"} < report["windows"].keys()
    assert any("Dialog" in window for window in report["windows"])
