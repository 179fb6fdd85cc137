"""Fight in steps of one frame: a moving target, orders, a fighter, and a report."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import Morphology
from studio.core.names import counted_noun
from studio.library.clip_labels import Kind, Limb
from studio.live.fighter import Fighter, StrikeOutcome

FloatArray = NDArray[np.float64]
Order = tuple[tuple[Limb, ...], tuple[Kind, ...]]

FIGHT_ORDERS: dict[str, Order] = {
    f"{side} {kind}": ((Limb[f"{side.upper()}_{'ARM' if kind is Kind.PUNCH else 'LEG'}"],), (kind,))
    for side in ("left", "right")
    for kind in (Kind.PUNCH, Kind.KICK)
}
"""Limbs and kinds of strike for each order to a fighter, by name."""
ANY_STRIKE: Order = ((), ())


@dataclass
class FightReport:
    """Report of a fight: strikes, ``latencies`` in seconds from an order to the first changed frame, and the duration
    ``slowest_frame`` in seconds.
    """

    hits: list[StrikeOutcome]
    latencies: list[float] = field(default_factory=list)
    slowest_frame: float = 0.0
    frames: int = 0
    stopped: bool = False
    """True if Ctrl+C ended the fight early."""

    @property
    def words(self) -> str:
        """Report as a few lines of text."""
        missed = [1000.0 * hit.missed for hit in self.hits]
        lines = [f"{counted_noun(self.frames, 'frame')}, {counted_noun(len(self.hits), 'strike')}"]
        if missed:
            lines.append(f"missed by {np.median(missed):.2f} mm (median), {max(missed):.2f} mm at most")
        if self.latencies:
            told = 1000.0 * np.array(self.latencies)
            lines.append(f"{np.median(told):.0f} ms from order to motion (median), {told.max():.0f} ms at most")
        lines.append(f"slowest frame {1000.0 * self.slowest_frame:.1f} ms")
        return "\n".join(lines)


def fight(
    fighter: Fighter,
    target_at: Callable[[float], FloatArray],
    order_at: Callable[[float], Order | None],
    seconds: float,
    show: Callable[[FloatArray, FloatArray, Morphology, float], object] = lambda *_: None,
    *,
    paced: bool = False,
    clock: Callable[[], float] = time.perf_counter,
) -> FightReport:
    """Let ``fighter`` fight for ``seconds``, a frame at a time; in real time if ``paced``, otherwise as fast as
    possible.

    Ctrl-C ends the fight early, with the report of the fight until then. The times of the report are measured by
    ``clock``: ``time.thread_time`` measures the computing time, if nothing is made in the background.
    """
    report, ordered, begun = FightReport(fighter.hits), 0.0, time.perf_counter()
    waiting = False
    try:
        for frame in range(round(seconds * fighter.rate)):
            now = frame / fighter.rate
            if paced:
                time.sleep(max(begun + now - time.perf_counter(), 0.0))
            order, target = order_at(now), target_at(now)
            start = clock()
            if order is not None and fighter.strike(target, *order):
                ordered, waiting = start, True
            positions, rotations = fighter.step(target)
            report.slowest_frame = max(report.slowest_frame, clock() - start)
            if waiting and not fighter.is_waiting:
                report.latencies.append(clock() - ordered)
                waiting = False
            show(positions, rotations, fighter.body, now)
            report.frames += 1
    except KeyboardInterrupt:
        report.stopped = True
    return report


def orders_every(seconds: float, orders: Sequence[Order]) -> Callable[[float], Order | None]:
    """Function that returns the next of ``orders``, cyclically, every ``seconds``; None in between."""
    given = [0]

    def order_at(now: float) -> Order | None:
        if now < seconds * (given[0] + 1):
            return None
        given[0] += 1
        return orders[(given[0] - 1) % len(orders)]

    return order_at
