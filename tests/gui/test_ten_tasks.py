"""Ten tasks of an animator, by mouse and keys on the whole window: none needs a typed number, each is measured.

With MORPHO_FILM=FOLDER the window is written there after every act: one numbered picture each, a folder a task.
"""

import os
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from scipy.spatial.transform import Rotation

from studio import api
from studio.app.application import show_views
from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.distance import DistanceConstraint
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.scope import Scope
from studio.core.curves.activation import ActivationCurve
from studio.core.curves.keyed import KeyedPlace
from studio.core.quality.contact_tracks import contact_tracks
from studio.core.solver.adapt import body_point_positions
from studio.core.stage.sound_track import SoundTrack
from studio.document.channels import TangentSide
from studio.engine.residuals import worst_residual
from studio.timeline.menus import menu_at
from studio.timeline.tracks.value_curves import HandleRef, plot_area
from tests.gui import viewport_use
from tests.gui.test_corrections import turn_by_ring
from tests.gui.viewport_use import joint_pixel, settle
from tests.patience import PATIENCE

RATE = 60.0
LEFT, NONE = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
CTRL, SHIFT, ALT = (getattr(Qt.KeyboardModifier, f"{name}Modifier") for name in ("Control", "Shift", "Alt"))
WRISTS = {side: BodyPoint(BodyPart[f"{side}_FOREARM"], at_end=True) for side in ("LEFT", "RIGHT")}
LOOKED_AT_MS = 400
"""Milliseconds in which somebody sees that a problem is gone; strips and summaries follow within 250."""
HELD = 0.002
"""Metres: nobody sees less."""


@dataclass
class User:
    """A person at the window; what is done is counted."""

    window: object
    clicks: int = 0
    drags: int = 0
    keys: int = 0
    pictures: int = 0

    def film(self):
        """Write the window as it is now, if films are wanted."""
        if "MORPHO_FILM" in os.environ:
            task = os.environ["PYTEST_CURRENT_TEST"].partition("::")[2].partition("[")[0]
            folder = Path(os.environ["MORPHO_FILM"]) / task
            folder.mkdir(parents=True, exist_ok=True)
            self.window.grab().save(str(folder / f"{self.pictures:03}.png"))
            self.pictures += 1

    @property
    def done(self):
        """Clicks, drags and keys so far."""
        return self.clicks, self.drags, self.keys

    @property
    def document(self):
        return self.window.bench.document

    @property
    def project(self):
        return self.document.project

    @property
    def timeline(self):
        return self.window.bench.timeline

    @property
    def viewport(self):
        return self.window.bench.viewport

    def click(self, point, widget=None, modifiers=NONE):
        self.clicks += 1
        QTest.mouseClick(widget or self.timeline.tracks, LEFT, modifiers, point)
        QTest.qWait(5)
        self.film()

    def drag(self, begin, end, widget=None, modifiers=NONE):
        self.drags += 1
        viewport_use.drag(widget or self.timeline.tracks, begin, end, modifiers=modifiers)
        QTest.qWait(5)
        self.film()

    def press(self, key, modifiers=NONE, widget=None):
        self.keys += 1
        QTest.keyClick(widget or self.viewport, key, modifiers)
        QTest.qWait(5)
        self.film()

    def choose(self, point, *texts):
        """An entry of the menu of the right mouse button: two clicks, one more for each submenu."""
        self.clicks += 1 + len(texts)
        entries = menu_at(self.timeline.tracks, point.toPointF()).actions()
        for text in texts[:-1]:
            entries = next(entry.menu() for entry in entries if entry.text() == text).actions()
        next(entry for entry in entries if entry.text() == texts[-1]).trigger()
        self.film()

    def go_to(self, frame):
        """Click the ruler at a frame of the stage."""
        self.click(QPoint(round(self.timeline.x_of_frame(frame)), self.timeline.row_rect("ruler").center().y()))
        assert self.document.playhead.frame == pytest.approx(frame, abs=1)
        self.solved()

    def on_bar(self, constraint_id, frame):
        row = self.timeline.row_rect("constraints", constraint_id)
        return QPoint(round(self.timeline.x_of_frame(frame)), row.top() + 16)

    def solved(self):
        """Every body as it comes to rest, by performer id."""
        live = self.window.bench.live
        assert live.wait_until_solved(PATIENCE / 1000)
        QTest.qWait(20)
        settle(self.viewport)
        self.film()
        return {key: live.result(key) for key in self.project.performers}

    def paths(self, point):
        """(F, 3) of a point of each body, as it is solved."""
        return {key: body_point_positions(point, body) for key, body in self.solved().items()}


