"""A short visit of the monkey; ``make soak`` lets it stay for fifty times as long."""

import subprocess
import sys

EVENTS, ROUND = 2000, 400
"""As many windows in two thousand events as in five thousand of its usual rounds."""


def test_the_window_survives_two_thousand_events() -> None:
    command = [sys.executable, "-m", "tests.monkey", "--events", str(EVENTS), "--round", str(ROUND)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{done.stderr}{done.stdout}"
