"""The still pictures: each a moment of a session."""

import os
import wave
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPoint, QRect, QSize, Qt
from PySide6.QtGui import QImage, QPainter
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QLineEdit, QWidget

from pictured.session import KICK_TIME, Session, example, kick_target, left_wrist
from studio.app.marker_dialog import open_markers
from studio.app.preferences_dialog import PreferencesDialog
from studio.app.verbs.media import add_footage, add_sound
from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Proportions
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.curves.keyed import KeyedNumber, KeyedPlace
from studio.core.stage.prop import Prop
from studio.document import colours
from studio.document.channels import TangentSide, with_handle
from studio.document.clip_edits import set_speed
from studio.document.key_edits import replace_fields
from studio.document.keyed_fields import KeyedField, KeyRef
from studio.io.export import write_capture
from studio.io.importing import load_capture
from studio.library.scenes import SCENES
from studio.viewport.body_points import body_joints, point_path
from studio.viewport.onion_skins import OnionSkins
from studio.viewport.rotate_gizmo import RotateGizmo
from studio.viewport.turntable import TURN_RATE

KICK_KEYS = KeyedField("constraints", "kick", "target")
KEY_TIMES = (2.2, 2.4, 2.55, 2.75, 2.95)
CLICK_RATE = 22_050
KICK_FILM = Path(__file__).parents[2] / "docs" / "pictures" / "kick.gif"
TILE = QSize(210, 340)
"""Pixels of a view in a row of them."""
LEFT, NO_KEY = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier


def window() -> QImage:
    """The whole window: the kick on five bodies, the child short of the target."""
    session = Session("front_kick", (1440, 940))
    _aim(session, "child")
    session.look(35, 8, 1.15)
    return _taken(session)


def light_theme() -> QImage:
    """The window in the light theme."""
    colours.use_theme("light")
    session = Session("front_kick", (1120, 740))
    _aim(session, "child")
    session.look(35, 8, 1.15)
    image = _taken(session)
    colours.use_theme("dark")
    return image


def constrain() -> QImage:
    """The right wrist of one body is picked, and the studio offers to constrain it."""
    session = Session("reach_grasp", (1440, 860))
    session.document.playhead.set_time(2.2)
    session.settle()
    session.look(28, 6, 1.25, among=("stocky_man", "tall_man", "adult_woman"))
    viewport = session.bench.viewport
    pose = viewport.posed["tall_man"]
    joint = next(one for one in body_joints(pose.motion.morphology.layout) if one.name == "right wrist")
    QTest.mouseClick(viewport, LEFT, NO_KEY, viewport.widget_point(pose.points[joint.index]).toPoint())
    session.rest(0.2)
    return _taken(session, [viewport])


def onion_skins() -> QImage:
    """A kick with its skins before and after, and a moment that is kept."""
    session = Session("front_kick", (1440, 860))
    session.document.selection.set(("performers", "adult_woman"))
    viewport = session.bench.viewport
    _show_only(session, "adult_woman")
    session.document.playhead.set_time(1.4)
    session.settle()
    viewport.keep_ghosts()
    session.document.playhead.set_time(KICK_TIME - 0.1)
    viewport.set_onion_skins(OnionSkins(3, 3, 4))
    viewport.set_onion_shown(True)
    session.settle()
    session.look(-70, 8, 1.5, among=("adult_woman",))
    return _taken(session, [viewport])


def trail_keys() -> QImage:
    """A kick at a target with keys, each a diamond on the trail of the foot."""
    session = Session("front_kick", (640, 520))
    _hide_docks(session)
    _show_only(session, "adult_woman")
    places = (0.45, -0.1, 0.7), (0.75, 0.0, 1.05), (1.0, 0.1, 1.2), (0.7, 0.05, 0.75)
    keyed = KeyedPlace((2.25, 2.4, KICK_TIME, 2.8), places)
    key = session.document.add("constraints", replace(kick_target(), target=keyed), "Add 'Kick target'")
    session.document.selection.set(("performers", "adult_woman"), ("constraints", key))
    session.document.playhead.set_time(KICK_TIME)
    session.settle()
    session.look(-70, 6, 1.35, among=("adult_woman",))
    middle = session.bench.viewport.geometry().center()
    middle = session.bench.viewport.parentWidget().mapTo(session.window, middle)
    image = session.picture(QRect(middle - QPoint(230, 180), QSize(460, 380)))
    session.close()
    return image


