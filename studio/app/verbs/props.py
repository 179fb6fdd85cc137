"""Props: new ones, from a shape or a mesh, and their holds."""

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from studio.app.file_dialogs import ask_file
from studio.app.workbench import Workbench
from studio.core.curves.keyed import KeyedPlace
from studio.core.errors import StudioError
from studio.core.mesh.triangle_mesh import TriangleMesh
from studio.core.names import free_name, readable_name
from studio.core.stage.clip import Clip
from studio.core.stage.holding import HAND_REACH_SECONDS, THIN_PROP_BREADTH, grip_constraints, reaching_time
from studio.core.stage.mirrored_props import constraint_as_played
from studio.core.stage.project import Performer, Project
from studio.core.stage.prop import Carried, InHand, Prop, PropShape, quarter_turns
from studio.document.document import Document
from studio.document.grips import is_grip, remove_grips
from studio.document.length_units import length_text, shown_unit
from studio.engine.grasps import Grasp, captured_grasp, chest_heading, grasp_at, grasp_near
from studio.engine.performance import PosedPerformer, motion_time, posed_performers
from studio.engine.prop_places import (
    heading_of,
    hold_between_hands,
    prop_at,
    takes_lower,
    wrists_from,
)
from studio.io.meshes.mesh_file import MESH_SUFFIXES, MeshFile, read_mesh
from studio.panels.message_strip import Lifetime

NEW_PROP_DISTANCE = 0.6
"""Metres from a body's root to a new prop."""
PROP_GAP = 0.1
"""Metres between a new prop and the one beside it."""
PROP_REACH = 0.75
"""Leg lengths over the ground from a body's root to a prop that it still reaches."""
LATEST_RELEASE = 0.2
"""Seconds before the end of a clip from which hands release nothing: their contact ends with the clip."""
HAND_THICKNESS = 0.02
"""Metres from a wrist to the palm's surface."""
CARRIED = (PropShape.BOX, PropShape.BALL, PropShape.STICK, PropShape.MESH)
"""Shapes of things that people carry."""
NEW_PROP_SIZES = {
    PropShape.BOX: (0.4, 0.4, 0.4),
    PropShape.BALL: (0.22, 0.22, 0.22),
    PropShape.STICK: (0.03, 0.03, 1.2),
    PropShape.TABLE: (0.8, 1.2, 0.75),
    PropShape.STAIRS: (1.2, 1.0, 0.68),
}
"""Metres of a new prop, as things of its kind are."""


def add_box(bench: Workbench) -> None:
    """Add a box on the ground ahead of the active body, or in the middle of the stage."""
    add_shape(bench, PropShape.BOX)


def choose(bench: Workbench) -> None:
    """Let the user choose a shape, and add a prop of it."""
    shapes = [((shape.value.capitalize(), _words(shape)), partial(add_shape, bench, shape)) for shape in NEW_PROP_SIZES]
    bench.window.choose("Add a prop", [*shapes, (("Mesh file…", "OBJ, STL or PLY"), partial(ask_mesh, bench))])


def _words(shape: PropShape) -> str:
    metre = shown_unit("m")
    return " × ".join(f"{side * metre.factor:.3g}" for side in NEW_PROP_SIZES[shape]) + f" {metre.symbol}"


def add_shape(bench: Workbench, shape: PropShape) -> None:
    """Add a prop of a shape, in a default size."""
    _add(bench, Prop(shape.value.capitalize(), NEW_PROP_SIZES[shape], shape=shape))


def _add(bench: Workbench, prop: Prop) -> None:
    """Add a new prop where the motion of the active body holds a thing, else on the ground ahead of it."""
    document = bench.document
    performer_id = document.active_performer_id or ""
    grasp = (
        grasp_near(document.project, bench.live.result, performer_id, document.playhead.time)
        if prop.shape in CARRIED
        else None
    )
    grasped = _grasped(_as_broad(prop, grasp.holder), grasp) if grasp is not None else None
    if grasped is None or _is_taken(document, grasped):
        grasp, prop = None, _ahead(document, prop, bench.viewport.posed.get(performer_id))
    else:
        prop = grasped
    name = free_name(prop.name, {each.name for each in document.project.props.values()})
    document.selection.set(("props", document.add("props", replace(prop, name=name), f"Add {name}")))
    if grasp is not None:
        frame = round(grasp.seconds * document.playhead.frame_rate)
        hint = f"The actor holds an object at frame {frame}: {name} was placed there. Pick it up at that frame."
        bench.inform(hint, until=Lifetime.EDITED)


