"""Whole stage for export to one file: all performers and props with common frames, at their positions."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError
from studio.core.mesh.appearance import Material
from studio.core.names import readable_name
from studio.core.rotations import from_matrix, sign_continuous
from studio.core.solver.performers.staged_performances import Performance
from studio.core.stage.placement import Placement
from studio.core.stage.project import Project
from studio.core.stage.prop import Prop
from studio.core.stage.prop_shapes import PROP_COLOUR, Surface, prop_surface
from studio.core.stage.saved_camera import SavedCamera
from studio.io.export import Take, format_for
from studio.io.export_options import ExportOptions, frame_times
from studio.io.registry import Format, Progress
from studio.io.staged_export import take_of_performer

if TYPE_CHECKING:
    from studio.core.solver.performers.prop_tracks import Hands

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ExportedProp:
    """Prop in every frame: positions ``places`` (F, 3) of its centre and its ``rotations`` (F, 4) on the stage."""

    name: str
    surface: Surface
    places: FloatArray
    rotations: FloatArray

    @property
    def material(self) -> Material:
        """Material of the prop."""
        return Material(self.name, PROP_COLOUR)

    @property
    def is_still(self) -> bool:
        """True if the prop never moves."""
        return not (np.ptp(self.places, axis=0).any() or np.ptp(self.rotations, axis=0).any())


@dataclass(frozen=True, eq=False)
class ExportedStage:
    """All performers and props of a stage, in the same ``frame_count`` frames; names are unique."""

    name: str
    takes: tuple[Take, ...]
    props: tuple[ExportedProp, ...]
    frame_rate: float
    frame_count: int
    cameras: tuple[SavedCamera, ...] = ()

    @property
    def names(self) -> list[str]:
        """Names of all performers, then of all props, then of all cameras."""
        return (
            [each.name for each in self.takes]
            + [each.name for each in self.props]
            + [each.name for each in self.cameras]
        )


def exported_stage(
    project: Project, performances: Mapping[str, Performance], options: ExportOptions, path: Path
) -> ExportedStage:
    """Stage to write to ``path``: at its own frame rate from its first second to its last, or as ``options`` set these.

    Performers hold still before their begin and after their end. Raises StudioError.
    """
    options.check(path)
    if not performances:
        raise StudioError("No visible character has a motion: there is no stage to export.")
    timings = {key: each.composite.timing for key, each in performances.items()}
    rate = options.frame_rate or max(timing.frame_rate for timing in timings.values())
    begin = min(timing.start for timing in timings.values()) if options.begin is None else options.begin
    end = max(timing.end for timing in timings.values()) if options.end is None else options.end
    if end < begin:
        raise StudioError(f"The stage ends at second {end:.2f}, before the range begins. Choose another range.")
    seconds = frame_times(begin, end, rate)
    names = _unique(
        [project.performers[key].name for key in performances]
        + [each.name for each in project.props.values()]
        + [each.name for each in project.cameras.values()]
    )
    takes = []
    for (key, performance), name in zip(performances.items(), names, strict=False):
        take = take_of_performer(project, key, performance, along=options.carries(path))
        take = replace(take, capture=replace(take.capture, name=name))
        takes.append(options.applied_over(take, seconds, rate, path))
    from studio.core.solver.performers.prop_tracks import Holder  # here: it loads kernels

    hands: dict[str, Hands] = {
        key: Holder(
            each.adapted,
            timings[key].frames_at(seconds) - each.adapted.first_frame,
            Placement.of(project.performers[key]),
            timing=timings[key],
        )
        for key, each in performances.items()
    }
    props = tuple(
        _prop(name, prop, seconds, hands)
        for name, prop in zip(names[len(takes) :], project.props.values(), strict=False)
    )
    cameras = tuple(
        replace(camera, name=name)
        for name, camera in zip(names[len(takes) + len(props) :], project.cameras.values(), strict=True)
    )
    return ExportedStage(readable_name(path.stem), tuple(takes), props, rate, len(seconds), cameras)


def write_stage(stage: ExportedStage, path: Path, progress: Progress = lambda share, text: None) -> Format:
    """Write a stage in the format of the suffix of ``path``, and return the format. Raises StudioError."""
    chosen = format_for(path, "stage_writer")
    chosen.write_stage(path, stage, progress)
    return chosen


def _prop(name: str, prop: Prop, seconds: FloatArray, hands: "Mapping[str, Hands]") -> ExportedProp:
    from studio.core.solver.performers.prop_tracks import stage_track

    track = stage_track(prop, seconds, hands)
    places = np.broadcast_to(track.positions, (len(seconds), 3))
    rotations = sign_continuous(from_matrix(np.broadcast_to(track.rotations, (len(seconds), 3, 3))))
    return ExportedProp(name, prop_surface(prop), places, rotations)


def _unique(names: Iterable[str]) -> list[str]:
    """Names, with numbers added to duplicates."""
    found: list[str] = []
    for name in names:
        unique, number = name, 1
        while unique in found:
            number += 1
            unique = f"{name} {number}"
        found.append(unique)
    return found
