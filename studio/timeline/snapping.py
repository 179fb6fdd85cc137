"""Snapping: dragged times catch on frames, and on what lies near: the playhead and the ends of contacts."""

from dataclasses import dataclass

from studio.timeline.axis import TimeAxis

MAGNET_PIXELS = 6.0


@dataclass(frozen=True)
class Snapped:
    """A time of the stage, and the moment that caught it, if one did."""

    time: float
    caught: float | None = None


def snapped(axis: TimeAxis, time: float, magnets: tuple[float, ...], free: bool = False) -> Snapped:
    """The nearest magnet within six pixels, else the nearest frame; ``free`` leaves the time as it is."""
    if free:
        return Snapped(time)
    near = min(magnets, key=lambda magnet: abs(magnet - time), default=None)
    if near is not None and abs(near - time) * axis.scale <= MAGNET_PIXELS:
        return Snapped(near, near)
    return Snapped(round(time * axis.frame_rate) / axis.frame_rate)


def magnets_of(contacts: dict[str, tuple[float, float]], playhead: float, *without: str) -> tuple[float, ...]:
    """The playhead and both ends of all contacts, those named in ``without`` left out."""
    edges = (time for key, ends in contacts.items() if key not in without for time in ends)
    return (playhead, *edges)
