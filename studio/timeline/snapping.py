"""Snapping of dragged times to frames and to magnets: the playhead, ends of contacts, keys, and beats."""

from dataclasses import dataclass

import numpy as np

from studio.core.stage.project import Project
from studio.timeline.axis import TimeAxis
from studio.timeline.shown import RowContext
from studio.timeline.tracks.keys import sheet_fields, stage_times

MAGNET_PIXELS = 6.0


@dataclass(frozen=True)
class Snapped:
    """Stage time in seconds, and the magnet to which it snapped, if any."""

    time: float
    magnet: float | None = None


def snapped_time(axis: TimeAxis, time: float, magnets: tuple[float, ...], free: bool = False) -> Snapped:
    """Nearest magnet within ``MAGNET_PIXELS``, else the nearest frame; ``free`` returns the time unchanged."""
    if free:
        return Snapped(time)
    near = min(magnets, key=lambda magnet: abs(magnet - time), default=None)
    if near is not None and abs(near - time) * axis.scale <= MAGNET_PIXELS:
        return Snapped(near, near)
    return Snapped(round(time * axis.frame_rate) / axis.frame_rate)


def magnets_of(contacts: dict[str, tuple[float, float]], playhead: float, *without: str) -> tuple[float, ...]:
    """Stage times of the playhead and of both ends of all contacts, except those in ``without``."""
    edges = (time for key, ends in contacts.items() if key not in without for time in ends)
    return (playhead, *edges)


def beat_times(project: Project) -> tuple[float, ...]:
    """Stage times in seconds of all beats of sound tracks."""
    return tuple(beat for sound in project.sounds.values() for beat in sound.stage_beats)


def key_magnets(shown: RowContext, scaling: bool) -> tuple[float, ...]:
    """Visible stage times that dragged keys snap to: contacts, beats, other keys and, unless keys are scaled about it,
    the playhead.
    """
    project, axis, selected = shown.project, shown.axis, shown.document.keys.by_field()
    contacts = project.contacts_of(shown.subject.motion_id).values()
    ends = np.array([frame for each in contacts for frame in (each.first, each.last)], dtype=np.float64)
    times = [np.asarray(shown.subject.to_stage(ends / shown.subject.frame_rate))]
    times.append(np.array(beat_times(project)))
    for field in dict.fromkeys((*sheet_fields(shown), *selected)):
        stays = np.ones(len(every := stage_times(shown, field)), dtype=bool)
        stays[list(selected.get(field, ()))] = False
        times.append(every[stays])
    if not scaling:
        times.append(np.array([shown.document.playhead.time]))
    found = np.unique(np.concatenate(times))
    seen = (found >= axis.time_at(axis.left)) & (found <= axis.time_at(axis.right))
    return tuple(found[seen].tolist())
