"""Keys as diamonds in the tracks: positions, painting, and hit tests."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRect, QRectF
from PySide6.QtGui import QColor, QPainter

from studio.core.curves.activation import ActivationCurve
from studio.core.curves.keyed import Keys
from studio.document import colours
from studio.document.clip_edits import name_of
from studio.document.keyed_fields import (
    Keyed,
    KeyedField,
    KeyRef,
    counted_in,
    fields_of,
    keyed_value,
    selected_fields,
)
from studio.timeline.shown import RowContext, TimelineRow, label_area
from studio.timeline.tracks.brush import KEY_REACH, paint_bar, paint_key, paint_label, translucent
from studio.timeline.tracks.layer import LAYER_INDENT_PX

FloatArray = NDArray[np.float64]

KEY_ROW_HEIGHT = 22
SUMMARY_KIND = "summary"
"""Kind of the dope sheet's track that shows the keys of all others."""
SHEET_KIND = "sheet"
"""Kind of a track of the dope sheet; its id names the keyed field."""
MERGED_KEYS_PX = 3.0
"""Distance in pixels between keys below which they are painted as one bar."""
MERGED_BAR_PX = 3.0
"""Half of the height in pixels of such a bar."""
FIELD_NAMES = {"proportions": "measures"}


def sheet_id(field: KeyedField) -> str:
    """Id of the dope sheet's track of a field."""
    return "/".join(field)


def field_of(row_id: str) -> KeyedField:
    """Keyed field of a dope sheet's track."""
    collection, _, rest = row_id.partition("/")
    entity_id, _, name = rest.rpartition("/")
    return KeyedField(collection, entity_id, name)


def sheet_fields(shown: RowContext) -> dict[KeyedField, Keyed]:
    """Keyed fields in the dope sheet, with their values: those of the selection; without any, those of the whole
    stage.
    """
    chosen = selected_fields(shown.project, shown.document.selection.items)
    if chosen:
        return chosen
    project, performer_id = shown.project, shown.subject.performer_id
    constraints = project.constraints_for(performer_id, shown.subject.clip)
    characters = dict.fromkeys(each.character_id for each in project.performers.values() if each.visible)
    entities = (
        *(("constraints", key, each) for key, each in constraints.items()),
        *(("props", key, each) for key, each in project.props.items()),
        *(("corrections", key, each) for key, each in project.corrections.items()),
        *(("characters", key, project.characters[key]) for key in characters),
        *(("clips", clip.id, clip) for clip in project.performers[performer_id].clips),
    )
    return {field: value for entity in entities for field, value in fields_of(*entity).items()}


def rows_of(shown: RowContext) -> list[tuple[str, str, int]]:
    """Kind, id and height in pixels of the tracks of the dope sheet, the summary first."""
    rows = [(SHEET_KIND, sheet_id(field), KEY_ROW_HEIGHT) for field in sheet_fields(shown)]
    return [(SUMMARY_KIND, "", KEY_ROW_HEIGHT), *rows]


def fields_in(shown: RowContext, row: TimelineRow) -> tuple[KeyedField, ...]:
    """Fields whose keys are painted in a track; an activation is painted as handles instead."""
    match row.kind:
        case "clip":
            clips = shown.project.performers[row.id].clips
            return tuple(field for clip in clips for field in _keys_of(shown, "clips", clip.id))
        case "summary":
            return tuple(sheet_fields(shown))
        case "sheet":
            return (field_of(row.id),)
        case "growth":
            return growth_fields(shown, row.id)
        case "constraints" | "props" | "corrections":
            return _keys_of(shown, row.kind, row.id)
    return ()


def _keys_of(shown: RowContext, collection: str, entity_id: str) -> tuple[KeyedField, ...]:
    found = fields_of(collection, entity_id, shown.project.get(collection, entity_id))
    return tuple(field for field, value in found.items() if not isinstance(value, ActivationCurve))


def stage_times(shown: RowContext, field: KeyedField) -> FloatArray:
    """(K,) stage times in seconds of the keys of a field."""
    value = keyed_value(shown.project, field)
    times = value.seconds if isinstance(value, Keys) else np.array(value.times if value is not None else ())
    counted = counted_in(shown.project, shown.subject.clip, field)
    return times if counted is None else counted.stage_seconds(times, shown.project.frame_rate_of(counted))


def keys_between(shown: RowContext, fields: Iterable[KeyedField], begin: float, end: float) -> tuple[KeyRef, ...]:
    """Keys of ``fields`` between two stage times in seconds."""
    found = []
    for field in fields:
        times = stage_times(shown, field)
        first, last = np.searchsorted(times, begin, "left"), np.searchsorted(times, end, "right")
        found += [KeyRef(field, index) for index in range(int(first), int(last))]
    return tuple(found)


def keys_at(shown: RowContext, row: TimelineRow, area: QRect, point: QPointF) -> tuple[KeyRef, ...]:
    """Keys of the diamond under the mouse: all keys of the track at that time; empty outside of diamonds."""
    if abs(point.y() - key_height(row, area)) > KEY_REACH + 1.0:
        return ()
    fields, axis, reach = fields_in(shown, row), shown.axis, KEY_REACH + 1.0
    near = keys_between(shown, fields, axis.time_at(point.x() - reach), axis.time_at(point.x() + reach))
    if not near:
        return ()
    times = {key: float(stage_times(shown, key.field)[key.place]) for key in near}
    nearest = min(times.values(), key=lambda time: abs(axis.x_of_time(time) - point.x()))
    return tuple(key for key, time in times.items() if abs(time - nearest) * axis.scale < 1.0)


