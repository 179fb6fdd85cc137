"""Helpers for tests of strikes in the window: where a blow lands, on the poses that are shown."""

import numpy as np

from studio.core.constraints.position import PositionConstraint
from studio.core.solver.performers.rows import timing_of
from studio.core.stage.placement import Placement
from studio.engine.posed_performer import row_at


def struck_place(window, key):
    """Place on the stage of the body's hit point as it hits, and the time of it."""
    document = window.bench.document
    made = list(document.project.constraints.values())[-1]
    assert isinstance(made, PositionConstraint)
    performer, adapted = document.project.performers[key], window.bench.live.result(key)
    clip = performer.clips[-1]
    assert made.scope.clip_id == clip.id
    rate = document.project.frame_rate_of(clip)
    time = clip.start + 0.5 * (made.activation.full + made.activation.full_end) - clip.first / rate
    row = row_at(adapted, timing_of(document.project, performer), time)
    segment = adapted.morphology.layout.segment_of_part(made.point.part)
    layout = adapted.morphology.layout
    origin = (layout.distal_points() if made.point.at_end else layout.proximal_points())[segment]
    place = adapted.positions[row, origin] + adapted.rotations[row, segment] @ np.array(made.point.offset)
    return Placement.of(performer).to_stage(place), time