def cameras() -> QImage:
    """A kick through four saved cameras, beside each other as F5 to F8 show it."""
    session = Session("front_kick", (600, 520))
    _hide_docks(session)
    _aim(session, "adult_woman")
    session.document.selection.clear()
    _show_only(session, "adult_woman")
    session.settle()
    viewport, actions = session.bench.viewport, session.window.actions_by_id.by_id
    one = ("adult_woman",)
    views = (35.0, 8.0, 1.4, one), (-60.0, 4.0, 1.7, one), (20.0, 45.0, 1.6, one), (5.0, -4.0, 1.5, one)
    for slot, (azimuth, elevation, margin, among) in enumerate(views, 1):
        session.look(azimuth, elevation, margin, among=among)
        actions[f"store_camera_{slot}"].trigger()
    images = []
    for slot in range(1, 5):
        actions[f"camera_{slot}"].trigger()
        session.rest(0.6)
        images.append(_middle(viewport.grab_image()))
    session.close()
    return _side_by_side(images)


def turntable() -> QImage:
    """Four moments of a walk that the camera follows and goes round."""
    session = Session("walk_turn", (600, 520))
    _hide_docks(session)
    _show_only(session, "adult_woman")
    document, viewport = session.document, session.bench.viewport
    document.selection.set(("performers", "adult_woman"))
    session.settle()
    session.look(35, 8, 1.4, among=("adult_woman",))
    document.selection.clear()
    viewport.set_following(True)
    images = []
    for moment in range(4):
        document.playhead.set_time(0.4 + 0.6 * moment)
        session.settle()
        images.append(_middle(viewport.grab_image()))
        viewport.set_camera(replace(viewport.camera, azimuth=viewport.camera.azimuth + 0.6 * TURN_RATE))
    session.close()
    return _side_by_side(images)


def _hide_docks(session: Session) -> None:
    for name in ("Outliner", "History", "Inspector", "Timeline"):
        session.window.docks[name].hide()


def _show_only(session: Session, performer_id: str) -> None:
    for key, performer in session.document.project.performers.items():
        if key != performer_id:
            session.document.replace("performers", key, replace(performer, visible=False), "Hide")


