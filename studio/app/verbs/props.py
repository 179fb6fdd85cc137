"""Actions of props: new ones from a shape or a mesh, and picking up and putting down."""

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
from studio.core.stage.holding import HAND_REACH_SECONDS, THIN_PROP_BREADTH, reaching_time
from studio.core.stage.project import Performer, Project
from studio.core.stage.prop import Carried, InHand, Prop, PropShape
from studio.document.document import Document
from studio.document.grips import add_grips, fade_grips, remove_grips
from studio.document.length_units import length_text, shown_unit
from studio.engine.grasps import Grasp, captured_grasp, chest_heading, grasp_at, grasp_near
from studio.engine.posed_performer import PosedPerformer, posed_performers
from studio.engine.prop_places import (
    heading_of,
    hold_between_hands,
    prop_at,
    takes_lower,
    wrists_from,
)
from studio.io.meshes.mesh_file import MESH_SUFFIXES, MeshFile, read_mesh
from studio.panels.message_strip import Lifetime

NEW_PROP_DISTANCE_METRES = 0.6
"""Horizontal distance in metres from a performer's root to a new prop."""
PROP_GAP_METRES = 0.1
"""Gap in metres between a new prop and the one beside it."""
PROP_REACH_LEGS = 0.75
"""Horizontal distance from a performer's root, in leg lengths, up to which the hands still reach a prop."""
RELEASE_MARGIN_SECONDS = 0.2
"""Seconds before the end of a clip in which the end of a hand contact does not count as a release: it ends with the
clip.
"""
HAND_THICKNESS_METRES = 0.02
"""Distance in metres from the wrist to the surface of the palm."""
CARRIED_SHAPES = (PropShape.BOX, PropShape.BALL, PropShape.STICK, PropShape.MESH)
"""Shapes of props that can be carried."""
NEW_PROP_SIZES = {
    PropShape.BOX: (0.4, 0.4, 0.4),
    PropShape.BALL: (0.22, 0.22, 0.22),
    PropShape.STICK: (0.03, 0.03, 1.2),
    PropShape.TABLE: (0.8, 1.2, 0.75),
    PropShape.STAIRS: (1.2, 1.0, 0.68),
}
"""Default size (length, width, height) in metres of a new prop, by shape."""


def add_box(bench: Workbench) -> None:
    """Add a box on the ground in front of the active performer, or in the middle of the stage."""
    add_shape(bench, PropShape.BOX)


def choose(bench: Workbench) -> None:
    """Let the user choose the shape of a new prop, and add the prop."""
    shapes = [((shape.value.capitalize(), _words(shape)), partial(add_shape, bench, shape)) for shape in NEW_PROP_SIZES]
    bench.window.choose(
        "Choose the prop to add", [*shapes, (("Mesh file…", "OBJ, STL or PLY"), partial(ask_mesh, bench))]
    )


def _words(shape: PropShape) -> str:
    metre = shown_unit("m")
    return " × ".join(f"{side * metre.factor:.3g}" for side in NEW_PROP_SIZES[shape]) + f" {metre.symbol}"


def add_shape(bench: Workbench, shape: PropShape) -> None:
    """Add a prop of a shape, in the default size."""
    _add(bench, Prop(shape.value.capitalize(), NEW_PROP_SIZES[shape], shape=shape))


