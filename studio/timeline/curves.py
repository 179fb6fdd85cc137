"""Graphs of measured quantities over time: speeds, heights, angles, foot sliding, balance, and constraint errors."""

import logging
from dataclasses import dataclass
from enum import StrEnum
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyLayout
from studio.core.captures.contacts import ContactInterval
from studio.core.grounds.ground import Ground
from studio.core.quality.motion_measures import ADDED_MEASURES, MotionMeasure
from studio.core.solver.performers.rows import timing_of
from studio.core.solver.request import AdaptedMotion
from studio.core.stage.project import Project
from studio.engine.residual_measures import LENGTH_MEASURE, Measure, measure_of
from studio.engine.residuals import residuals_on
from studio.timeline.axis import AXIS_MARGIN, TimeAxis
from studio.timeline.shown import RowContext
from studio.timeline.strip_states import strip_of
from studio.timeline.subject import ActiveMotion, BodyOnTimeline

FloatArray = NDArray[np.float64]

BINS_PER_PIXEL = 1
"""Bins per pixel for a curve with many frames per pixel."""


class Quantity(StrEnum):
    """Quantity that can be plotted, with its label."""

    FOOT_SPEED = "Foot speed"
    LEFT_FOOT_SPEED = "Left foot speed"
    RIGHT_FOOT_SPEED = "Right foot speed"
    LEFT_FOOT_HEIGHT = "Left foot height"
    RIGHT_FOOT_HEIGHT = "Right foot height"
    KNEE_SPEED = "Knee speed"
    LEFT_KNEE_FLEXION = "Left knee flexion"
    RIGHT_KNEE_FLEXION = "Right knee flexion"
    LEFT_ELBOW_FLEXION = "Left elbow flexion"
    RIGHT_ELBOW_FLEXION = "Right elbow flexion"
    COM_HEIGHT = "CoM height"
    COM_SPEED = "CoM speed"
    SLIDE = "Foot sliding (in contact)"
    SKATE = "Foot sliding (near ground)"
    OFF_SUPPORT = "CoM outside support"
    ERROR = "Error"

    def unit(self, shown: RowContext) -> str:
        """Unit of the plotted values; for errors the unit of the plotted constraint."""
        if self is Quantity.ERROR:
            return error_measure(shown).sign.strip()
        return _UNITS.get(self, "m/s")

    @property
    def asks_document(self) -> bool:
        """True if the quantity depends not only on poses but also on contacts, the ground or a constraint."""
        return self in _ASKING_DOCUMENT


_HEIGHTS = Quantity.LEFT_FOOT_HEIGHT, Quantity.RIGHT_FOOT_HEIGHT
_FLEXIONS = (
    *(Quantity.LEFT_KNEE_FLEXION, Quantity.RIGHT_KNEE_FLEXION),
    *(Quantity.LEFT_ELBOW_FLEXION, Quantity.RIGHT_ELBOW_FLEXION),
)
_ASKING_DOCUMENT = (
    Quantity.ERROR,
    Quantity.SLIDE,
    Quantity.SKATE,
    Quantity.OFF_SUPPORT,
    Quantity.COM_HEIGHT,
    *_HEIGHTS,
)
_UNITS = {
    **dict.fromkeys((Quantity.SLIDE, Quantity.SKATE, Quantity.OFF_SUPPORT), "mm"),
    **dict.fromkeys((Quantity.COM_HEIGHT, *_HEIGHTS), "m"),
    **dict.fromkeys(_FLEXIONS, "°"),
    Quantity.KNEE_SPEED: "°/s",
}
"""Units of the quantities that are not speeds in metres per second."""


@dataclass(frozen=True)
class PlugInQuantity:
    """Quantity measured by a plug-in; if that fails, there is no curve."""

    measure: MotionMeasure
    asks_document: ClassVar[bool] = False

    @property
    def value(self) -> str:
        """Label of the quantity."""
        return self.measure.title

    def unit(self, _shown: RowContext) -> str:
        """Unit of the plotted values."""
        return self.measure.unit


Plotted = Quantity | PlugInQuantity


def plotted_quantities() -> tuple[Plotted, ...]:
    """All quantities that can be plotted."""
    return (*Quantity, *map(PlugInQuantity, ADDED_MEASURES.values()))


