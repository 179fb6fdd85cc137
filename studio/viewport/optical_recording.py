"""Recorded markers, force plates and forces of an optical capture at one moment, on the stage."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.captures.capture import Capture
from studio.core.markers.force_plates import plate_reactions
from studio.core.markers.marker_map import seen_labels
from studio.core.markers.trial import Trial
from studio.core.stage.placement import Placement
from studio.document import colours
from studio.document.document import Document
from studio.engine.posed_performer import PosedPerformer
from studio.io.up_axis import turn_to_world
from studio.viewport.paths import StagePath

FloatArray = NDArray[np.float64]

METRES_A_NEWTON = 0.001
PLATE_COLOUR = colours.STAGE_TEXT_THIRD
FORCE_COLOUR = colours.kind_colour("balance")


@dataclass(frozen=True, eq=False)
class MarkerFrame:
    """Recording at one moment: ``points`` (N, 3) of the visible markers with their labels without subject, and lines of
    plates and forces.
    """

    labels: tuple[str, ...]
    used: NDArray[np.bool_]
    """(N,) True for markers in the marker map."""
    points: FloatArray
    paths: tuple[StagePath, ...]


class RecordingOfPerformer:
    """Optical capture in the space of its motion; without a body, above the floor."""

    def __init__(self, capture: Capture) -> None:
        from studio.core.normalized.normalize import motion_origin  # late, with scipy

        assert capture.markers is not None
        self.capture, trial = capture, capture.markers.trial
        self._turn = trial.metres * turn_to_world(capture.up_axis).T
        body = capture.body_map is not None
        self._origin = motion_origin(capture) if body else np.array([0.0, 0.0, capture.floor])
        self.labels = seen_labels(trial, capture.markers.subject)
        self._places = [trial.labels.index(label) for label in self.labels]
        self._used = np.array([bare in capture.markers.marker_map.labels for bare in self.labels.values()], dtype=bool)
        in_unit = trial.metres_of_plates / trial.metres
        self._plates = [self._to_motion(in_unit * plate.corners[[0, 1, 2, 3, 0]]) for plate in trial.plates]
        self._forces = [_pushes(trial, index) for index in range(len(trial.plates))]

    def at(self, frame: int, placement: Placement) -> MarkerFrame:
        """Recording at a frame, clamped to the capture, placed on the stage."""
        assert self.capture.markers is not None
        trial = self.capture.markers.trial
        frame = min(max(frame, 0), trial.frame_count - 1)
        points = placement.to_stage(self._to_motion(trial.points[frame, self._places]))
        seen = np.isfinite(points).all(axis=1)
        bare = tuple(self.labels.values())
        return MarkerFrame(
            tuple(bare[index] for index in np.flatnonzero(seen)),
            self._used[seen],
            points[seen],
            tuple(self._lines(trial, frame, placement)),
        )

    def _lines(self, trial: Trial, frame: int, placement: Placement) -> list[StagePath]:
        lines = [StagePath(placement.to_stage(plate), PLATE_COLOUR, np.full(5, 0.8)) for plate in self._plates]
        for pushes in self._forces:
            if pushes is not None:
                places, forces = pushes
                sample = min(round(frame * trial.analog.rate / trial.frame_rate), len(places) - 1)
                begin = self._to_motion(places[sample])
                end = begin + METRES_A_NEWTON * forces[sample] @ (self._turn / trial.metres)
                if np.isfinite(end).all():
                    lines.append(StagePath(placement.to_stage(np.stack([begin, end])), FORCE_COLOUR, np.ones(2)))
        return lines

    def _to_motion(self, points: FloatArray) -> FloatArray:
        return np.asarray(points @ self._turn - self._origin)


class RecordingView:
    """Displayed optical recording, with a cache of its data."""

    def __init__(self, changed: Callable[[], object]) -> None:
        """``changed`` is called when the view must be drawn again."""
        self.marked: Collection[str] = ()
        """Bare labels that stand out, and are shown with their names."""
        self.named = False
        """True if every marker is shown with its name."""
        self._changed = changed
        self._made: RecordingOfPerformer | None = None

    def set_marked(self, labels: Collection[str]) -> None:
        """Highlight markers by their labels without subject."""
        self.marked = tuple(labels)
        self._changed()

    def set_named(self, all_of_them: bool) -> None:
        """Show the labels of all markers, or only of highlighted ones."""
        self.named = all_of_them
        self._changed()

    def at(self, document: Document, posed: Mapping[str, PosedPerformer], *, shown: bool) -> MarkerFrame | None:
        """Recording to be drawn: a selected capture without a body; else, if ``shown`` or a marker is highlighted, the
        source of the active performer's motion. None if there is none.
        """
        bare = markers_only_capture(document)
        if bare is not None:
            return self._by(bare).at(round(document.playhead.time * bare.frame_rate), Placement())
        pose = posed.get(document.active_performer_id or "")
        capture = recorded_of(document, pose)
        if pose is None or capture is None or not (shown or self.marked):
            return None
        return self._by(capture).at(pose.row + pose.motion.first_frame, pose.placement)

    def _by(self, capture: Capture) -> RecordingOfPerformer:
        if self._made is None or self._made.capture is not capture:
            self._made = RecordingOfPerformer(capture)
        return self._made


def markers_only_capture(document: Document) -> Capture | None:
    """Selected capture if it has markers and no body, else None."""
    chosen = document.selection.of("captures")
    capture = document.project.captures.get(chosen[-1]) if chosen else None
    return capture if capture is not None and capture.markers is not None and capture.body_map is None else None


def recorded_of(document: Document, pose: PosedPerformer | None) -> Capture | None:
    """Optical capture of a performer's motion; None if the capture has no markers."""
    motion = document.project.motions.get(pose.motion_id or "") if pose else None
    capture = document.project.captures.get(motion.capture_id) if motion else None
    return capture if capture is not None and capture.markers is not None and capture.body_map is not None else None


def _pushes(trial: Trial, index: int) -> tuple[FloatArray, FloatArray] | None:
    """Centre of pressure in metres and ground reaction force in newtons, per sample, of a force plate; None if they are
    not recorded.
    """
    plate = trial.plates[index]
    newtons = plate.channels and trial.analog.units[plate.channels[0]].lower().startswith("n")
    return plate_reactions(trial, plate) if newtons and len(trial.analog.samples) else None