@pytest.fixture
def user(window, qtbot) -> Iterator[User]:
    show_views(window)
    user = User(window)
    assert window.bench.live.wait_until_solved(PATIENCE / 1000)
    qtbot.waitUntil(lambda: len(user.viewport.posed) == len(user.project.performers), timeout=PATIENCE)
    user.timeline.fit()
    settle(user.viewport)
    return user


def staged(capture="reach_grasp", bodies=("adult_woman", "child"), made=()):
    """A scene of bodies beside each other that play one capture, with constraints made for its motion."""
    scene = api.new_scene()
    motion = scene.add_capture(api.example_captures_folder() / f"{capture}.bvh")
    for index, body in enumerate(bodies):
        scene.add_performer(scene.add_character(body), motion, position=(0.0, 1.2 * index))
    for make in made:
        scene.add_constraint(make(motion, *scene.project.performers))
    return scene.project


def active(first, last):
    """Active over frames, with a fifth of a second to either side."""
    return ActivationCurve(first / RATE - 0.2, first / RATE, last / RATE, last / RATE + 0.2)


def keyed_hand(frames, places, side="RIGHT"):
    """Maker of a target of a wrist that is keyed at frames."""

    def make(motion, *_):
        keys = KeyedPlace(tuple(frame / RATE for frame in frames), places)
        chain = Chain(trunk=1.0, root=0.5)
        return PositionConstraint(motion, "Reach", WRISTS[side], chain, 0, active(frames[0], frames[-1]), target=keys)

    return make


REACH = keyed_hand((100, 160, 220), ((0.25, -0.25, 0.95), (0.35, -0.2, 1.15), (0.25, -0.25, 0.95)))
SETTLE = keyed_hand((100, 160, 220), ((0.2, -0.25, 0.8), (0.3, -0.2, 1.05), (0.3, -0.2, 1.05)))
WAVE = keyed_hand((100, 125, 150, 175, 200), tuple((0.2, -0.3 - 0.1 * (k % 2), 1.0 + 0.05 * (k % 2)) for k in range(5)))


def only(mapping):
    [(key, value)] = mapping.items()
    return key, value


@pytest.mark.parametrize("project", [staged(made=[REACH])])
def test_1_a_reach_is_retimed_by_its_key(user):
    key, before = only(user.project.constraints)
    place = before.target.values[1]
    earlier = {
        body: np.linalg.norm(path - place, axis=1).argmin() for body, path in user.paths(WRISTS["RIGHT"]).items()
    }
    user.click(user.on_bar(key, 160))
    user.drag(user.on_bar(key, 160), user.on_bar(key, 180))
    assert user.done == (1, 1, 0)
    moved = round(user.project.constraints[key].target.times[1] * RATE) - 160
    assert moved == pytest.approx(20, abs=1)
    for body, path in user.paths(WRISTS["RIGHT"]).items():
        distance = np.linalg.norm(path - place, axis=1)
        assert distance.min() < HELD
        assert distance.argmin() - earlier[body] == pytest.approx(moved, abs=1)


@pytest.mark.parametrize("project", [staged(made=[SETTLE])])
def test_2_a_hand_eases_in_overshoots_and_holds_by_tangents(user):
    key, before = only(user.project.constraints)
    user.click(user.on_bar(key, 110))
    user.press(Qt.Key.Key_E, SHIFT)
    user.timeline.tracks.grab()
    curves, shown = user.timeline.tracks.picture.curves, user.timeline.tracks.shown
    area = plot_area(user.timeline.tracks.sheet.plot)
    channel, keyed = next(each for each in curves.channels(shown) if each[0].name == "z")
    first, risen = (curves.point(shown, area, channel, keyed, place).toPoint() for place in (0, 1))
    user.click(first)
    user.choose(first, "Flat tangents")
    user.click(risen)
    handle = curves.handle_point(shown, area, HandleRef(channel, 1, TangentSide.IN), keyed).toPoint()
    user.drag(handle, handle - QPoint(0, 60), modifiers=ALT)
    assert user.done == (5, 1, 1)
    target = user.project.constraints[key].target
    for path in user.paths(WRISTS["RIGHT"]).values():
        height = path[:, 2]
        assert height[101] - height[100] < HELD
        assert height[125:160].max() > before.target.values[1][2] + 0.02
        assert np.ptp(path[166:220], axis=0).max() < HELD
    assert target.times == before.target.times