def key_height(row: TimelineRow, area: QRect) -> float:
    """Vertical pixel of the diamonds of a track."""
    if row.kind == "constraints":
        from studio.timeline.tracks import constraint

        return constraint.baseline(area) - constraint.curve_height(area) / 2
    return area.center().y() + 0.5


def paint_keys(painter: QPainter, shown: RowContext, row: TimelineRow, area: QRect, colour: str) -> None:
    """Paint the diamonds, with a light edge if selected; a bar where they are too dense."""
    axis = shown.axis
    begin, end = axis.time_at(axis.left - KEY_REACH), axis.time_at(axis.right + 20.0)
    plain: list[FloatArray] = [np.empty(0)]
    chosen: list[FloatArray] = [np.empty(0)]
    selected = shown.document.keys.by_field()
    for field in fields_in(shown, row):
        times = stage_times(shown, field)
        seen = (times >= begin) & (times <= end)
        if field in selected:
            picked = np.zeros(len(times), dtype=bool)
            picked[list(selected[field])] = True
            chosen.append(times[seen & picked])
            seen &= ~picked
        plain.append(times[seen])
    y = key_height(row, area)
    _paint_diamonds(painter, shown, np.concatenate(plain), y, colour, False)
    _paint_diamonds(painter, shown, np.concatenate(chosen), y, colour, True)


def _paint_diamonds(
    painter: QPainter, shown: RowContext, times: FloatArray, y: float, colour: str, selected: bool
) -> None:
    if not len(times):
        return
    xs = np.unique(np.round(shown.axis.left + (times - shown.axis.start) * shown.axis.scale, 1))
    breaks = np.flatnonzero(np.diff(xs) >= MERGED_KEYS_PX) + 1
    for run in np.split(xs, breaks):
        left, right = float(run[0]), float(run[-1])
        if right > left:
            edge = colours.SELECTED_HANDLE if selected else None
            paint_bar(
                painter,
                QRectF(left, y - MERGED_BAR_PX, right - left, 2.0 * MERGED_BAR_PX),
                translucent(colour, 0.7),
                MERGED_BAR_PX,
                edge,
            )
            paint_key(painter, QPointF(right, y), colour, selected)
        paint_key(painter, QPointF(left, y), colour, selected)


def paint_sheet_label(painter: QPainter, row: TimelineRow, area: QRect, shown: RowContext) -> None:
    """Paint the names of the entity and of its keyed field."""
    if row.kind == SUMMARY_KIND:
        paint_label(painter, label_area(area), "All keys", colours.TEXT)
        return
    paint_label(painter, label_area(area), row_words(shown, row), colours.TEXT_SECOND)


def row_words(shown: RowContext, row: TimelineRow) -> str:
    """Name of a dope sheet's track: ``Kick target · target``."""
    field = field_of(row.id)
    entity = shown.project.get(*field.item)
    name = name_of(shown.project, entity) if field.collection == "clips" and entity else getattr(entity, "name", "")
    return f"{name} · {field_words(field)}"


def field_words(field: KeyedField) -> str:
    """Name of a keyed field for the user."""
    return FIELD_NAMES.get(field.name, field.name)


def row_colour(shown: RowContext, row: TimelineRow) -> str:
    """Colour of a track's diamonds: of the kind of constraint, or of the performer."""
    if row.kind == SUMMARY_KIND:
        return colours.TEXT_SECOND
    field = field_of(row.id)
    entity = shown.project.get(*field.item)
    if field.collection == "constraints" and entity is not None:
        return colours.kind_colour(entity.kind)
    if field.collection == "corrections":
        return colours.kind_colour("correction")
    return getattr(entity, "colour", colours.TEXT_SECOND)


def paint_sheet(painter: QPainter, row: TimelineRow, area: QRect, shown: RowContext) -> None:
    """Paint a track of the dope sheet."""
    if row.kind == SUMMARY_KIND:
        painter.fillRect(area, QColor(colours.BAR))
    paint_keys(painter, shown, row, area, row_colour(shown, row))


def paint_growth_label(painter: QPainter, area: QRect) -> None:
    """Paint the name of the track of keyed proportions."""
    paint_label(painter, label_area(area).adjusted(LAYER_INDENT_PX, 0, 0, 0), "Proportions", colours.TEXT_SECOND)


def growth_rows(shown: RowContext, performer_id: str) -> list[tuple[str, str, int]]:
    """Kind, id and height in pixels of the track of a performer's keyed proportions; empty if they are constant."""
    return [("growth", performer_id, KEY_ROW_HEIGHT)] if growth_fields(shown, performer_id) else []


def growth_fields(shown: RowContext, performer_id: str) -> tuple[KeyedField, ...]:
    """Keyed proportions of a performer; empty if they are constant."""
    return _keys_of(shown, "characters", shown.project.performers[performer_id].character_id)
