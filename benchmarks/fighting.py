"""The fighter of the bundled library, a minute with a head that moves: ``python -m benchmarks.fighting [SECONDS]``.

Times are processor time of one thread: what is made beside the animation in a show is made in the frame here.
"""

import sys
import time

import numpy as np
from numpy.typing import NDArray

from benchmarks.report import table as markdown
from studio.cli.live import guard_of, rehearse, swaying_head
from studio.core.body.morphology import Morphology
from studio.io.project.character_file import bundled_characters
from studio.library.indexing import bundled_library
from studio.library.library import Library
from studio.live.fight import ANY_STRIKE, FIGHT_ORDERS, FightReport, fight, orders_every
from studio.live.fighter import Fighter

SECONDS, EVERY = 60.0, 1.5
BODIES = ("child", "adult_woman", "giant")
TITLES = (
    "body",
    "strikes",
    "limbs",
    "within 1 mm",
    "in reach of the limb alone",
    "those miss, mm at most",
    "others, mm at most",
    "request to motion, ms",
    "at most",
    "slowest frame, ms",
)
IN_REACH = 1.1
"""Lengths of a limb, without hand or foot."""


def main(arguments: list[str]) -> None:
    """Fight and print."""
    print(fights(*map(float, arguments)))


def fights(seconds: float = SECONDS) -> str:
    """A row for each of three bodies: strikes, misses, and times of the thread that did all of it."""
    library, characters = bundled_library(), bundled_characters()
    return markdown(TITLES, [_row(name, fought(library, characters[name].morphology, seconds)) for name in BODIES])


def fought(library: Library, body: Morphology, seconds: float) -> FightReport:
    """One fight; kernels are warm before it counts."""
    fighter = Fighter(library, body, guard_of(None))
    rehearse(fighter)
    stature = fighter.body.stature
    orders = orders_every(EVERY, [*FIGHT_ORDERS.values(), ANY_STRIKE])
    return fight(fighter, lambda now: ducking(now, stature), orders, seconds, clock=time.thread_time)


def ducking(now: float, stature: float) -> NDArray[np.float64]:
    """A head that goes to and fro, and up and down between belly and chin of who strikes at it."""
    x, y, _ = swaying_head(now, stature)
    return np.array([x, y, stature * (0.68 + 0.16 * np.sin(now))])


def _row(name: str, report: FightReport) -> list[str]:
    told = 1000.0 * np.array(report.latencies)
    near = [1000.0 * hit.missed for hit in report.hits if hit.apart <= IN_REACH]
    far = [1000.0 * hit.missed for hit in report.hits if hit.apart > IN_REACH]
    return [
        name.replace("_", " "),
        str(len(report.hits)),
        str(len({hit.limb for hit in report.hits})),
        str(sum(hit.missed <= 1e-3 for hit in report.hits)),
        str(len(near)),
        f"{max(near):.3f}",
        f"{max(far):.3f}" if far else "",
        f"{np.median(told):.1f}",
        f"{told.max():.1f}",
        f"{1000.0 * report.slowest_frame:.1f}",
    ]


if __name__ == "__main__":
    main(sys.argv[1:])