def _middle(image: QImage) -> QImage:
    """The middle of a view, ``TILE`` large."""
    return image.copy(
        QRect((image.width() - TILE.width()) // 2, (image.height() - TILE.height()) // 2, *TILE.toTuple())
    )


def _side_by_side(images: list[QImage]) -> QImage:
    whole = QImage(len(images) * TILE.width(), TILE.height(), QImage.Format.Format_RGB32)
    with QPainter(whole) as painter:
        for index, image in enumerate(images):
            painter.drawImage(index * TILE.width(), 0, image)
    return whole


def _turn_by_ring(session: Session, axis: str) -> QPoint:
    """Pixel at which the mouse, still pressed, has turned the gizmo's ring about ``axis``."""
    viewport = session.bench.viewport
    gizmo = viewport.gizmo()
    assert isinstance(gizmo, RotateGizmo)
    ring = gizmo.ring(axis)
    begin, *path = (QPoint(*(round(each) for each in ring[place].tolist())) for place in range(42, 49))
    QTest.mousePress(viewport, LEFT, NO_KEY, begin)
    for place in path:
        QTest.mouseMove(viewport, place)
        session.rest(0.05)
    session.rest(0.3)
    return path[-1]


def rotate() -> QImage:
    """A hand of one body while a ring turns it, beside its form."""
    session = Session("reach_grasp", (1440, 860))
    session.document.playhead.set_time(2.2)
    session.settle()
    session.look(28, 6, 1.1, among=("tall_man",))
    viewport = session.bench.viewport
    pose = viewport.posed["tall_man"]
    joint = next(one for one in body_joints(pose.motion.morphology.layout) if one.name == "right wrist")
    QTest.mouseClick(viewport, LEFT, NO_KEY, viewport.widget_point(pose.points[joint.index]).toPoint())
    viewport.add_constraint_at_pick("orientation")
    viewport.set_tool("rotate")
    session.settle()
    end = _turn_by_ring(session, "z")
    image = session.picture(part=_part(session, [viewport, session.window.docks["Inspector"]]))
    QTest.mouseRelease(viewport, LEFT, NO_KEY, end)
    session.close()
    return image


def tilted_area() -> QImage:
    """A table under a hand while a ring tilts it."""
    session = Session("reach_grasp", (1120, 760))
    session.document.playhead.set_time(2.2)
    session.settle()
    viewport = session.bench.viewport
    pose = viewport.posed["tall_man"]
    point = BodyPoint(BodyPart.RIGHT_HAND, at_end=True)
    hand = point_path(pose.motion, point, slice(pose.row, pose.row + 1))
    x, y, z = pose.points_in_clip(hand)[0].tolist()
    table = AreaConstraint(
        pose.motion_id, "Table", point, Chain(trunk=0.3), 3, ActivationCurve(1.9, 2.1, 2.3, 2.5),
        shape=AreaShape.TABLE, centre=(x + 0.1, y, z + 0.06), size=(0.5, 0.6, 0.06),
    )  # fmt: skip
    key = session.document.add("constraints", table, "Add")
    _show_only(session, "tall_man")
    session.document.selection.set(("performers", "tall_man"), ("constraints", key))
    session.settle()
    session.look(38, 14, 1.3, among=("tall_man",))
    viewport.set_tool("rotate")
    session.settle()
    end = _turn_by_ring(session, "x")
    image = session.picture(part=_part(session, [viewport]))
    QTest.mouseRelease(viewport, LEFT, NO_KEY, end)
    session.close()
    return image


def tour() -> QImage:
    """The third step of the tour, a joint being picked."""
    session = Session("front_kick", (1000, 560))
    document = session.document
    _hide_docks(session)
    session.window.actions_by_id.by_id["tour"].trigger()
    document.playhead.play()
    session.rest(0.3)
    document.playhead.set_time(KICK_TIME)
    document.playhead.pause()
    session.settle()
    session.look(35, 8, 1.35)
    viewport = session.bench.viewport
    pose = viewport.posed["tall_man"]
    joint = next(one for one in body_joints(pose.motion.morphology.layout) if one.name == "right ankle")
    QTest.mouseClick(viewport, LEFT, NO_KEY, viewport.widget_point(pose.points[joint.index]).toPoint())
    session.rest(0.3)
    return _taken(session, [viewport])


def mirrored() -> QImage:
    """A wave of the right hand, pasted with left for right."""
    session = Session("reach_grasp", (760, 760))
    document = session.document
    for name in ("Outliner", "History", "Inspector"):
        session.window.docks[name].hide()
    times = tuple(1.5 + 0.35 * k for k in range(5))
    places = tuple((0.2, -0.4 - 0.12 * (k % 2), 1.25 + 0.08 * (k % 2)) for k in range(5))
    wave = PositionConstraint(
        "reach_grasp", "Right wave", BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True), Chain(trunk=0.3), 0,
        ActivationCurve(1.2, 1.5, 2.9, 3.2), target=KeyedPlace(times, places),
    )  # fmt: skip
    key = document.add("constraints", wave, "Add 'Right wave'")
    _show_only(session, "tall_man")
    document.selection.set(("constraints", key))
    for action in ("copy", "paste_mirrored"):
        session.window.actions_by_id.by_id[action].trigger()
    document.playhead.set_time(times[1])
    session.bench.timeline.tracks.axis.show(0.8, 4.0)
    session.settle()
    session.look(14, 6, 0.8, (0.0, -0.25), among=("tall_man",))
    return _taken(session, [session.bench.viewport, session.window.docks["Timeline"]])


def weights() -> QImage:
    """A hand half way between two targets whose weights cross, over the curves of the weights."""
    session = Session("reach_grasp", (760, 800))
    document = session.document
    for name in ("Outliner", "History", "Inspector"):
        session.window.docks[name].hide()
    activation = ActivationCurve(1.2, 1.5, 3.2, 3.5)
    chest = PositionConstraint(
        "reach_grasp", "At the chest", BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True), Chain(trunk=0.3), 0, activation,
        target=(0.35, -0.1, 1.25), weight=KeyedNumber((1.9, 2.7), (1.0, 0.0)),
    )  # fmt: skip
    hip = replace(chest, name="At the hip", target=(0.15, -0.35, 0.85), weight=KeyedNumber((1.9, 2.7), (0.0, 1.0)))
    keys = document.add_all("constraints", (chest, hip), "Add")
    _show_only(session, "tall_man")
    document.selection.set(("performers", "tall_man"), *(("constraints", key) for key in keys))
    document.playhead.set_time(2.25)
    timeline = session.bench.timeline
    timeline.edit_curves(True)
    timeline.tracks.axis.show(0.8, 4.0)
    document.keys.set([KeyRef(KeyedField("constraints", keys[1], "weight"), 1)])
    session.settle()
    session.look(52, 8, 0.7, (0.0, -0.3), among=("tall_man",))
    return _taken(session, [session.bench.viewport, session.window.docks["Timeline"]])


