"""Registration of C3D files, their recognition, and writing of takes."""

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from studio.core.captures.annotations import Label
from studio.core.captures.capture import Capture
from studio.core.markers.trial import TrialEvent
from studio.io.export import Take
from studio.io.registry import Progress
from studio.io.up_axis import FILE_AXES

_WORN = 0.6
"""Fraction of the work after which all markers have their positions."""
_SIDES = ("Left", "Right")


def is_c3d(head: bytes) -> bool:
    """True if a file that begins with ``head`` may be C3D: the block of its parameters, the mark 80, and in that block
    the kind of processor, if ``head`` is long enough.
    """
    if len(head) < 2 or head[0] < 2 or head[1] != 0x50:
        return False
    processor = (head[0] - 1) * 512 + 3
    return head[processor] in (84, 85, 86) if processor < len(head) else len(head) >= 512


def write_take(path: Path, take: Take, progress: Progress) -> None:
    """Write the joints of ``take`` and markers of its body; read back, every point is within 0.001 mm.

    Z is up and -Y the front, as in the reader, so that a body keeps its heading.
    """
    from studio.core.captures.virtual_markers import virtual_trial
    from studio.io.c3d.writer import write_c3d

    trial = virtual_trial(
        take.capture,
        take.annotations.contacts or (),
        lambda share: progress(_WORN * share, f"Placing the markers of {path.name}"),
    )
    events = _events(take.annotations.labels, take.capture, trial.events)
    trial = replace(trial, points=trial.points @ FILE_AXES["Z"], events=events)
    write_c3d(path, trial, lambda share, text: progress(_WORN + (1.0 - _WORN) * share, text))


def _events(labels: Iterable[Label], capture: Capture, found: Iterable[TrialEvent]) -> tuple[TrialEvent, ...]:
    """Events at the begins of labels, and those ``found`` in contacts for kinds without a label, in order of time."""
    marked = []
    for label in labels:
        context, _, name = label.name.partition(" ")
        seconds = (label.first - capture.first_frame) / capture.frame_rate
        if seconds >= 0.0:
            sided = context in _SIDES and bool(name)
            marked.append(TrialEvent(name if sided else label.name, context if sided else "General", seconds))
    kinds = {event.label for event in marked}
    return tuple(sorted((*marked, *(each for each in found if each.label not in kinds)), key=lambda event: event.time))