def _ahead(document: Document, prop: Prop, pose: PosedPerformer | None) -> Prop:
    """Prop on the ground ahead of a body, or in the middle of the stage; to the right of others there."""
    x, y, heading = 0.0, 0.0, 0.0
    if pose is not None:
        ahead = pose.placement.rotation @ pose.motion.rotations[pose.row, 0, :, 0]
        heading = math.atan2(ahead[1], ahead[0])
        away = NEW_PROP_DISTANCE + max(prop.size[0] / 2 - 0.2, 0.0)
        x, y = (pose.points[0, :2] + away * np.array([math.cos(heading), math.sin(heading)])).tolist()
    while True:
        floor = float(document.project.ground.height_at((x, y, 0.0)))
        lying = replace(prop, position=(x, y, floor + prop.size[2] / 2), heading=heading)
        if not _is_taken(document, lying):
            return lying
        x += (prop.size[1] + PROP_GAP) * math.sin(heading)
        y -= (prop.size[1] + PROP_GAP) * math.cos(heading)


def _is_taken(document: Document, prop: Prop) -> bool:
    """True if another prop that does not move is at the position of a new one."""
    others = [each.position for each in document.project.props.values() if isinstance(each.position, tuple)]
    near = min(prop.size[:2]) / 2
    return any(float(np.linalg.norm(np.array(each) - np.array(prop.position))) < near for each in others)


def _grasped(prop: Prop, grasp: Grasp) -> Prop:
    """Prop between a body's hands in its motion."""
    x, y, z = captured_grasp(grasp.holder).tolist()
    return replace(prop, position=(x, y, z + grasp.lift(prop)), heading=chest_heading(grasp.holder))


def _as_broad(prop: Prop, holder: PosedPerformer) -> Prop:
    """Box as broad as the gap between the hands."""
    if prop.shape is not PropShape.BOX:
        return prop
    layout = holder.motion.morphology.layout
    gap = float(np.linalg.norm(holder.points[layout.wrist_point(0)] - holder.points[layout.wrist_point(1)]))
    length, _, height = prop.size
    return replace(prop, size=(length, round(max(gap - 2 * HAND_THICKNESS, THIN_PROP_BREADTH), 2), height))


def ask_mesh(bench: Workbench) -> None:
    """Ask for the file of a mesh for a new prop."""
    kinds = f"Meshes ({' '.join(f'*{suffix}' for suffix in MESH_SUFFIXES)})"
    ask_file(bench, "Load mesh for a prop", kinds, lambda path: add_mesh(bench, path))


def add_mesh(bench: Workbench, path: Path) -> None:
    """Read a mesh in the background, then add it to the stage in its own size; one undo step."""

    def done(file: MeshFile) -> None:
        _add(bench, Prop(readable_name(path.stem), mesh_extent(file.mesh), shape=PropShape.MESH, mesh=file.mesh))
        bench.inform(f"{path.name}: {file.guesses}.", until=Lifetime.EDITED)

    bench.runner.run(f"Reading {path.name}", lambda progress: read_mesh(path), done)


def mesh_extent(mesh: TriangleMesh) -> tuple[float, float, float]:
    """Extent of a mesh in each direction, metres; a millimetre where it is flat."""
    x, y, z = np.maximum(mesh.vertices.max(axis=0) - mesh.vertices.min(axis=0), 0.001).tolist()
    return x, y, z


def selected_prop(bench: Workbench) -> str | None:
    """Selected prop."""
    props = bench.document.project.props
    return next((key for key in bench.document.selection.of("props") if key in props), None)


def is_held(bench: Workbench) -> bool:
    """True if a performer holds the selected prop at some time."""
    prop_id = selected_prop(bench)
    return prop_id is not None and bool(bench.document.project.props[prop_id].holds)


def hold(bench: Workbench) -> None:
    """Let the active body carry the selected prop between both hands throughout."""
    _hold(bench, None)


def pick_up(bench: Workbench) -> None:
    """Let the active body pick up the selected prop at the playhead, with both hands unless it has it in one.

    The present holder releases it: it is handed over.
    """
    document, prop_id, performer_id = _holding(bench)
    prop, now = document.project.props[prop_id], document.playhead.time
    hold = prop.held_at(now) or prop.held
    if isinstance(hold, Carried) and hold.performer_id == performer_id and hold.begin != now and hold.holds_at(now):
        name = document.project.performers[performer_id].name
        raise StudioError(f"{name} already carries {prop.name} here. Choose another character, or put it down first.")
    if isinstance(hold, InHand) and hold.performer_id == performer_id:
        end = hold.end if hold.end is not None and hold.end > now else None
        held = prop.with_span(hold, now, end)
        document.replace("props", prop_id, held, f"Pick up {prop.name}")
        return
    _hold(bench, now)


