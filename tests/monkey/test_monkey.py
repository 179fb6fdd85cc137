"""A short visit of the monkey; ``make soak`` lets it stay for twenty times as long."""

import subprocess
import sys

import pytest

EVENTS = 5000


@pytest.mark.timeout(900)
def test_the_window_survives_five_thousand_events() -> None:
    command = [sys.executable, "-m", "tests.monkey", "--events", str(EVENTS)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{done.stderr}{done.stdout}"
