"""Tooltips of the timeline: a sentence with units about the part under the mouse."""

from PySide6.QtCore import QPointF

from studio.core.stage.clip_row import players_of
from studio.engine.residuals import unsolved_words
from studio.timeline.gestures.activation import time_of
from studio.timeline.gestures.begin import name_of
from studio.timeline.sheet import TimelineLayout
from studio.timeline.shown import EDGE_PARTS, HANDLE_PARTS, ROW_LABEL_WIDTH, Hit, ItemPart
from studio.timeline.strip_states import StripState
from studio.timeline.time_words import time_text
from studio.timeline.tracks import clip, constraint, keys, remarks
from studio.timeline.tracks.change import clip_transition
from studio.timeline.tracks.hold import hold_under
from studio.timeline.tracks.plot import PlotPicture


def hover_text(sheet: TimelineLayout, plot: PlotPicture, position: QPointF) -> str:
    """Tooltip for a position; empty if there is nothing to tell."""
    hit = sheet.part_under_playhead(position)
    if position.x() < ROW_LABEL_WIDTH:
        return _label_text(sheet, hit)
    if hit.keys:
        return _keys_text(sheet, hit)
    match hit.kind:
        case "ruler":
            return remarks.remark_text(sheet.context, position.x())
        case "plot":
            return _plot_text(sheet, plot, position)
        case "constraints":
            return _constraint_text(sheet, hit, position)
        case "contacts":
            contact = sheet.context.project.contacts[hit.id]
            rate = sheet.context.subject.frame_rate
            seconds = (contact.last - contact.first) / rate
            alone = f", of {sheet.context.subject_name} only" if contact.scope.is_narrow else ""
            ends = (sheet.context.frame_words(frame) for frame in (contact.first, contact.last))
            return f"{name_of(contact)}: {' to '.join(ends)}, {seconds:.3f} s{alone}"
        case "sounds":
            sound = sheet.context.project.sounds[hit.id]
            return f"{sound.name}: {len(sound.beats)} beats (keys and contacts snap to them); drag to move it"
        case "footage":
            footage = sheet.context.project.footage[hit.id]
            return f"{footage.name}: {footage.frames} frames at {footage.frame_rate:g} fps; drag to move it"
        case "corrections":
            return _correction_text(sheet, hit)
        case "labels":
            return _label_words(sheet, hit)
        case "clips":
            return _clip_text(sheet, hit)
        case "clip":
            return "Right-click to add a clip, or drop a capture from the outliner here"
        case "growth":
            return "Animated proportions: a slider sets a key at the playhead"
        case "summary" | "sheet":
            return "Drag a box to select keys; Shift+drag a key to scale the selection about the playhead"
        case "props":
            return _hold_text(sheet, hit, position)
        case "lane":
            return f"{hit.id.replace('_', ' ').capitalize()}: double-click to add a contact"
    return ""


def shows_value(sheet: TimelineLayout, position: QPointF) -> bool:
    """True if a measured value or a mark is at the position, so that the tooltip appears without delay."""
    hit = sheet.part_under_playhead(position)
    return position.x() >= ROW_LABEL_WIDTH and (
        hit.kind in ("plot", "ruler") or (hit.kind == "constraints" and hit.part == ItemPart.EMPTY)
    )


def strip_text(sheet: TimelineLayout, constraint_id: str, performer_id: str, frame: int) -> str:
    """Error of a constraint on a performer at a frame of the motion: ``Child: 42 mm at frame 23``; empty if the
    constraint is inactive there.
    """
    strip = sheet.context.strip(constraint_id, performer_id)
    name = sheet.context.project.performers[performer_id].name
    if strip is None:
        return (
            f"{name}: {unsolved_words(sheet.context.live)}"
            if sheet.context.applies_to(constraint_id, performer_id)
            else ""
        )
    time = sheet.context.subject.stage_time(frame)
    if strip.state_at(time) == StripState.INACTIVE:
        return ""
    if strip.state_at(time) == StripState.YIELDING:
        return f"{name}: overridden by a contact at {sheet.context.frame_words(frame)}"
    return f"{name}: {strip.measure.text_of(strip.error_at(time))} at {sheet.context.frame_words(frame)}"


def _label_text(sheet: TimelineLayout, hit: Hit) -> str:
    if hit.part == ItemPart.FOLD:
        if hit.kind == "clip":
            return "Click to expand/collapse the clip tracks of all characters"
        return "Click to expand/collapse the track"
    if hit.kind == "plot":
        return "Click to choose the graph"
    if hit.kind == "constraints":
        entity, (text, _) = sheet.context.project.constraints[hit.id], constraint.residual_text(sheet.context, hit.id)
        name = f"{entity.name}, of {sheet.context.subject_name} only" if entity.scope.is_narrow else entity.name
        return f"{name}: {text}" if text else name
    return ""