@dataclass(frozen=True, eq=False)
class Curve:
    """Values (F,) of a quantity for one performer at the stage times (F,) in seconds."""

    name: str
    colour: str
    times: FloatArray
    values: FloatArray
    top: float
    """Maximum of the values, at least 0."""

    def at(self, seconds: float) -> float:
        """Value of the frame nearest to the stage time ``seconds``."""
        return float(self.values[np.argmin(np.abs(self.times - seconds))])


def foot_speed(adapted: AdaptedMotion, sides: tuple[int, ...] = (0, 1)) -> FloatArray:
    """(F,) speed of the ball of the faster foot in metres per second."""
    layout = BodyLayout(len(adapted.morphology.spine))
    return _speed(adapted.positions[:, [layout.toe_point(side) for side in sides]], adapted.frame_rate)


def _speed(points: FloatArray, frame_rate: float) -> FloatArray:
    """(F,) speed of the fastest of ``points`` (F, P, 3) in metres per second, by central differences."""
    if len(points) < 2:
        return np.zeros(len(points))
    steps = np.concatenate(
        [2.0 * (points[1:2] - points[:1]), points[2:] - points[:-2], 2.0 * (points[-1:] - points[-2:-1])]
    )
    squares = np.einsum("fsi,fsi->fs", steps, steps).max(axis=1)
    return np.asarray(0.5 * frame_rate * np.sqrt(squares))


@dataclass(frozen=True, eq=False)
class CurveQuery:
    """Immutable input of a curve, which a worker thread may hold."""

    project: Project
    subject: ActiveMotion
    quantity: Plotted
    constraint_id: str | None
    """Id of the constraint whose error is plotted; None for other quantities."""

    def curve(self, body: BodyOnTimeline, adapted: AdaptedMotion) -> Curve | None:
        """Curve of a performer's adapted motion; None if the quantity does not apply to it."""
        values = self._values(body.performer_id, adapted)
        if values is None:
            return None
        times = self._times(body.performer_id, adapted)
        return Curve(body.name, body.colour, times, values, float(values.max(initial=0.0)))

    def _times(self, performer_id: str, adapted: AdaptedMotion) -> FloatArray:
        """(F,) stage times in seconds of the curve's values."""
        if self.quantity is Quantity.ERROR and self.constraint_id:
            missed = residuals_on(self.project, performer_id, adapted, self.constraint_id)
            if missed is not None:
                return missed.times
        timing = timing_of(self.project, self.project.performers[performer_id])
        return timing.begin + (adapted.first_frame + np.arange(adapted.frame_count)) / timing.frame_rate

    def _values(self, performer_id: str, adapted: AdaptedMotion) -> FloatArray | None:
        if isinstance(self.quantity, PlugInQuantity):
            try:
                return self.quantity.measure.of(adapted)
            except ValueError as error:
                logging.getLogger(__name__).warning("%s", error)
                return None
        match self.quantity:
            case Quantity.FOOT_SPEED:
                return foot_speed(adapted)
            case Quantity.LEFT_FOOT_SPEED:
                return foot_speed(adapted, (0,))
            case Quantity.RIGHT_FOOT_SPEED:
                return foot_speed(adapted, (1,))
            case Quantity.ERROR:
                strip = (
                    strip_of(self.project, performer_id, adapted, self.constraint_id) if self.constraint_id else None
                )
                return None if strip is None else np.nan_to_num(strip.errors) * strip.measure.factor
            case Quantity.SLIDE:
                return self._slide(performer_id, adapted)
            case Quantity.SKATE:
                return self._skate(performer_id, adapted)
            case Quantity.OFF_SUPPORT:
                return self._beyond_support(adapted)
        return self._measured(performer_id, adapted)

    def _measured(self, performer_id: str, adapted: AdaptedMotion) -> FloatArray:
        """(F,) values of a height, an angle, or a speed of the knees or the centre of mass."""
        from studio.core.quality import metrics  # not before a result is there: it loads kernels

        match self.quantity:
            case Quantity.LEFT_FOOT_HEIGHT | Quantity.RIGHT_FOOT_HEIGHT:
                values = metrics.foot_heights(adapted, self._ground(performer_id))[self._side]
            case Quantity.KNEE_SPEED:
                values = np.degrees(metrics.knee_speeds(adapted).max(axis=0))
            case Quantity.LEFT_KNEE_FLEXION | Quantity.RIGHT_KNEE_FLEXION:
                values = np.degrees(metrics.knee_flexions(adapted)[self._side])
            case Quantity.LEFT_ELBOW_FLEXION | Quantity.RIGHT_ELBOW_FLEXION:
                values = np.degrees(metrics.elbow_flexions(adapted)[self._side])
            case Quantity.COM_HEIGHT:
                mass = metrics.centre_of_mass(adapted)
                values = mass[:, 2] - self._ground(performer_id).height_at(mass)
            case _:
                values = _speed(metrics.centre_of_mass(adapted)[:, None], adapted.frame_rate)
        return np.asarray(values)

    @property
    def _side(self) -> int:
        """Side of the body in the quantity's name: 0 left, 1 right."""
        return int(self.quantity.value.startswith("Right"))

    def _contacts(self, adapted: AdaptedMotion) -> tuple[ContactInterval, ...]:
        if adapted.composite is not None:
            return adapted.contacts
        return tuple(self.project.contacts_of(self.subject.motion_id).values())

    def _slide(self, performer_id: str, adapted: AdaptedMotion) -> FloatArray:
        """(F,) displacement in millimetres of the contact point that has moved most since its contact began."""
        from studio.core.quality.contact_tracks import contact_tracks  # as above

        slides, _ = contact_tracks(adapted, self._contacts(adapted), self._ground(performer_id))
        return np.asarray(1000.0 * np.nan_to_num(slides).max(axis=0))

    def _skate(self, performer_id: str, adapted: AdaptedMotion) -> FloatArray:
        """(F,) distance in millimetres travelled by the foot that has travelled farther since it came near the
        ground.
        """
        from studio.core.quality.metrics import skate_distances  # as above

        return np.asarray(1000.0 * skate_distances(adapted, self._ground(performer_id)).max(axis=0))

    def _ground(self, performer_id: str) -> Ground:
        """Ground of the stage, in the space of a performer's motion."""
        performer = self.project.performers[performer_id]
        return self.project.ground.seen_from(performer.position, performer.heading)

    def _beyond_support(self, adapted: AdaptedMotion) -> FloatArray:
        """(F,) distance in millimetres of the centre of mass from the support polygon; 0 inside, and without
        contacts.
        """
        from studio.core.solver.grounding.support_polygon import (  # as above
            mass_path,
            standing_mask,
            support_margins,
            support_polygons,
        )

        stop = adapted.first_frame + adapted.frame_count
        stands = standing_mask(self._contacts(adapted), stop)[:, adapted.first_frame :]
        areas = support_polygons(adapted.positions[:], adapted.rotations[:], stands, adapted.morphology)
        margins = support_margins(areas, mass_path(adapted.positions[:], adapted.morphology)[:, :2])
        return np.asarray(1000.0 * np.maximum(-np.nan_to_num(margins), 0.0))


