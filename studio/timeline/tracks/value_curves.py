"""Curve editor: animation curves of keyed channels with keys, tangents and handles."""

from collections.abc import Hashable, Iterable, Iterator
from dataclasses import dataclass
from itertools import groupby
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pyqtgraph.functions import arrayToQPolygonF
from PySide6.QtCore import QPointF, QRect, QRectF, Qt
from PySide6.QtGui import QColor, QPainter

from studio.document import colours
from studio.document.channels import Channel, TangentSide, channels_of, components_at, handle_of, key_values, values_at
from studio.document.keyed_fields import (
    Keyed,
    KeyedField,
    KeyRef,
    all_to_stage,
    counted_in,
    keyed_value,
    selected_fields,
    to_stage,
)
from studio.timeline.shown import ROW_LABEL_WIDTH, RowContext, clipped_span
from studio.timeline.tracks.brush import font, hairline, paint_dot, paint_key, translucent

FloatArray = NDArray[np.float64]

CURVE_KEY_GRAB_PIXELS = 7.0
"""Pixels within which a key or a handle is taken hold of."""
NO_KEYS_HINT = "Select an animated item, or use Edit > Set key"
CURVE_SAMPLE_PIXELS = 2.0
"""Pixels between the points of a curve."""
CURVE_FRAME_MARGIN = 0.12
"""Fraction of the height left free above and below framed curves."""
MIN_VALUE_SPAN = {"m": 0.05, "cm": 5.0, "in": 2.0, "°": 5.0, "×": 0.05, "": 1.0}
"""Minimum range of values that is framed, by unit."""
CHANNEL_COLOURS = {
    "x": "#E4706A",
    "y": "#7FBF6A",
    "z": "#6A9BE4",
    "heading": "#6A9BE4",
    "pitch": "#7FBF6A",
    "roll": "#E4706A",
}


class HandleRef(NamedTuple):
    """Handle of a tangent, or the key itself if ``side`` is None."""

    channel: Channel
    place: int
    side: TangentSide | None = None

    @property
    def key(self) -> KeyRef:
        """Reference to the key."""
        return KeyRef(self.channel.field, self.place)


@dataclass(frozen=True)
class ValueRange:
    """Values at the bottom and at the top of the plot."""

    low: float
    high: float


