"""Measurements of the window, and their tables."""

import argparse
import hashlib
import os
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from PySide6.QtCore import QPointF, QRect, QTimer
from PySide6.QtGui import QColor, QPainter, QPen, QPixmap
from PySide6.QtWidgets import QStyle, QStyleOptionSlider, QWidget

from benchmarks.clips import ROOT
from benchmarks.listening import Silences, queued, run_window
from benchmarks.machine import machine
from benchmarks.report import number, table
from benchmarks.window_hand import Hand, Move
from benchmarks.window_parts import Parts
from benchmarks.window_scene import DRAGGED, HELD, long_clip, open_clip, open_window
from studio.app.main_window import MainWindow
from studio.cli.bench import frame_cases
from studio.cli.bench_timing import time_jobs
from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.own_place import OwnPlace
from studio.core.solver.adapt import adapt
from studio.core.solver.performers.staged_performances import adapt_performers
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.stage.project import GROUND_ID, Project
from studio.document.channels import Channel, TangentSide
from studio.document.key_edits import replace_fields
from studio.document.keyed_fields import Keyed, KeyedField, KeyRef
from studio.engine.live_adaptation import normalized_with_actor
from studio.engine.standing_solver import GroundingSolver
from studio.io.project.character_file import bundled_characters
from studio.library.scenes.fight import fight_training
from studio.timeline.shown import RowContext
from studio.timeline.tracks.value_curves import HandleRef, ValueCurves, plot_area
from studio.viewport.rotate_gizmo import RotateGizmo

WORDS = """# The window under a hand

Written by `make bench`. The real window, 1400 x 900, drawn by software; five skinned bodies (eight in playback), six
constraints of their own priority; a mouse at 60 Hz drags what is named for some seconds. The age of a picture is the
time from the move of the mouse that its pose answers until it is painted, by the clock, whatever else the machine does,
and without the time in which the window's thread was ready and had no processor; what it costs is processor time. Off
is how far the body under the mouse is from what is solved without a window.

"""
ROUNDS = 9
"""Rounds in which the machine's forward kinematics are timed, so that a reader can scale the figures."""
TASKS = "## Ten tasks, counted"
"""Head of what is written by hand at the end of the document."""
BODIES, CROWD = 5, 8
REST = 1500
"""Milliseconds after a drag in which the window comes to rest."""
SETTLED = 6000
"""The same after playback, before what a window at rest computes is measured."""
CHECKED = 4
"""Pictures of a drag that are solved again beside the window."""
AIMS = "aims: median under 33 ms, 95 % under 100 ms, strips within 250 ms of release; 24 pictures/s; 0 % at rest"


@dataclass(frozen=True)
class Picture:
    """Times at which one was painted and at which its answers were asked for, and places of the points of bodies.

    ``waited`` as ``Move`` has it.
    """

    at: float
    waited: float
    asked_at: dict[str, float | None]
    points: dict[str, tuple[int, np.ndarray]]
    """Frame of the motion, and (P, 3) where that is."""