def plotted_constraint(shown: RowContext) -> str | None:
    """Id of the selected constraint, else of the first one; None without constraints."""
    own = shown.project.constraints_of(shown.subject.motion_id)
    selected = [key for key in shown.document.selection.of("constraints") if key in own]
    return next(iter((*reversed(selected), *own)), None)


def error_measure(shown: RowContext) -> Measure:
    """Unit and scale of the plotted constraint errors."""
    constraint_id = plotted_constraint(shown)
    return measure_of(shown.project.constraints[constraint_id]) if constraint_id else LENGTH_MEASURE


def displayed_curve(curve: Curve, axis: TimeAxis) -> tuple[FloatArray, FloatArray]:
    """Times and values of a curve in the visible range, plus one frame on each side.

    If a pixel has many frames, as in an hour-long capture, they are represented by their minimum and maximum.
    """
    first, last = np.searchsorted(curve.times, [axis.time_at(axis.left), axis.time_at(axis.right + AXIS_MARGIN)])
    seen = slice(max(int(first) - 1, 0), int(last) + 1)
    times, values = curve.times[seen], curve.values[seen]
    size = int(len(times) / (BINS_PER_PIXEL * axis.width)) if axis.width else 0
    if size < 2:
        return times, values
    pieces = len(times) // size
    heights = values[: pieces * size].reshape(pieces, size)
    extremes = np.stack([heights.min(axis=1), heights.max(axis=1)], axis=1).reshape(-1)
    return (
        np.append(np.repeat(times[: pieces * size : size], 2), times[pieces * size :]),
        np.append(extremes, values[pieces * size :]),
    )