class ValueCurves:
    """Channels of the curve editor, and the visible value range of each unit, or of each channel if ``normalized``."""

    def __init__(self) -> None:
        self.shown = False
        self.normalized = False
        self.ranges: dict[Hashable, ValueRange] = {}
        self.active: Channel | None = None
        """The channel that was taken hold of last, whose value the field shows."""

    def channels(self, shown: RowContext) -> list[tuple[Channel, Keyed]]:
        """Channels of the selected entities, with their keyed values."""
        fields = selected_fields(shown.project, shown.document.selection.items)
        return [(channel, value) for field, value in fields.items() for channel in channels_of(field, value)]

    def frame(self, shown: RowContext, selected: bool) -> None:
        """Fit the time and value range of all keys into view, or with ``selected`` those of the selected keys."""
        keys = shown.document.keys.by_field() if selected else {}
        found: dict[Hashable, list[float]] = {}
        units: dict[Hashable, str] = {}
        times: list[float] = []
        for channel, keyed in self.channels(shown):
            values = key_values(channel, keyed)
            if keys and channel.field not in keys:
                continue
            chosen = list(keys.get(channel.field, range(len(values))))
            scale = self._scale(channel)
            units[scale] = channel.unit
            found.setdefault(scale, []).extend([*values[chosen].tolist(), *_baseline(channel)])
            if keys:
                times += [stage_time(shown, channel.field, keyed.times[place]) for place in chosen]
            else:
                span = np.linspace(keyed.times[0], keyed.times[-1], 200)
                found[scale].extend(values_at(channel, keyed, span).tolist())
        self.ranges |= {scale: _framed(every, units[scale]) for scale, every in found.items()}
        if len({*times}) > 1:
            shown.axis.show(min(times), max(times))
        elif times:
            shown.axis.reveal(times[0])

    def set_normalized(self, normalized: bool) -> None:
        """Scale each channel to the full height, or show channels of the same unit on one scale."""
        self.normalized = normalized
        self.ranges.clear()

    def _scale(self, channel: Channel) -> Hashable:
        """Key in the table of value ranges: the channel if normalized, else its unit."""
        return channel if self.normalized else channel.unit

    def range_of(self, shown: RowContext, channel: Channel) -> ValueRange:
        """Visible value range of a channel; that of all values until curves are framed."""
        scale = self._scale(channel)
        if scale not in self.ranges:
            values = [
                value
                for other, keyed in self.channels(shown)
                if self._scale(other) == scale
                for value in (
                    *values_at(other, keyed, np.linspace(keyed.times[0], keyed.times[-1], 200)).tolist(),
                    *_baseline(other),
                )
            ]
            self.ranges[scale] = _framed(values, channel.unit)
        return self.ranges[scale]

    def zoom(self, factor: float, share: float) -> None:
        """Magnify the values by ``factor`` about the fraction ``share`` of the height, from the bottom."""
        for scale, old in self.ranges.items():
            fixed, span = old.low + share * (old.high - old.low), (old.high - old.low) / factor
            self.ranges[scale] = ValueRange(fixed - share * span, fixed + (1.0 - share) * span)

    def scroll(self, share: float) -> None:
        """Scroll the values up by the fraction ``share`` of the height."""
        for scale, old in self.ranges.items():
            step = share * (old.high - old.low)
            self.ranges[scale] = ValueRange(old.low - step, old.high - step)

    def y_of(self, shown: RowContext, area: QRect, channel: Channel, value: float) -> float:
        """Vertical pixel of a value."""
        return float(self._ys_of(shown, area, channel, np.float64(value)))

    def _ys_of(self, shown: RowContext, area: QRect, channel: Channel, values: FloatArray | np.float64) -> FloatArray:
        """Vertical pixels of values, of the same shape."""
        span = self.range_of(shown, channel)
        return np.asarray(area.bottom() - (values - span.low) / (span.high - span.low) * area.height())

    def value_of(self, shown: RowContext, area: QRect, channel: Channel, pixels: float) -> float:
        """Difference in value for a number of pixels upwards."""
        span = self.range_of(shown, channel)
        return pixels / area.height() * (span.high - span.low)

    def point(self, shown: RowContext, area: QRect, channel: Channel, keyed: Keyed, index: int) -> QPointF:
        """Pixel position of a key."""
        value = float(key_values(channel, keyed)[index])
        x = shown.axis.x_of_time(stage_time(shown, channel.field, keyed.times[index]))
        return QPointF(x, self.y_of(shown, area, channel, value))

    def handle_point(self, shown: RowContext, area: QRect, handle: HandleRef, keyed: Keyed) -> QPointF | None:
        """Pixel position of the end of a tangent handle; None if there is none."""
        assert handle.side is not None
        found = handle_of(handle.channel, keyed, handle.place, handle.side)
        if found is None:
            return None
        seconds, value = found
        x = shown.axis.x_of_time(stage_time(shown, handle.channel.field, keyed.times[handle.place] + seconds))
        there = float(key_values(handle.channel, keyed)[handle.place]) + value
        return QPointF(x, self.y_of(shown, area, handle.channel, there))

    def handles(self, shown: RowContext, area: QRect) -> Iterator[tuple[HandleRef, QPointF]]:
        """Tangent handles of the selected keys, with their pixel positions."""
        selected = shown.document.keys.by_field()
        for channel, keyed in self.channels(shown) if selected else ():
            for place in selected.get(channel.field, ()):
                for side in TangentSide:
                    handle = HandleRef(channel, place, side)
                    point = self.handle_point(shown, area, handle, keyed)
                    if point is not None:
                        yield handle, point

    def points(self, shown: RowContext, area: QRect) -> Iterator[tuple[HandleRef, QPointF]]:
        """Keys of all channels, with their pixel positions."""
        for channel, keyed in self.channels(shown):
            project, clip = shown.project, shown.subject.clip
            xs = shown.axis.xs_of_times(all_to_stage(project, clip, channel.field, keyed.times))
            ys = self._ys_of(shown, area, channel, key_values(channel, keyed))
            for index, (x, y) in enumerate(zip(xs.tolist(), ys.tolist(), strict=True)):
                yield HandleRef(channel, index), QPointF(x, y)

    def hit(self, shown: RowContext, area: QRect, position: QPointF) -> HandleRef | None:
        """Handle, or else key, under the mouse: the nearest one, in the active channel first. None if there is none."""
        for candidates in (self.handles(shown, area), self.points(shown, area)):
            near = [
                (each, at) for each, at in candidates if clipped_span(position, at.x(), at.y(), CURVE_KEY_GRAB_PIXELS)
            ]
            if near:
                return min(
                    near, key=lambda each: (each[1] - position).manhattanLength() - (each[0].channel == self.active)
                )[0]
        return None

    def paint(self, painter: QPainter, row: QRect, shown: RowContext) -> None:
        """Paint the curves, their keys, and the handles of selected keys."""
        area = plot_area(row)
        channels = self.channels(shown)
        painter.save()
        painter.setClipRect(area.adjusted(0, -4, 0, 3), Qt.ClipOperation.IntersectClip)
        if not channels:
            painter.setFont(font(12))
            painter.setPen(QColor(colours.TEXT_THIRD))
            painter.drawText(area, Qt.AlignmentFlag.AlignCenter, NO_KEYS_HINT)
        else:
            self._paint_scale(
                painter, area, shown, next((each for each, _ in channels if each == self.active), channels[0][0])
            )
        for _, group in groupby(channels, key=lambda each: each[0].field):
            self._paint_field(painter, area, shown, list(group))
        points = dict(self.points(shown, area))
        for handle, end in self.handles(shown, area):
            _paint_handle(painter, points[handle._replace(side=None)], end)
        for handle, point in points.items():
            paint_key(painter, point, colour_of(handle.channel), handle.key in shown.document.keys)
        _paint_legend(painter, area, [channel for channel, _ in channels])
        painter.restore()

    def _paint_scale(self, painter: QPainter, area: QRect, shown: RowContext, channel: Channel) -> None:
        """Paint grid lines at round values of a channel, with their numbers."""
        span = self.range_of(shown, channel)
        step = 10.0 ** np.floor(np.log10((span.high - span.low) / 2.0))
        step *= 2.0 if (span.high - span.low) / step > 8.0 else 1.0
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)
        painter.setFont(font(10))
        for value in (np.arange(np.ceil(span.low / step), np.floor(span.high / step) + 1) + 0.0) * step:
            y = round(self.y_of(shown, area, channel, float(value)))
            painter.fillRect(area.left(), y, area.width(), 1, translucent(colours.EDGE, 0.7))
            painter.setPen(QColor(colours.TEXT_THIRD))
            place = QRect(area.right() - 70, y - 15, 64, 14)
            painter.drawText(place, Qt.AlignmentFlag.AlignRight, f"{value:.4g} {channel.unit}".strip())

    def _paint_field(
        self, painter: QPainter, area: QRect, shown: RowContext, channels: list[tuple[Channel, Keyed]]
    ) -> None:
        """Paint the curves of all channels of one field, which are evaluated together."""
        field, keyed = channels[0][0].field, channels[0][1]
        xs = np.arange(area.left(), area.right() + CURVE_SAMPLE_PIXELS, CURVE_SAMPLE_PIXELS)
        stage = shown.axis.start + (xs - shown.axis.left) / shown.axis.scale
        times = np.unique(np.concatenate([own_times(shown, field, stage), keyed.times]))
        components = components_at(keyed, times)
        counted = counted_in(shown.project, shown.subject.clip, field)
        seen = times if counted is None else counted.stage_seconds(times, shown.project.frame_rate_of(counted))
        xs = shown.axis.left + (seen - shown.axis.start) * shown.axis.scale
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        for channel, _ in channels:
            ys = self._ys_of(shown, area, channel, components[:, channel.component] * channel.factor)
            painter.setPen(hairline(colour_of(channel), 2.0 if channel == self.active else 1.4))
            painter.drawPolyline(arrayToQPolygonF(xs, np.clip(ys, -1e5, 1e5)))