def correction() -> QImage:
    """An elbow of a walk turned by a ring, its form, and its bar on the timeline."""
    session = Session("walk_turn", (1120, 740))
    session.document.playhead.set_time(0.8)
    session.settle()
    session.look(28, 6, 1.35, among=("adult_woman",))
    viewport = session.bench.viewport
    pose = viewport.posed["adult_woman"]
    joint = next(one for one in body_joints(pose.motion.morphology.layout) if one.name == "left elbow")
    viewport.set_correcting(True)
    QTest.mouseClick(viewport, LEFT, NO_KEY, viewport.widget_point(pose.points[joint.index]).toPoint())
    viewport.set_tool("rotate")
    session.settle()
    end = _turn_by_ring(session, "y")
    image = session.picture()
    QTest.mouseRelease(viewport, LEFT, NO_KEY, end)
    session.close()
    return image


def timeline() -> QImage:
    """The bars of the kick with their strips, near enough to be grabbed."""
    session = Session("front_kick", (1040, 1040))
    session.document.add("constraints", left_wrist(), "Add 'Guard up'")
    _aim(session, "stocky_man")
    shown = session.bench.timeline
    shown.tracks.axis.zoom(2.2, shown.x_of_frame(145))
    session.rest(0.3)
    return _taken(session, [session.window.docks["Timeline"]])


def keys() -> QImage:
    """Two keys of a target, selected and dragged beside the bar of its constraint."""
    session = _keyed()
    tracks = session.bench.timeline.tracks
    session.document.keys.set(KeyRef(KICK_KEYS, place) for place in (1, 2))
    row = session.bench.timeline.row_rect("constraints", "kick")
    begin = QPoint(round(tracks.axis.x_of_time(KEY_TIMES[1])), row.top() + 16)
    QTest.mousePress(tracks, LEFT, NO_KEY, begin)
    for step in (6, 14):
        QTest.mouseMove(tracks, begin + QPoint(step, 0))
    session.rest(0.3)
    image = session.picture(part=_part(session, [session.window.docks["Timeline"]]))
    QTest.mouseRelease(tracks, LEFT, NO_KEY, begin + QPoint(14, 0))
    session.close()
    return image


def dope_sheet() -> QImage:
    """The keys of two constraints and a prop in rows."""
    session = _keyed()
    session.document.selection.clear()
    session.bench.timeline.set_dope(True)
    session.rest(0.3)
    return _taken(session, [session.window.docks["Timeline"]])


def curve_editor() -> QImage:
    """The values of a target with a free tangent, over the speed of the feet."""
    session = _keyed()
    session.bench.timeline.edit_curves(True)
    curves, shown = session.bench.timeline.tracks.picture.curves, session.bench.timeline.tracks.shown
    channel, keyed = next(pair for pair in curves.channels(shown) if pair[0].name == "z")
    bent = with_handle(channel, keyed, 1, TangentSide.OUT, 0.08, 0.12)
    replace_fields(session.document, {KICK_KEYS: bent}, "Move tangent")
    session.document.keys.set([KeyRef(KICK_KEYS, 1)])
    session.settle()
    session.rest(0.3)
    return _taken(session, [session.window.docks["Timeline"]])