class Watch:
    """Hears of every new picture of the view and of every painting of the timeline."""

    def __init__(self, window: MainWindow, film: Path | None) -> None:
        self._window, self._film = window, film
        self.pictures: list[Picture] = []
        self.rows_current_at: float | None = None
        self._last: object = None
        self._kept: list[QPixmap] = []
        self.hand = QPointF()
        """Place of the mouse on the window."""
        self._asked_at: dict[str, float | None] = {}
        viewport, tracks = window.bench.viewport, window.bench.timeline.tracks
        self._bring, self._paint_over, self._paint_rows = (
            viewport.bring_up_to_date, viewport.paint_over, tracks._paint,
        )  # fmt: skip
        viewport.bring_up_to_date, viewport.paint_over, tracks._paint = self._posed, self._painted, self._rows_painted

    def begin(self) -> None:
        """Forget what was seen."""
        self.pictures, self.rows_current_at = [], None

    def _posed(self, scene: Any) -> None:
        self._bring(scene)
        live = self._window.bench.live
        self._asked_at = {key: live.asked_at(key) for key in self._window.bench.viewport.posed}

    def _painted(self, painter: QPainter) -> None:
        viewport = self._window.bench.viewport
        self._paint_over(painter)
        if viewport._image is not self._last:
            self._last = viewport._image
            points = {key: (pose.frame, pose.motion.positions[pose.row]) for key, pose in viewport.posed.items()}
            self.pictures.append(Picture(time.monotonic(), queued(), self._asked_at, points))
            if self._film is not None:
                QTimer.singleShot(0, self._keep)

    def _keep(self) -> None:
        """The view as it is seen, with a ring where the mouse is now."""
        viewport = self._window.bench.viewport
        picture = viewport.grab()
        with QPainter(picture) as painter:
            painter.setPen(QPen(QColor("white"), 2.0))
            painter.drawEllipse(viewport.mapFrom(self._window, self.hand), 9.0, 9.0)
        self._kept.append(picture)

    def write_film(self) -> None:
        """All pictures that were kept, a file each."""
        for index, picture in enumerate(self._kept):
            assert self._film is not None
            self._film.mkdir(parents=True, exist_ok=True)
            picture.save(str(self._film / f"{index:04}.png"))

    def _rows_painted(self, *arguments: Any) -> None:
        self._paint_rows(*arguments)
        live = self._window.bench.live
        performers = self._window.bench.document.project.performers
        if self.rows_current_at is None and not live.interactive and all(map(live.reported_motion, performers)):
            self.rows_current_at = time.monotonic()


@dataclass(frozen=True)
class Result:
    """Of one drag: milliseconds, pictures, and processor milliseconds a picture by part."""

    name: str
    ages: list[float]
    ready: list[float]
    """The same without the time in which the window's thread waited for a processor after it took the move."""
    oldest: list[float]
    """Age of the body that is furthest behind, in every picture."""
    pictures_a_second: float
    silence: float
    rows_after: float
    parts: dict[str, float]
    off: list[float]
    """Millimetres between bodies of pictures and what is solved beside: of that frame alone, and of the whole clip."""


