"""The real window under a hand.

``python -m benchmarks.window [--seconds N] [--bodies N] [--film FOLDER] [--slow FACTOR]``

A target, a slider, a curve's handle, the ground's height, a key, a tangent and a ring are dragged for some seconds each
by a mouse at 60 Hz, then eight bodies play and rest. Told are how old the pose of every picture is, how many pictures
there are, and what they cost. Writes ``docs/window.md``, but for the ten tasks at its end; a film is every picture of
the drags as a file. With ``--slow 3`` each solve takes three times its processor time, and nothing is written.
"""

import os
import sys


def main() -> int:
    """Set the process up before anything else is imported."""
    from studio.startup.process import prepare_process

    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
    prepare_process()
    from benchmarks import window_figures

    return window_figures.main(sys.argv[1:])


if __name__ == "__main__":
    sys.exit(main())