def clip_speed() -> QImage:
    """The middle of a walk slowed to a third by keys of its speed."""
    session = Session("walk_turn", (1180, 700))
    performers = session.document.project.performers
    performer_id = next(iter(performers))
    clip = performers[performer_id].clips[0]
    times = tuple(frame / session.document.project.frame_rate_of(clip) for frame in (90, 105, 150, 165))
    set_speed(session.document, clip.id, KeyedNumber(times, (1.0, 1 / 3, 1 / 3, 1.0)), "Key speed")
    session.document.selection.set(("performers", performer_id), ("clips", clip.id))
    session.document.keys.set([KeyRef(KeyedField("clips", clip.id, "speed"), 2)])
    session.bench.timeline.edit_curves(True)
    session.bench.timeline.fit()
    session.settle()
    session.rest(0.3)
    return _taken(session, [session.window.docks["Timeline"]])


def footage() -> QImage:
    """A film in its panel and on the timeline, over the waveform of a sound."""
    session = Session("front_kick", (1180, 780))
    with TemporaryDirectory() as folder:
        sound = Path(folder) / "steps.wav"
        with wave.open(str(sound), "wb") as file:
            file.setparams((1, 2, CLICK_RATE, 0, "NONE", "not compressed"))
            file.writeframes(_clicks((0.55, 1.1, KICK_TIME, 2.3), 3.0).tobytes())
        add_sound(session.bench, sound)
        session.until(lambda: bool(session.document.project.sounds))
    session.document.playhead.set_time(KICK_TIME)
    add_footage(session.bench, KICK_FILM)
    session.until(lambda: not session.window.footage_playback.view.image.isNull())
    session.window.strip.clear()
    session.rest(0.3)
    return _taken(session, [session.window.docks["Footage"], session.window.docks["Timeline"]])


def _clicks(times: tuple[float, ...], seconds: float) -> NDArray[np.int16]:
    """(N,) samples with a tone that dies away at each of the times."""
    since = np.arange(round(seconds * CLICK_RATE))[:, None] / CLICK_RATE - np.array(times)
    tones = np.where(since >= 0.0, np.exp(-20.0 * np.maximum(since, 0.0)) * np.sin(3000.0 * since), 0.0)
    return np.asarray(20_000 * tones.sum(axis=1)).astype(np.int16)


def _keyed() -> Session:
    """The kick at a target that has keys, a guard and a prop that moves."""
    session = Session("front_kick", (1040, 1040))
    path = KeyedPlace(KEY_TIMES, tuple((0.7 + 0.05 * k, 0.02 * k, 0.9 + 0.1 * (k % 3)) for k in range(len(KEY_TIMES))))
    kick = replace(kick_target(), target=path)
    session.document.put_all("constraints", {"kick": kick}, "Add 'Kick target'")
    session.document.add("constraints", left_wrist(), "Add 'Guard up'")
    session.document.add("props", Prop("Ball", position=path.moved(-0.5)), "Add 'Ball'")
    session.document.selection.set(("constraints", "kick"))
    session.document.playhead.set_time(KICK_TIME)
    session.settle()
    shown = session.bench.timeline
    shown.tracks.axis.show(1.5, 3.2)
    session.rest(0.3)
    return session


def import_report() -> QImage:
    """A dropped walk: what was read and guessed."""
    session = Session("front_kick", (1280, 1080))
    session.window.open_paths([example("walk_turn")])
    session.until(lambda: len(session.document.project.captures) == 2)
    session.settle()
    session.document.playhead.set_time(2.2)
    session.window.actions_by_id.by_id["report"].trigger()
    session.settle()
    session.look(35, 8, 1.15)
    return _taken(session, [session.bench.viewport, session.window.docks["Inspector"]])


def markers() -> QImage:
    """The markers of a walk that was written as C3D: the map on the figure."""
    session = Session("walk_turn", (1280, 900))
    with TemporaryDirectory() as folder:
        path = Path(folder) / "walk.c3d"
        write_capture(load_capture(example("walk_turn")), path)
        session.window.open_paths([path])
        session.until(lambda: len(session.document.project.captures) == 2)
        session.settle()
    dialog = open_markers(session.bench, list(session.document.project.captures)[-1])
    dialog.assistant.choose_role("left_knee")
    session.rest(0.5)
    image = dialog.grab().toImage()
    session.close()
    return image


def behaviour() -> QImage:
    """Two who spar, and the states of one of them."""
    session = Session("front_kick", (1280, 840))
    session.document.new(next(scene for scene in SCENES if scene.title == "Sparring").make())
    session.window.show_dock("Behaviour")
    session.settle()
    one = next(iter(session.document.project.performers))
    behaviour_id = session.document.project.behaviour_of(one)
    session.document.selection.set(("performers", one), ("states", f"{behaviour_id}/Low punch"))
    session.window.behaviour.show_running(one, "Guard")
    session.look(60, 8, 1.25)
    session.window.behaviour.diagram.fit()
    session.rest(0.3)
    return _taken(session)