def _clip_text(sheet: TimelineLayout, hit: Hit) -> str:
    shown, entity = sheet.context, sheet.context.project.clips[hit.id]
    failure = shown.live.failure(hit.performer_id)
    if failure:
        return f"{shown.project.performers[hit.performer_id].name} is not adapted: {failure}"
    length = entity.length(shown.project.frame_rate_of(entity))
    players = len(players_of(shown.project, hit.id))
    shared = f", shared by {players} characters" if players > 1 else ""
    text = f"{clip.clip_text(shown, entity)}: frames {entity.first} to {entity.last}, {length:.3f} s{shared}"
    if hit.part in EDGE_PARTS:
        text += "\nDrag to trim; Shift+drag changes the speed. Later clips move along"
    comes = clip_transition(shown, hit.performer_id, entity)
    return f"{text}\n{comes.words(entity)}" if comes else text


def _label_words(sheet: TimelineLayout, hit: Hit) -> str:
    label = sheet.context.project.labels.get(hit.id)
    if label is None:
        return "Labels: double-click to add one"
    rate = sheet.context.subject.frame_rate
    if label.last == label.first:
        return f"{label.name}: {time_text(label.first, label.first / rate)}"
    return f"{label.name}: frames {label.first} to {label.last}, {(label.last - label.first) / rate:.3f} s"


def _correction_text(sheet: TimelineLayout, hit: Hit) -> str:
    """Tooltip of a correction: ``Left elbow: 0.750 s to 1.250 s, below the constraints``."""
    entity = sheet.context.project.corrections[hit.id]
    where = "above" if entity.above else "below"
    curve = entity.activation
    if hit.part in HANDLE_PARTS:
        time = time_of(curve, hit.part)
        return f"{entity.name}, {hit.part}: {time_text(time * sheet.context.axis.frame_rate, time)}"
    return f"{entity.name}: {curve.start:.3f} s to {curve.end:.3f} s, {where} the constraints"


def _keys_text(sheet: TimelineLayout, hit: Hit) -> str:
    """Tooltip of keys: ``Key of Kick target, target: 1.250 s · frame 75``."""
    shown, count = sheet.context, len(hit.keys)
    key = hit.keys[0]
    time = float(keys.stage_times(shown, key.field)[key.place])
    place = time_text(time * shown.axis.frame_rate, time)
    name = getattr(shown.project.get(*key.field.item), "name", "")
    return f"Key of {name}, {keys.field_words(key.field)}: {place}" if count == 1 else f"{count} keys: {place}"


def _hold_text(sheet: TimelineLayout, hit: Hit, position: QPointF) -> str:
    prop = sheet.context.project.props[hit.id]
    hold, performers = hold_under(sheet.context, prop, position.x()), sheet.context.project.performers
    if hold is None:
        return f"{prop.name}: not carried"
    begin = "from the start" if hold.begin is None else f"from {hold.begin:.3f} s"
    end = "to the end" if hold.end is None else f"to {hold.end:.3f} s"
    return f"{prop.name}: carried by {performers[hold.performer_id].name} {begin} {end}"


def _constraint_text(sheet: TimelineLayout, hit: Hit, position: QPointF) -> str:
    entity = sheet.context.project.constraints[hit.id]
    rate = sheet.context.subject.frame_rate
    if hit.part in HANDLE_PARTS:
        time = time_of(entity.activation, hit.part)
        return f"{entity.name}, {hit.part}: {sheet.context.moment(time * rate)}"
    frame = round(sheet.context.frame_at(position.x()))
    if hit.part == ItemPart.BODY:
        activation = float(entity.activation.at(frame / rate))
        return f"{entity.name}: activation {activation:.0%} at {sheet.context.frame_words(frame)}"
    row = sheet.find("constraints", hit.id)
    body = constraint.strip_body(sheet.context, sheet.rect(row), hit.id, position.y()) if row else None
    return strip_text(sheet, hit.id, body, frame) if body else ""


def _plot_text(sheet: TimelineLayout, plot: PlotPicture, position: QPointF) -> str:
    time = sheet.context.axis.time_at(position.x())
    near = plot.nearest(sheet.plot, time, position.y())
    if near is None or ("plot", "") in sheet.context.folded:
        return ""
    curve, value = near
    figure = plot.words(sheet.context, value)
    return f"{curve.name}: {figure} at {sheet.context.frame_words(round(sheet.context.subject.motion_frame(time)))}"