def drag(window: MainWindow, watch: Watch, parts: Parts, name: str, seconds: float) -> Result:
    """One drag of ``DRAGS``."""
    widget, start, reach = DRAGS[name](window)
    document, moves, projects = window.bench.document, [], []

    def moved(move: Move) -> None:
        moves.append(move)
        watch.hand = widget.mapTo(window, move.place)
        projects.append(document.project)

    hand = Hand(widget, start, reach, moved)
    watch.begin()
    silences = Silences()
    hand.press()
    parts.begin()
    begun = time.monotonic()
    run_window(round(1000 * seconds))
    shown, spent, lasted = list(watch.pictures), parts.end(), time.monotonic() - begun
    silences.stop()
    released = time.monotonic()
    hand.release()
    watch.rows_current_at = None
    window.bench.timeline.tracks.update()  # where the hand had rested, strips tell of it already
    run_window(REST)
    while watch.rows_current_at is None and time.monotonic() < released + 60.0:
        run_window(20)
    active = document.active_performer_id or ""
    seen = [(picture, _move_of(picture.asked_at.get(active), moves)) for picture in shown]
    answers = [(picture, moves[place]) for picture, place in seen if place is not None]
    ages = [1000 * (picture.at - move.at) for picture, move in answers]
    ready = [1000 * (picture.at - move.at - picture.waited + move.waited) for picture, move in answers]
    oldest = [
        1000 * (picture.at - min(moves[place].at for place in places))
        for picture in shown
        if picture.asked_at
        if None not in (places := [_move_of(each, moves) for each in picture.asked_at.values()])
    ]
    # The project after a move is what the hand of the next one found.
    checked = [
        (picture, projects[place + 1]) for picture, place in seen if place is not None and place + 1 < len(moves)
    ]
    off = [_off(window, *each) for each in checked[:: max(len(checked) // CHECKED, 1)]]
    rows_after = 1000 * ((watch.rows_current_at or np.inf) - released)
    each = {part: 1000 * value / max(len(shown), 1) for part, value in spent.items()}
    return Result(
        name, ages, ready, oldest, len(shown) / lasted, 1000 * silences.longest[0], rows_after, each,
        np.max(off, axis=0).tolist() if off else [],
    )  # fmt: skip


def _move_of(asked_at: float | None, moves: Sequence[Move]) -> int | None:
    """The last move that was taken before something was asked."""
    taken = np.array([move.taken for move in moves])
    return None if asked_at is None or asked_at < taken[0] else int(np.searchsorted(taken, asked_at)) - 1


def _off(window: MainWindow, picture: Picture, project: Project) -> tuple[float, float]:
    """Millimetres between the active body in a picture and what is solved without a window: frame by frame, eased."""
    active = window.bench.document.active_performer_id or ""
    row, points = picture.points[active]

    def solved(eased: bool) -> AdaptedMotion:
        def solve(request: AdaptRequest) -> AdaptedMotion:
            return adapt(replace(request, eased=eased))

        return adapt_performers(project, [active], normalized_with_actor, solve).performances[active].adapted

    def distance(motion: AdaptedMotion) -> float:
        return float(1000 * np.abs(motion.positions[row] - points).max())

    return distance(solved(False)), distance(solved(True))


def _target(window: MainWindow) -> tuple[QWidget, QPointF, QPointF]:
    _select(window, ("constraints", DRAGGED))
    viewport = window.bench.viewport
    return viewport, QPointF(*viewport.gizmo().centre), QPointF(45.0, 30.0)


def _slider(window: MainWindow) -> tuple[QWidget, QPointF, QPointF]:
    _select(window)
    [slider] = [each for each in _fields(window, "Upper arms") if hasattr(each, "sliderPosition")]
    window.inspector.ensureWidgetVisible(slider)
    run_window(200)
    option = QStyleOptionSlider()
    slider.initStyleOption(option)
    control, handle = QStyle.ComplexControl.CC_Slider, QStyle.SubControl.SC_SliderHandle
    return slider, QPointF(slider.style().subControlRect(control, option, handle, slider).center()), QPointF(25.0, 0.0)


def _curve(window: MainWindow) -> tuple[QWidget, QPointF, QPointF]:
    _select(window, ("constraints", DRAGGED))
    timeline = window.bench.timeline
    return timeline.tracks, QPointF(timeline.handle_point(DRAGGED, "fade-in end")), QPointF(60.0, 0.0)


def _ground(window: MainWindow) -> tuple[QWidget, QPointF, QPointF]:
    _select(window, ("grounds", GROUND_ID))
    [field] = [each for each in _fields(window, "Height") if hasattr(each, "lineEdit")]
    line = field.lineEdit()
    return line, QPointF(line.rect().center()), QPointF(25.0, 0.0)


def _key(window: MainWindow) -> tuple[QWidget, QPointF, QPointF]:
    channel, keyed, curves, shown, area = _edited_curve(window)
    return window.bench.timeline.tracks, curves.point(shown, area, channel, keyed, 1), QPointF(12.0, 20.0)


def _tangent(window: MainWindow) -> tuple[QWidget, QPointF, QPointF]:
    channel, keyed, curves, shown, area = _edited_curve(window)
    handle = curves.handle_point(shown, area, HandleRef(channel, 1, TangentSide.OUT), keyed)
    assert handle is not None
    return window.bench.timeline.tracks, handle, QPointF(8.0, 20.0)


def _edited_curve(window: MainWindow) -> tuple[Channel, Keyed, ValueCurves, RowContext, QRect]:
    """The height of the target that is dragged, with three keys of which the middle one is selected and seen."""
    document, timeline = window.bench.document, window.bench.timeline
    field = KeyedField("constraints", DRAGGED, "target")
    target = document.project.constraints[DRAGGED].target
    if isinstance(target, OwnPlace):
        middle = target.time
        keyed = target.keyed(middle).with_key(middle - HELD, (0.0, 0.0, 0.0)).with_key(middle + HELD, (0.0, 0.0, 0.05))
        replace_fields(document, {field: keyed}, "Key target")
    _select(window, field.item)
    timeline.edit_curves(True)
    document.keys.set([KeyRef(field, 1)])
    run_window(500)
    tracks = timeline.tracks
    curves, shown, area = tracks.picture.curves, tracks.shown, plot_area(tracks.sheet.plot)
    channel, value = next(each for each in curves.channels(shown) if each[0].name == "z")
    return channel, value, curves, shown, area


def _ring(window: MainWindow) -> tuple[QWidget, QPointF, QPointF]:
    document, viewport = window.bench.document, window.bench.viewport
    constraint = document.project.constraints[DRAGGED]
    point = BodyPoint(BodyPart.LEFT_UPPER_ARM, at_end=True)
    turned = OrientationConstraint(
        constraint.motion_id, "left arm", point, constraint.chain, len(document.project.constraints),
        constraint.activation,
    )  # fmt: skip
    key = document.add("constraints", turned, "Add orientation")
    _select(window, ("constraints", key))
    viewport.set_tool("rotate")
    run_window(500)
    gizmo = viewport.gizmo()
    assert isinstance(gizmo, RotateGizmo)
    return viewport, QPointF(*gizmo.ring("z")[42].tolist()), QPointF(30.0, 20.0)


def _select(window: MainWindow, *items: tuple[str, str]) -> None:
    document = window.bench.document
    document.selection.set(("performers", next(iter(document.project.performers))), *items)
    run_window(300)


def _fields(window: MainWindow, name: str) -> list[Any]:
    return [each for each in window.inspector.findChildren(QWidget) if each.accessibleName() == name]


DRAGS: dict[str, Callable[[MainWindow], tuple[QWidget, QPointF, QPointF]]] = {
    "target": _target, "slider of a measure": _slider, "curve's handle": _curve, "ground's height": _ground,
    "key of a target": _key, "tangent": _tangent, "ring": _ring,
}  # fmt: skip
"""A drag: on which widget, from where, how far."""


def playback(window: MainWindow, watch: Watch, parts: Parts, seconds: float) -> str:
    """Pictures a second while all play, how steady they are, and what a window at rest computes."""
    playhead = window.bench.document.playhead
    playhead.play()
    told = seen(f"{CROWD} bodies play", watch, parts, seconds)
    playhead.pause()
    run_window(SETTLED)
    rested, begun = time.process_time(), time.monotonic()
    run_window(3000)
    rest = 100 * (time.process_time() - rested) / (time.monotonic() - begun)
    return f"{told}\nAt rest the window computes {rest:.1f} % of a core.\n"


def fight(window: MainWindow, watch: Watch, parts: Parts, seconds: float) -> str:
    """Scene 8, the fight training: from the timeline, then live, where all in white kick every three seconds."""
    document, play = window.bench.document, window.bench.live.play
    document.playhead.play()
    told = seen("The fight training plays from the timeline", watch, parts, seconds)
    document.playhead.pause()
    kicking, moments = QTimer(interval=3000), set[float]()
    kicking.timeout.connect(lambda: play.press("X"))
    play.begin()
    kicking.start()
    play.stepped.connect(lambda: moments.add(play.seconds))
    lasted = seen("The fight training plays live", watch, parts, seconds)
    kicking.stop()
    play.end()
    return f"{told}\n{lasted}\nThe stage made {len(moments) / (seconds + 0.5):.1f} steps a second.\n"


def seen(what: str, watch: Watch, parts: Parts, seconds: float) -> str:
    """Pictures a second, how steady they are and what they cost."""
    run_window(500)
    watch.begin()
    parts.begin()
    begun = time.monotonic()
    run_window(round(1000 * seconds))
    lasted, spent, times = time.monotonic() - begun, parts.end(), [each.at for each in watch.pictures]
    steps = [1000 * (after - before) for before, after in pairwise(times)]
    each = {part: 1000 * value / len(times) for part, value in spent.items()}
    rows = [[name, f"{value:.1f}"] for name, value in each.items() if value > 0.05]
    return (
        f"{what}: {len(times) / lasted:.1f} pictures/s; from one to the next {np.median(steps):.0f} ms "
        f"(95 %: {np.percentile(steps, 95):.0f}).\n\n" + table(("part", "processor ms a picture"), rows)
    )


def tables(results: Sequence[Result]) -> str:
    """Ages and processor times."""
    ages = [
        [each.name, f"{np.median(each.ages):.0f}", f"{np.percentile(each.ages, 95):.0f}",
         f"{np.median(each.ready):.0f}", f"{np.percentile(each.ready, 95):.0f}",
         number(np.median(each.oldest) if each.oldest else None, "{:.0f}"), f"{each.pictures_a_second:.1f}",
         f"{each.silence:.0f}", f"{each.rows_after:.0f}", " / ".join(f"{value:.2f}" for value in each.off)]
        for each in results if each.ages
    ]  # fmt: skip
    titles = (
        "dragged", "age, ms, median", "95 %", "not waiting for a processor, median", "95 %",
        "body furthest behind, median", "pictures/s", "longest silence, ms",
        "strips after release, ms", "off, mm: frame / eased clip",
    )  # fmt: skip
    names = dict.fromkeys(part for each in results for part in each.parts)
    parts = [[name, *(f"{each.parts.get(name, 0.0):.1f}" for each in results)] for name in names]
    spent = table(("processor ms a picture", *(each.name for each in results)), parts)
    return table(titles, ages) + f"\n({AIMS}.)\n\n" + spent


def slow_down(factor: float) -> None:
    """Make every solve take ``factor`` times its processor time, without Python's lock, as on a slower machine."""
    solve, block = GroundingSolver.__call__, bytes(100_000)

    def solve_slowly(self: GroundingSolver, request: AdaptRequest, first: int, last: int | None) -> AdaptedMotion:
        begun = time.thread_time()
        solved = solve(self, request, first, last)
        end = begun + factor * (time.thread_time() - begun)
        while time.thread_time() < end:
            hashlib.sha256(block)
        return solved

    GroundingSolver.__call__ = solve_slowly  # type: ignore[method-assign]


def main(arguments: Sequence[str]) -> int:
    """Measure, print, write; a run that is slowed or has other bodies writes nothing."""
    parser = argparse.ArgumentParser(prog="benchmarks.window")
    parser.add_argument("--seconds", type=float, default=5.0)
    parser.add_argument("--only", choices=[*DRAGS, "playback", "fight"])
    parser.add_argument("--bodies", type=int, default=BODIES, help="bodies of the drags")
    parser.add_argument("--film", type=Path)
    parser.add_argument("--slow", type=float, default=1.0, help="times as much processor time as a solve takes")
    options = parser.parse_args(arguments)
    slow_down(options.slow)
    parts, clip, told = Parts(), long_clip(), []
    with tempfile.TemporaryDirectory() as folder:
        if options.only in (None, *DRAGS):
            window = open_clip(clip, options.bodies, Path(folder))
            chosen = [options.only] if options.only else list(DRAGS)
            watch = Watch(window, options.film)
            told.append(tables([drag(window, watch, parts, name, options.seconds) for name in chosen]))
            watch.write_film()
            _close(window)
        if options.only in (None, "playback"):
            window = open_clip(clip, CROWD, Path(folder))
            told.append(playback(window, Watch(window, None), parts, options.seconds))
            _close(window)
        if options.only in (None, "fight"):
            window = open_window(fight_training(), Path(folder))
            told.append(fight(window, Watch(window, None), parts, options.seconds))
            _close(window)
    [kinematics] = time_jobs([frame_cases(clip, bundled_characters()["adult_woman"])[0].job], ROUNDS)
    words = (
        WORDS + f"{clip.capture.name}, {clip.motion.frame_count} frames; {machine()}; load {os.getloadavg()[0]:.1f}; "
        f"forward kinematics alone {kinematics.median:.2f} µs a frame.\n"
    )
    text = "\n".join([words, *told])
    print(text)
    if options.only is None and (options.slow, options.bodies) == (1.0, BODIES):
        document = ROOT / "docs" / "window.md"
        _, tasks, counted = document.read_text(encoding="utf-8").partition(TASKS)
        document.write_text(f"{text}\n{tasks}{counted}", encoding="utf-8")
    return 0


def _close(window: MainWindow) -> None:
    window.close_without_saving()
    window.deleteLater()
    run_window(100)