def put_down(bench: Workbench) -> None:
    """Let the holder of the selected prop put it down at the playhead; hands leave it."""
    document, prop_id = bench.document, selected_prop(bench)
    prop, now = document.project.props[prop_id or ""], document.playhead.time
    held = [each for each in prop.holds if each.holds_at(now) and each.begin != now and each.end != now]
    if prop_id is None or not held:
        raise StudioError(
            "No character carries the prop here. Select a carried prop, then move the playhead past its pick-up."
        )
    text = f"Put down {prop.name}"
    with document.group(text):
        _release(document, prop_id, held[-1], now, text)


def _release(document: Document, prop_id: str, hold: InHand | Carried, now: float, text: str) -> None:
    """End a hold at second ``now`` of the stage, and fade out the hand constraints of its performer."""
    prop = document.project.props[prop_id]
    document.replace("props", prop_id, prop.with_hold(hold, replace(hold, end=now)), text)
    _fade_grips(document, prop_id, hold.performer_id, now, text)


def _fade_grips(document: Document, prop_id: str, performer_id: str, now: float, text: str) -> None:
    """Fade out the hand constraints of a performer that releases a prop."""
    for clip in document.project.performers[performer_id].clips:
        time = motion_time(clip, document.project.frame_rate_of(clip), now)
        for key, each in document.project.constraints_of(clip.motion_id).items():
            if is_grip(each, prop_id, performer_id) and each.activation.at(time) > 0.0:
                curve = each.activation
                full = min(curve.full, time)
                left = curve.with_times(min(curve.start, full), full, time, time + HAND_REACH_SECONDS)
                document.replace("constraints", key, replace(each, activation=left), text)


def _holding(bench: Workbench) -> tuple[Document, str, str]:
    """Selected prop, and the active performer, which has a clip."""
    document, prop_id = bench.document, selected_prop(bench)
    performer_id = document.active_performer_id
    if prop_id is None or performer_id is None or document.active_clip is None:
        raise StudioError("Select a prop, and a visible character that has a clip.")
    return document, prop_id, performer_id


def _hold(bench: Workbench, begin: float | None) -> None:
    """Let both hands hold the prop from ``begin`` on."""
    document, prop_id, performer_id = _holding(bench)
    prop, performer = document.project.props[prop_id], document.project.performers[performer_id]
    moved, grasp = "", None
    posed = posed_performers(document.project, bench.live.result, document.playhead.time)
    holder, giver = posed.get(performer_id), prop.held_at(begin) if begin is not None else None
    hold, reaching, lower = Carried(performer_id), HAND_REACH_SECONDS, False
    if holder is not None:
        grasp = grasp_at(document.project, bench.live.result, performer_id, begin) if begin is not None else None
        heading = None
        if begin is not None:
            prop, moved = _in_reach(bench, prop, holder, begin, grasp, posed)
            pose = prop_at(document.project.with_entity("props", prop_id, prop), posed, prop_id, begin)
            heading, reaching = heading_of(pose), reaching_time(wrists_from(pose, holder))
        hold = hold_between_hands(prop, performer_id, holder, heading=heading, lift=grasp.lift(prop) if grasp else None)
        lower = isinstance(giver, Carried) and takes_lower(prop, giver, hold)
    text = f"{performer.name} {'holds' if begin is None else 'picks up'} {prop.name}"
    with document.group(text):
        if begin is not None:
            document.replace("props", prop_id, prop.taken(hold, begin), text)
            if giver is not None and giver.performer_id != performer_id:
                _fade_grips(document, prop_id, giver.performer_id, begin, text)
            for later in prop.holds:
                is_lost = later.begin is not None and later.begin >= begin and later.performer_id != performer_id
                if is_lost and isinstance(later, Carried):
                    remove_grips(document, prop_id, later, text)
        elif not isinstance(prop.held, Carried) or prop.holders != {performer_id}:
            document.replace("props", prop_id, prop.with_holds([hold]), text)
        for motion_id, seconds in _stretches(document.project, performer, begin).items():
            others = document.project.constraints_of(motion_id)
            for key, each in others.items():
                if is_grip(each, prop_id, performer_id) and (begin is None or each.activation.end > seconds[0]):
                    document.remove("constraints", key, text)
            others = document.project.constraints_of(motion_id)
            last = max((each.priority for each in others.values()), default=-1) + 1
            made = grip_constraints(
                motion_id, performer_id, prop_id, prop, seconds, last,
                turned=quarter_turns(hold.heading), lower=lower, reaching=reaching,
            )  # fmt: skip
            clip = next(
                each for each in _clips_after(document.project, performer, begin) if each.motion_id == motion_id
            )
            seen = [constraint_as_played(document.project, performer_id, clip, each) for each in made]
            document.add_all("constraints", seen, text)
        if begin is not None and grasp is not None and _leaves(document.project, performer, grasp):
            picked_up = next(each for each in document.project.props[prop_id].holds if each.begin == begin)
            _release(document, prop_id, picked_up, grasp.end, text)
            frame = round(grasp.end * document.playhead.frame_rate)
            moved = (
                f"{moved} The actor's hands leave the object at frame {frame}: {prop.name} is put down there.".strip()
            )
    if moved:
        bench.post_message(moved, until=Lifetime.EDITED)