def sliders() -> QImage:
    """The form of a body, whose arms were made longer and whose legs were made shorter."""
    session = Session("walk_turn", (1280, 980))
    woman = session.document.project.characters["adult_woman"]
    longer = replace(woman, proportions=Proportions(upper_arms=1.25, forearms=1.3, thighs=0.8, shanks=0.8))
    session.document.replace("characters", "adult_woman", longer, "Set arms and legs")
    session.document.selection.set(("performers", "adult_woman"))
    session.document.playhead.set_time(2.2)
    session.settle()
    session.look(30, 6, 1.3, among=("stocky_man", "tall_man", "adult_woman"))
    return _taken(session, [session.bench.viewport, session.window.docks["Inspector"]])


def preferences() -> QImage:
    """The preferences with the keymap of Blender."""
    session = Session("front_kick", (1280, 980))
    dialog = PreferencesDialog(session.bench)
    dialog.map.setCurrentIndex(next(k for k in range(dialog.map.count()) if dialog.map.itemText(k) == "Blender"))
    dialog.map.activated.emit(dialog.map.currentIndex())
    dialog.show()
    session.rest(0.3)
    image = dialog.grab().toImage()
    dialog.close()
    session.close()
    return image


def problem_table() -> QImage:
    """A constraint on five characters, the worst error first."""
    session = Session("front_kick", (1100, 900))
    _aim(session, "child")
    session.window.show_dock("Problems")
    session.rest(1.0)
    return _taken(session, [session.window.docks["Problems"]])


def skin_point() -> QImage:
    """A point on the back of a forearm is picked, and the studio offers to constrain it."""
    session = Session("reach_grasp", (1100, 860))
    session.document.playhead.set_time(2.2)
    session.settle()
    viewport = session.bench.viewport
    session.look(10, 6, 1.3, among=("adult_woman",))
    points, layout = viewport.posed["adult_woman"].points, viewport.posed["adult_woman"].motion.morphology.layout
    forearm = 0.5 * (points[layout.wrist_point(1)] + points[layout.wrist_point(1) - 1])
    viewport.begin_skin_pick()
    QTest.mouseClick(viewport, LEFT, NO_KEY, viewport.widget_point(forearm).toPoint())
    session.rest(0.3)
    middle = viewport.mapTo(session.window, viewport.widget_point(forearm).toPoint())
    image = session.picture(QRect(middle - QPoint(180, 100), QSize(480, 300)))
    session.close()
    return image


def poses() -> QImage:
    """Poses of one body in their panel, kept in a folder that goes."""
    with TemporaryDirectory() as folder:
        os.environ["XDG_DATA_HOME"] = folder
        session = Session("reach_grasp", (1280, 780))
        session.document.selection.set(("performers", "adult_woman"))
        session.window.show_dock("Poses")
        panel = session.window.pose_library.panel
        for time in (0.5, 2.2, 3.4, 4.6):
            session.document.playhead.set_time(time)
            session.settle()
            panel.save.click()
            QTest.keyClick(panel.poses.viewport().findChild(QLineEdit), Qt.Key.Key_Return)
            session.rest(0.3)
        image = _taken(session, [panel])
        del os.environ["XDG_DATA_HOME"]
    return image


def _aim(session: Session, performer_id: str) -> None:
    key = session.document.add("constraints", kick_target(), "Add 'Kick target'")
    session.document.selection.set(("performers", performer_id), ("constraints", key))
    session.document.playhead.set_time(KICK_TIME)
    session.settle()


def _taken(session: Session, parts: list[QWidget] | None = None) -> QImage:
    """The picture of the window, or of the parts of it that lie side by side; the session ends."""
    image = session.picture(part=_part(session, parts) if parts else None)
    session.close()
    return image


def _part(session: Session, parts: list[QWidget]) -> QRect:
    """Rectangle of the window that holds these parts."""
    part = QRect()
    for widget in parts:
        part = part.united(QRect(widget.mapTo(session.window, QPoint(0, 0)), widget.size()))
    return part
