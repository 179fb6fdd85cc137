"""Result of adapting a performer: positions of its body's points, and residuals of its constraints."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.base import BodyPoint
from studio.core.quality.metrics import MotionPeaks
from studio.core.solver.adapt import body_point_positions, grounded_motion
from studio.core.solver.performers.staged_performances import Performance
from studio.core.solver.source import motion_on_body
from studio.core.stage.placement import Placement
from studio.core.stage.project import Project
from studio.jobs.adapt_report import quality_record

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Adapted:
    """Motion of a performer on the stage, adapted to its body, with F frames."""

    project: Project
    performer_id: str
    performance: Performance

    @property
    def name(self) -> str:
        """Name of the performer."""
        return self.project.performers[self.performer_id].name

    @property
    def frame_rate(self) -> float:
        """Frames per second."""
        return self.performance.composite.timing.frame_rate

    @cached_property
    def times(self) -> FloatArray:
        """Stage times (F,) of the frames in seconds."""
        timing = self.performance.composite.timing
        return timing.start + np.arange(self.performance.adapted_on_stage.frame_count) / self.frame_rate

    def frame_at(self, time: float) -> int:
        """Frame nearest to stage second ``time``."""
        return int(np.argmin(np.abs(self.times - time)))

    def place_of(self, point: BodyPoint) -> FloatArray:
        """Positions (F, 3) of a point of the body, in metres on the stage."""
        placement = Placement.of(self.project.performers[self.performer_id])
        return placement.to_stage(body_point_positions(point, self.performance.adapted_on_stage))

    @property
    def residuals(self) -> dict[str, FloatArray]:
        """Residuals (F,) of each constraint by its id, in metres or radians; NaN where it is inactive.

        A constraint that applies to several clips of the performer, or to repeats of one, has the residual of the
        playing clip.
        """
        found: dict[str, FloatArray] = {}
        for asked, row in zip(
            self.performance.clip_constraints, self.performance.adapted_on_stage.residuals, strict=True
        ):
            earlier = found.get(asked.constraint_id)
            found[asked.constraint_id] = row if earlier is None else np.where(np.isnan(row), earlier, row)
        return found

    @cached_property
    def report(self) -> dict[str, Any]:
        """Figures that ``adapt`` writes to ``report.json``: foot slide, penetration, constraints met, ..."""
        request, composite = self.performance.request, self.performance.composite
        source = motion_on_body(composite.motion, request.actor or request.morphology.first_frame_body)
        peaks = MotionPeaks.of_source(source, self.performance.adapted_on_stage)
        return quality_record(
            grounded_motion(request), request, self.performance.adapted_on_stage, peaks, by_frame=False
        )