def hand_turn(motion, *_):
    turned = tuple(Rotation.from_euler("ZYX", (-0.2, 0.5, 0.3)).as_quat().tolist())
    return OrientationConstraint(
        motion, "Hand", BodyPoint(BodyPart.RIGHT_HAND), Chain(end_segment=1.0), 0, active(120, 200), target=turned
    )


@pytest.mark.parametrize("project", [staged(made=[hand_turn])])
def test_3_a_hand_target_is_rotated_by_30_degrees_about_its_own_axis(user):
    key, before = only(user.project.constraints)
    user.go_to(160)
    user.click(user.on_bar(key, 160))
    user.press(Qt.Key.Key_F)
    user.press(Qt.Key.Key_E)
    while user.viewport.gizmo_space.name != "LOCAL":
        user.press(Qt.Key.Key_T)
    settle(user.viewport)
    gizmo = user.viewport.gizmo()
    part = max("xyz", key=lambda each: abs(float(gizmo.axis(each) @ gizmo.sight)))
    ring = gizmo.ring(part)
    grips = [side for side in np.flatnonzero(gizmo.in_front(part)) if gizmo.part_at(*np.rint(ring[side])) == part]
    begin, end = (ring[(grips[len(grips) // 2] + step) % len(ring)] for step in (0, round(33 / 360 * len(ring))))
    user.drag(*(QPoint(*np.rint(each).astype(int).tolist()) for each in (begin, end)), user.viewport, CTRL)
    assert user.done == (2, 1, 3)
    turned = Rotation.from_quat(before.target).inv() * Rotation.from_quat(user.project.constraints[key].target)
    axis = turned.as_rotvec()
    assert np.abs(axis["xyz".index(part)]) == pytest.approx(np.radians(30.0), abs=1e-6)
    assert np.linalg.norm(axis) == pytest.approx(np.radians(30.0), abs=1e-6)
    for body in user.solved().values():
        assert np.nanmax(body.residuals[0][120:201]) < np.radians(1.0)


def hold(motion, first, *_):
    return DistanceConstraint(
        motion,
        "Hold",
        WRISTS["RIGHT"],
        Chain(trunk=0.0),
        0,
        active(120, 300),
        scope=Scope(first),
        other=WRISTS["LEFT"],
        distance=0.3,
    )


def hands_apart(user):
    right, left = user.paths(WRISTS["RIGHT"]), user.paths(WRISTS["LEFT"])
    return {key: np.linalg.norm(right[key] - left[key], axis=1)[120:301] for key in right}


@pytest.mark.parametrize("project", [staged(made=[hold])])
def test_4_a_two_hand_hold_is_copied_to_another_character(user):
    key, _ = only(user.project.constraints)
    first, second = user.project.performers
    assert np.abs(hands_apart(user)[second] - 0.3).max() > 0.05
    user.click(user.on_bar(key, 200))
    user.press(Qt.Key.Key_C, CTRL)
    user.click(joint_pixel(user.viewport, second, "pelvis"), user.viewport)
    user.press(Qt.Key.Key_V, CTRL)
    assert user.done == (2, 0, 2)
    assert {each.scope.performer_id for each in user.project.constraints.values()} == {first, second}
    for apart in hands_apart(user).values():
        assert np.abs(apart - 0.3).max() < HELD


@pytest.mark.parametrize("project", [staged(made=[WAVE])])
def test_5_a_wave_is_mirrored(user):
    key, _ = only(user.project.constraints)
    user.click(user.on_bar(key, 110))
    user.press(Qt.Key.Key_C, CTRL)
    user.press(Qt.Key.Key_V, CTRL | SHIFT)
    assert user.done == (1, 0, 2)
    right, left = user.paths(WRISTS["RIGHT"]), user.paths(WRISTS["LEFT"])
    for body in right:
        assert np.abs(right[body] - left[body] * (1, -1, 1))[100:201].max() < HELD


EARLY = keyed_hand((100, 150, 190), ((0.25, 0.25, 0.95),) * 3, "LEFT")
LATE = keyed_hand((180, 210, 240, 300), ((0.25, -0.25, 0.95),) * 4)


@pytest.mark.parametrize("project", [staged(made=[EARLY, LATE])])
def test_6_all_keys_of_a_scene_from_frame_200_on_are_moved_by_10_frames(user):
    def frames():
        return np.array([
            time * RATE
            for each in user.project.constraints.values()
            for curve in [each.activation]
            for time in (curve.start, curve.full, curve.full_end, curve.end, *each.target.times)
        ])  # fmt: skip

    before = frames()
    user.press(Qt.Key.Key_D, SHIFT)
    user.timeline.tracks.grab()
    sheet = user.timeline.tracks.sheet
    top, bottom = sheet.rect(sheet.rows[0]), sheet.rect(sheet.rows[-1])
    user.drag(
        QPoint(round(user.timeline.x_of_frame(199.3)), bottom.bottom() - 1),
        QPoint(round(user.timeline.x_of_frame(420)), top.top() + 1),
    )
    x, y = round(user.timeline.x_of_frame(240)), top.center().y()
    user.drag(QPoint(x, y), QPoint(round(user.timeline.x_of_frame(250)), y))
    assert user.done == (0, 2, 1)
    assert frames() - before == pytest.approx(np.where(before > 199.5, 10.0, 0.0), abs=1e-6)
    user.document.undo_stack.undo()
    assert frames() == pytest.approx(before, abs=0)


@pytest.mark.parametrize("project", [staged("walk_turn", ("adult_woman",))])
def test_7_an_elbow_of_a_walk_is_corrected_for_half_a_second(user):
    [performer] = user.project.performers
    plain = user.solved()[performer]
    user.go_to(48)
    user.press(Qt.Key.Key_P)
    user.click(joint_pixel(user.viewport, performer, "left elbow"), user.viewport)
    user.press(Qt.Key.Key_F)
    user.press(Qt.Key.Key_E)
    settle(user.viewport)
    turn_by_ring(user.viewport, 25)
    user.drags += 1
    assert user.done == (2, 1, 3)
    posed = user.solved()[performer]
    off = np.linalg.norm(np.asarray(posed.positions) - plain.positions, axis=2).max(axis=1)
    assert off[48] > 0.05
    assert off[np.abs(np.arange(len(off)) - 48) > 0.26 * RATE].max() < 1e-5


def slide(user):
    """Metres that a standing sole of each body moves at most."""
    project = user.project
    return {
        key: float(
            np.nanmax(contact_tracks(body, body.contacts or tuple(project.contacts.values()), project.ground)[0])
        )
        for key, body in user.solved().items()
    }


@pytest.mark.parametrize("project", [staged("walk_turn")])
def test_8_the_middle_of_a_clip_is_slowed_to_a_third_without_a_sliding_foot(user):
    first, _ = user.project.performers
    whole = user.project.performers[first].clips[0]
    before = slide(user)
    row = user.timeline.row_rect("clip", first)
    user.click(QPoint(round(user.timeline.x_of_frame(300)), row.center().y()))
    for frame in (180, 300):
        user.go_to(frame)
        user.press(Qt.Key.Key_B, CTRL)
    middle = user.project.performers[first].clips[1]
    begin, end = middle.start, middle.start + middle.length(RATE)
    x, y = round(user.timeline.x_of_frame(end * RATE)), row.center().y()
    user.drag(QPoint(x - 4, y), QPoint(round(user.timeline.x_of_frame((begin + 3 * (end - begin)) * RATE)) - 4, y),
              modifiers=SHIFT)  # fmt: skip
    assert user.done == (3, 1, 2)
    early, slow, late = user.project.performers[first].clips
    assert slow.speed == pytest.approx(1 / 3, rel=0.02)
    assert late.start == pytest.approx(slow.start + slow.length(RATE), abs=1e-6)
    assert (early.first, late.last) == (whole.first, whole.last)
    for key, amount in slide(user).items():
        assert amount < max(before[key], 0.001) + HELD


@pytest.mark.parametrize("project", [staged("walk_turn")])
def test_8_the_middle_is_slowed_by_keys_of_the_speed_too(user):
    first, _ = user.project.performers
    whole = user.project.performers[first].clips[0]
    before, y = slide(user), user.timeline.row_rect("clip", first).center().y()
    user.click(QPoint(round(user.timeline.x_of_frame(330)), y))
    for frame in (170, 180, 300, 310):
        user.go_to(frame)
        user.press(Qt.Key.Key_S)
    user.press(Qt.Key.Key_E, SHIFT)
    curves, shown = user.timeline.tracks.picture.curves, user.timeline.tracks.shown
    area = plot_area(user.timeline.tracks.sheet.plot)
    [(channel, keyed)] = curves.channels(shown)
    second, third = (curves.point(shown, area, channel, keyed, place).toPoint() for place in (1, 2))
    user.click(second)
    user.click(third, modifiers=CTRL)
    user.drag(third, QPoint(third.x(), round(curves.y_of(shown, area, channel, 1 / 3))))
    assert user.done == (7, 1, 5)
    clip = user.project.performers[first].clips[0]
    assert clip.speed.values == pytest.approx((1.0, 1 / 3, 1 / 3, 1.0), abs=0.02)
    assert clip.length(RATE) == pytest.approx(whole.length(RATE) + 2 * 120 / RATE, abs=0.4)
    for key, amount in slide(user).items():
        assert amount < max(before[key], 0.001) + HELD


@pytest.mark.parametrize(
    "project",
    [
        replace(
            staged("walk_turn", ("adult_woman",)),
            sounds={"steps": SoundTrack("Steps", "steps.wav", (0, 255) * 400, (1.0, 223.0 / RATE, 5.0))},
        )
    ],
)
def test_9_a_contact_is_matched_to_a_beat(user):
    [(key, before)] = [
        (key, each) for key, each in user.project.contacts.items()
        if each.point.name == "LEFT_HEEL" and each.last == 211
    ]  # fmt: skip
    bar = user.timeline.contact_rect(key)
    edge = QPoint(bar.right() - 1, bar.center().y())
    user.drag(edge, edge + QPoint(round(user.timeline.x_of_frame(222.6) - user.timeline.x_of_frame(211)), 0))
    assert user.done == (0, 1, 0)
    matched = user.project.contacts[key]
    assert (matched.first, matched.last) == (before.first, 223)
    assert max(slide(user).values()) < HELD


SLOWLY = 0.8
"""Seconds in which a hand goes up, so that reaching alone is no peak."""


def far_target(height, first, last, side="RIGHT"):
    def make(motion, *_):
        y = -0.25 if side == "RIGHT" else 0.25
        curve = ActivationCurve(first / RATE - SLOWLY, first / RATE, last / RATE, last / RATE + SLOWLY)
        return PositionConstraint(motion, f"{side} {first}", WRISTS[side], Chain(), 0, curve, target=(0.25, y, height))

    return make


@pytest.mark.parametrize(
    "project",
    [
        staged(
            bodies=("adult_woman",),
            made=[far_target(1.84, 60, 90), far_target(1.87, 220, 250, "LEFT"), far_target(1.9, 380, 410)],
        )
    ],
)
def test_10_the_three_worst_misses_of_a_scene_are_found_and_mended_by_keys(user, qtbot):
    [performer] = user.project.performers
    user.viewport.setFocus()
    user.press(Qt.Key.Key_W)
    mended = []
    for _ in range(6):  # a peak that comes of a miss goes with it: N passes it by
        QTest.qWait(LOOKED_AT_MS)
        with qtbot.waitSignal(user.window.bench.message_posted, timeout=PATIENCE):
            user.press(Qt.Key.Key_N)
        collection, key = user.document.selection.current
        if collection != "constraints":
            continue
        mended.append(key)
        user.press(Qt.Key.Key_Z)
        while worst_residual(user.project, performer, user.solved()[performer], key).amount > HELD:
            for _ in range(3):
                user.press(Qt.Key.Key_Minus)
        if len(mended) == len(user.project.constraints):
            break
    assert (user.clicks, user.drags) == (0, 0)
    assert user.keys < 60
    assert set(mended) == set(user.project.constraints)
    body = user.solved()[performer]
    assert all(worst_residual(user.project, performer, body, key).amount < HELD for key in mended)