def _leaves(project: Project, performer: Performer, grasp: Grasp) -> bool:
    """True if the hands of the capture leave what they hold before the clip ends, else it is carried into the next."""
    ends = [clip.start + clip.length(project.frame_rate_of(clip)) for clip in performer.clips]
    return not any(0.0 <= end - grasp.end <= LATEST_RELEASE for end in ends)


def _in_reach(
    bench: Workbench,
    prop: Prop,
    holder: PosedPerformer,
    begin: float,
    grasp: Grasp | None,
    posed: Mapping[str, PosedPerformer],
) -> tuple[Prop, str]:
    """Prop where the motion holds a thing, or, if it is beyond the arms' reach, ahead of the body; and a sentence about
    that, empty if nothing was moved and hands reach it.
    """
    document, lies = bench.document, isinstance(prop.position, tuple) and not prop.holds
    if lies and grasp is not None:
        return _grasped(prop, grasp), ""
    pose = prop_at(document.project, posed, selected_prop(bench) or "", begin)
    beyond = float(np.linalg.norm(pose.place[:2] - holder.points[0, :2])) - max(prop.size[:2]) / 2
    if beyond <= PROP_REACH * holder.motion.body.leg_length:
        return prop, ""
    far = length_text(beyond, "m", 1)
    if prop.holds:
        whom = holder.performer.name
        return prop, f"{prop.name} is {far} away: the hands of {whom} do not reach it. Bring {whom} closer."
    nearer = _ahead(document, prop, holder)
    if isinstance(prop.position, KeyedPlace) and isinstance(nearer.position, tuple):
        nearer = replace(prop, position=prop.position.with_key(begin, nearer.position))
    elif not lies:
        return prop, f"{prop.name} is {far} away: the hands do not reach it. Move it closer."
    words = f"{prop.name} was {far} away, out of reach: it was moved in front of {holder.performer.name}."
    return nearer, words


def _clips_after(project: Project, performer: Performer, begin: float | None) -> list[Clip]:
    """Clips that a performer plays after ``begin``, or all."""
    return [
        clip
        for clip in performer.clips
        if begin is None or clip.start + clip.length(project.frame_rate_of(clip)) > begin
    ]


def _stretches(project: Project, performer: Performer, begin: float | None) -> dict[str, tuple[float, float]]:
    """Range in seconds of each motion that a performer plays after ``begin``, without motions of which it has played
    the same range before, where the constraints would apply too.
    """
    stretches: dict[str, tuple[float, float]] = {}
    for clip in _clips_after(project, performer, begin):
        rate = project.frame_rate_of(clip)
        first = clip.first / rate if begin is None else _looped_motion_time(clip, rate, begin)
        known = stretches.get(clip.motion_id, (first, first))
        stretches[clip.motion_id] = min(first, known[0]), max(clip.last / rate, known[1])
    for clip in performer.clips:
        rate = project.frame_rate_of(clip)
        over = begin is not None and clip.start + clip.length(rate) <= begin
        if over and clip.motion_id in stretches and clip.last / rate > stretches[clip.motion_id][0]:
            del stretches[clip.motion_id]
    return stretches


def _looped_motion_time(clip: Clip, frame_rate: float, time: float) -> float:
    """Seconds of the clip's motion that its repeats play at a time of the stage, clamped to the clip."""
    once = clip.length(frame_rate) / clip.repeats
    return motion_time(clip, frame_rate, time - clip.repeat_at(time, frame_rate) * once)