def _paint_handle(painter: QPainter, key: QPointF, end: QPointF) -> None:
    """Draw the handle of a tangent from its key."""
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setPen(hairline(translucent(colours.SELECTED_HANDLE, 0.8), 1.0))
    painter.drawLine(key, end)
    paint_dot(painter, end, 3.5, colours.SELECTED_HANDLE, colours.PANEL)


def plot_area(row: QRect) -> QRect:
    """Rectangle of the curves within the graph."""
    return row.adjusted(ROW_LABEL_WIDTH, 10, 0, -10)


def colour_of(channel: Channel) -> str:
    """Colour of a channel's curve: that of its axis, or a light one."""
    return CHANNEL_COLOURS.get(channel.name, colours.TEXT_SECOND)


def stage_time(shown: RowContext, field: KeyedField, seconds: float) -> float:
    """Stage time in seconds of a time of a field."""
    return to_stage(shown.project, shown.subject.clip, field, seconds)


def own_times(shown: RowContext, field: KeyedField, stage: ArrayLike) -> FloatArray:
    """Times of a field in seconds at the stage times ``stage``, one or many."""
    seconds = np.asarray(stage, dtype=np.float64)
    counted = counted_in(shown.project, shown.subject.clip, field)
    return seconds if counted is None else counted.motion_seconds(seconds, shown.project.frame_rate_of(counted))


def value_in(shown: RowContext, channel: Channel) -> Keyed | None:
    """Keyed value of a channel; None if it no longer has keys."""
    return keyed_value(shown.project, channel.field)


def _baseline(channel: Channel) -> tuple[float, ...]:
    return () if channel.baseline is None else (channel.baseline,)


def _framed(values: Iterable[float], unit: str) -> ValueRange:
    every = np.array([*values]) if values else np.array([0.0, 1.0])
    every = every if len(every) else np.array([0.0, 1.0])
    low, high = float(every.min()), float(every.max())
    span = max(high - low, MIN_VALUE_SPAN.get(unit, 0.1))
    middle = (low + high) / 2.0
    return ValueRange(middle - span * (0.5 + CURVE_FRAME_MARGIN), middle + span * (0.5 + CURVE_FRAME_MARGIN))


def _paint_legend(painter: QPainter, area: QRect, channels: list[Channel]) -> None:
    """Paint the names of the channels in their colours."""
    painter.setFont(font(11))
    x = float(area.left() + 6)
    for name, colour in dict.fromkeys((f"{each.name} {each.unit}".strip(), colour_of(each)) for each in channels):
        painter.setPen(QColor(colour))
        width = painter.fontMetrics().horizontalAdvance(name)
        painter.drawText(QRectF(x, area.top() - 8, width + 2.0, 16), Qt.AlignmentFlag.AlignVCenter, name)
        x += width + 12