def _add(bench: Workbench, prop: Prop) -> None:
    """Add a prop where the hands of the active performer hold something in the capture, else on the ground in front of
    it.
    """
    document = bench.document
    performer_id = document.active_performer_id or ""
    grasp = (
        grasp_near(document.project, bench.live.result, performer_id, document.playhead.time)
        if prop.shape in CARRIED_SHAPES
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
    """Prop on the ground in front of a performer, or in the middle of the stage; moved to the right if other props are
    there.
    """
    x, y, heading = 0.0, 0.0, 0.0
    if pose is not None:
        ahead = pose.placement.rotation @ pose.motion.rotations[pose.row, 0, :, 0]
        heading = math.atan2(ahead[1], ahead[0])
        away = NEW_PROP_DISTANCE_METRES + max(prop.size[0] / 2 - 0.2, 0.0)
        x, y = (pose.points[0, :2] + away * np.array([math.cos(heading), math.sin(heading)])).tolist()
    while True:
        floor = float(document.project.ground.height_at((x, y, 0.0)))
        lying = replace(prop, position=(x, y, floor + prop.size[2] / 2), heading=heading)
        if not _is_taken(document, lying):
            return lying
        x += (prop.size[1] + PROP_GAP_METRES) * math.sin(heading)
        y -= (prop.size[1] + PROP_GAP_METRES) * math.cos(heading)


def _is_taken(document: Document, prop: Prop) -> bool:
    """True if another fixed prop is at the position of the new one."""
    others = [each.position for each in document.project.props.values() if isinstance(each.position, tuple)]
    near = min(prop.size[:2]) / 2
    return any(float(np.linalg.norm(np.array(each) - np.array(prop.position))) < near for each in others)


def _grasped(prop: Prop, grasp: Grasp) -> Prop:
    """Prop placed between the performer's hands at the moment of ``grasp``."""
    x, y, z = captured_grasp(grasp.holder).tolist()
    return replace(prop, position=(x, y, z + grasp.lift(prop)), heading=chest_heading(grasp.holder))


def _as_broad(prop: Prop, holder: PosedPerformer) -> Prop:
    """Box as wide as the gap between the performer's hands; other shapes unchanged."""
    if prop.shape is not PropShape.BOX:
        return prop
    layout = holder.motion.morphology.layout
    gap = float(np.linalg.norm(holder.points[layout.wrist_point(0)] - holder.points[layout.wrist_point(1)]))
    length, _, height = prop.size
    return replace(prop, size=(length, round(max(gap - 2 * HAND_THICKNESS_METRES, THIN_PROP_BREADTH), 2), height))


def ask_mesh(bench: Workbench) -> None:
    """Ask for a mesh file for a new prop."""
    kinds = f"Meshes ({' '.join(f'*{suffix}' for suffix in MESH_SUFFIXES)})"
    ask_file(bench, "Load mesh for a prop", kinds, lambda path: add_mesh(bench, path))


def add_mesh(bench: Workbench, path: Path) -> None:
    """Read a mesh in the background, then add it to the stage as a prop of the mesh's own size; one undo step."""

    def done(file: MeshFile) -> None:
        _add(bench, Prop(readable_name(path.stem), mesh_extent(file.mesh), shape=PropShape.MESH, mesh=file.mesh))
        bench.inform(f"{path.name}: {file.guesses}.", until=Lifetime.EDITED)

    bench.runner.run(f"Reading {path.name}", lambda progress: read_mesh(path), done)


def mesh_extent(mesh: TriangleMesh) -> tuple[float, float, float]:
    """Size (x, y, z) in metres of the bounding box of a mesh; at least one millimetre."""
    x, y, z = np.maximum(mesh.vertices.max(axis=0) - mesh.vertices.min(axis=0), 0.001).tolist()
    return x, y, z


def selected_prop(bench: Workbench) -> str | None:
    """Id of the first selected prop; None if there is none."""
    props = bench.document.project.props
    return next((key for key in bench.document.selection.of("props") if key in props), None)


def is_held(bench: Workbench) -> bool:
    """True if a performer holds the selected prop at any time."""
    prop_id = selected_prop(bench)
    return prop_id is not None and bool(bench.document.project.props[prop_id].holds)


def hold(bench: Workbench) -> None:
    """Let the active performer carry the selected prop in both hands all the time."""
    _hold(bench, None)


def pick_up(bench: Workbench) -> None:
    """Let the active performer pick up the selected prop at the playhead, in both hands unless the prop is already
    attached to one.

    If another performer carries the prop, it is handed over.
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
    """End the hold of the selected prop at the playhead; the hands are released."""
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
    """End a hold at the stage time ``now``, in seconds, and fade out the hand constraints of its performer."""
    prop = document.project.props[prop_id]
    document.replace("props", prop_id, prop.with_hold(hold, replace(hold, end=now)), text)
    fade_grips(document, prop_id, hold.performer_id, now, text)


def _holding(bench: Workbench) -> tuple[Document, str, str]:
    """Document, id of the selected prop, and id of the active performer. Raises StudioError if something is missing or
    the performer has no clip.
    """
    document, prop_id = bench.document, selected_prop(bench)
    performer_id = document.active_performer_id
    if prop_id is None or performer_id is None or document.active_clip is None:
        raise StudioError("Select a prop and a visible character that has a clip first.")
    return document, prop_id, performer_id


def _hold(bench: Workbench, begin: float | None) -> None:
    """Let the active performer carry the selected prop in both hands from the stage time ``begin``, or always if that
    is None.
    """
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
                fade_grips(document, prop_id, giver.performer_id, begin, text)
        else:
            own = prop.held if isinstance(prop.held, Carried) and prop.holders == {performer_id} else hold
            hold = replace(own, begin=None, end=None)
            document.replace("props", prop_id, prop.with_holds([hold]), text)
        for ended in prop.holds:
            is_lost = begin is None or (ended.begin is not None and ended.begin >= begin)
            if is_lost and isinstance(ended, Carried):
                remove_grips(document, prop_id, ended, text)
        add_grips(document, prop_id, replace(hold, begin=begin), text, lower=lower, reaching=reaching)
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
    """True if the captured hands release the object before their clip ends; otherwise the prop is carried into the next
    clip.
    """
    ends = [clip.start + clip.length(project.frame_rate_of(clip)) for clip in performer.clips]
    return not any(0.0 <= end - grasp.end <= RELEASE_MARGIN_SECONDS for end in ends)


def _in_reach(
    bench: Workbench,
    prop: Prop,
    holder: PosedPerformer,
    begin: float,
    grasp: Grasp | None,
    posed: Mapping[str, PosedPerformer],
) -> tuple[Prop, str]:
    """Prop, moved to the hands if the captured actor holds an object, or in front of the performer if it is out of
    reach; and a message about that, which is empty if nothing is wrong.
    """
    document, lies = bench.document, isinstance(prop.position, tuple) and not prop.holds
    if lies and grasp is not None:
        return _grasped(prop, grasp), ""
    pose = prop_at(document.project, posed, selected_prop(bench) or "", begin)
    beyond = float(np.linalg.norm(pose.place[:2] - holder.points[0, :2])) - max(prop.size[:2]) / 2
    if beyond <= PROP_REACH_LEGS * holder.motion.body.leg_length:
        return prop, ""
    far = length_text(beyond, "m", 1)
    if prop.holds:
        whom = holder.performer.name
        return prop, f"{prop.name} is {far} away: the hands of {whom} do not reach it. Move {whom} closer."
    nearer = _ahead(document, prop, holder)
    if isinstance(prop.position, KeyedPlace) and isinstance(nearer.position, tuple):
        nearer = replace(prop, position=prop.position.with_key(begin, nearer.position))
    elif not lies:
        return prop, f"{prop.name} is {far} away: the hands do not reach it. Move it closer."
    words = f"{prop.name} was {far} away, out of reach: it was moved in front of {holder.performer.name}."
    return nearer, words
