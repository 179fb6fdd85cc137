"""The real window with a scene as animators make them: skinned bodies, a long clip, six constraints in an order."""

from dataclasses import replace
from pathlib import Path

from benchmarks.clips import BUNDLED, CHOSEN, REAL
from benchmarks.listening import run_window
from studio.app.application import freeze_loaded_objects, import_views, make_application, make_window, show_views
from studio.app.main_window import MainWindow
from studio.app.settings import Settings
from studio.cli.bench_cases import ROOT_CHAIN
from studio.core.body.canonical import BodyPart
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import BodyPoint, Chain, Constraint
from studio.core.constraints.own_place import OwnPlace
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.stage.project import Project
from studio.core.stage.staging import project_of_capture
from studio.document.document import Document
from studio.io.importing import GUESS_ALL
from studio.jobs.adaptation import ADAPTED_MOTION_ID, ReadyCapture, ready_capture
from studio.library.scenes.stagehand import varied_characters
from studio.resources_folder import example_captures_folder
from studio.startup import first_run

SIZE = 1400, 900
DRAGGED = "right wrist"
"""The constraint that is dragged, first in priority."""
AWAY = (0.1, 0.0, 0.08)
"""Leg lengths from where each point is by itself to where it is asked."""
HELD, RAMP = 0.4, 0.3
"""Seconds on either side of the middle in which all is asked wholly, and of the ramps beside."""
_TRUNK = Chain(trunk=1.0)
POINTS = {
    DRAGGED: (BodyPart.RIGHT_FOREARM, _TRUNK), "left wrist": (BodyPart.LEFT_FOREARM, _TRUNK),
    "head": (BodyPart.HEAD, Chain(limb=1.0, end_segment=1.0, clavicle=0.0, trunk=1.0)),
    "right ankle": (BodyPart.RIGHT_SHANK, Chain()), "left ankle": (BodyPart.LEFT_SHANK, Chain()),
}  # fmt: skip


def long_clip() -> ReadyCapture:
    """A conversation of 40 s where real captures are at hand, else a walk."""
    path = REAL / CHOSEN[0] if REAL.is_dir() else example_captures_folder() / BUNDLED[1]
    return ready_capture(path, GUESS_ALL)


def make_scene(clip: ReadyCapture, count: int) -> Project:
    """``count`` bodies side by side; wrists, head, ankles and balance are asked in the middle of the clip."""
    project = project_of_capture(clip.capture, clip.contacts, varied_characters(count), ADAPTED_MOTION_ID)
    middle = middle_of(clip)
    curve = ActivationCurve(middle - HELD - RAMP, middle - HELD, middle + HELD, middle + HELD + RAMP)
    asked: list[Constraint] = []
    for priority, (name, (part, chain)) in enumerate(POINTS.items()):
        point = BodyPoint(part, at_end=True)
        place = OwnPlace(point, middle, AWAY)
        asked.append(PositionConstraint(ADAPTED_MOTION_ID, name, point, chain, priority, curve, target=place))
    asked.append(
        BalanceConstraint(ADAPTED_MOTION_ID, "balance", BodyPoint(BodyPart.PELVIS), ROOT_CHAIN, len(asked), curve)
    )
    return replace(project, constraints={each.name: each for each in asked})


def middle_of(clip: ReadyCapture) -> float:
    """Seconds of the motion at the frame in its middle."""
    return round(clip.motion.frame_count / 2) / clip.motion.frame_rate


def open_window(project: Project, folder: Path) -> MainWindow:
    """The window of ``SIZE`` with all bodies of a project solved."""
    make_application()
    first_run.run()
    window = make_window(Settings(folder / "studio.ini"), Document(journal_folder=folder))
    window.resize(*SIZE)
    window.show()
    window.bench.document.new(project)
    import_views()
    show_views(window)
    freeze_loaded_objects(window)
    assert window.bench.live.wait_until_solved(300.0)
    return window


def open_clip(clip: ReadyCapture, count: int, folder: Path) -> MainWindow:
    """The window with ``make_scene``, the playhead in the middle of the clip."""
    project = make_scene(clip, count)
    window = open_window(project, folder)
    document = window.bench.document
    seconds = middle_of(clip) - clip.capture.first_frame / clip.capture.frame_rate
    document.playhead.set_time(seconds)
    window.bench.timeline.tracks.axis.zoom(5.0, window.bench.timeline.tracks.axis.x_of_time(seconds))
    assert window.bench.live.wait_until_solved(300.0)
    document.selection.set(("performers", next(iter(project.performers))), ("constraints", DRAGGED))
    run_window(1000)
    return window
