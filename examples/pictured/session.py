"""A session of the studio without a display: the real window, told what to do and waited for."""

import math
import os
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

os.environ.update(QT_QPA_PLATFORM="offscreen", VTK_DEFAULT_OPENGL_WINDOW="vtkEGLRenderWindow")

import numpy as np
from PySide6.QtCore import QRect
from PySide6.QtGui import QImage

from studio.app import application, capture_import
from studio.app.settings import Settings
from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.mesh.hand_shapes import FIST_GRIP, RELAXED_GRIP
from studio.core.stage.staging import project_of_capture
from studio.document.document import Document
from studio.io.importing import ImportOptions
from studio.io.project.character_file import bundled_characters
from studio.resources_folder import example_captures_folder
from studio.viewport.camera import OrbitCamera

PATIENCE = 300.0
"""Seconds after which what was waited for is thought to have failed; kernels may have to be compiled first."""
KICK_TIME = 154 / 60
"""Seconds at which the foot of the front kick is highest."""
KICK_TARGET = (1.0, 0.1, 1.2)


class Session:
    """A window of ``size`` pixels with a bundled capture on the bundled characters, standing still."""

    def __init__(self, capture: str, size: tuple[int, int]) -> None:
        self._application = application.make_application()
        self._folder = tempfile.TemporaryDirectory()
        self.window = application.make_window(Settings(Path(self._folder.name) / "studio.ini"), Document())
        self.bench, self.document = self.window.bench, self.window.bench.document
        self.window.resize(*size)
        self.window.show()
        read = capture_import.read_motion(example(capture), ImportOptions(), lambda share, text: None)
        contacts = read.annotations.of_motion(capture).contacts or ()
        grip = FIST_GRIP if "kick" in capture or "punch" in capture else RELAXED_GRIP
        bodies = {name: replace(each, grip=grip) for name, each in bundled_characters().items()}
        self.document.new(project_of_capture(read.capture, contacts, bodies, capture))
        application.import_views()
        application.show_views(self.window)
        self.settle()

    def settle(self) -> None:
        """Wait until every body is adapted and the picture stands."""
        self.until(lambda: bool(self.bench.viewport.posed))
        assert self.bench.live.wait_until_solved(PATIENCE)
        self.rest(0.4)

    def rest(self, seconds: float) -> None:
        """Let the window live for a while."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self._application.processEvents()
            time.sleep(0.002)

    def until(self, happened: Callable[[], bool]) -> None:
        """Let the window live until something has happened."""
        end = time.monotonic() + PATIENCE
        while not happened():
            assert time.monotonic() < end, "the window did not answer"
            self.rest(0.02)

    def look(
        self,
        azimuth: float,
        elevation: float,
        margin: float,
        shift: tuple[float, float] = (0.0, 0.0),
        among: tuple[str, ...] = (),
    ) -> None:
        """Frame all bodies, or those ``among`` them, from a direction in degrees.

        ``shift`` moves the picture by metres to the right and up.
        """
        viewport = self.bench.viewport
        points = np.concatenate([viewport.posed[key].points for key in among or viewport.posed])
        camera = OrbitCamera(azimuth=math.radians(azimuth), elevation=math.radians(elevation))
        camera = camera.framing(points, viewport.view_size, margin).panned(-shift[0], -shift[1])
        viewport.set_camera(camera)
        self.rest(0.2)

    def picture(self, part: QRect | None = None) -> QImage:
        """Picture of the window, or of a part of it, now, the 3D view made smooth."""
        self.bench.viewport.grab_image()
        return (self.window.grab(part) if part else self.window.grab()).toImage()

    def close(self) -> None:
        """End everything without a question."""
        self.window.close_without_saving()
        self.rest(0.05)
        self._folder.cleanup()


def example(capture: str) -> Path:
    """A capture that comes with the studio."""
    return example_captures_folder() / f"{capture}.bvh"


def kick_target(target: tuple[float, float, float] = KICK_TARGET) -> PositionConstraint:
    """The ball of the right foot on a target at the height of the kick."""
    point = BodyPoint(BodyPart.RIGHT_FOOT, at_end=True)
    chain = Chain(limb=1.0, clavicle=0.0, trunk=0.3, root=0.6)
    activation = ActivationCurve(2.25, 2.5, 2.65, 2.95)
    return PositionConstraint("front_kick", "Kick target", point, chain, 0, activation, target=target)


def left_wrist() -> PositionConstraint:
    """The left hand stays before the face."""
    point = BodyPoint(BodyPart.LEFT_FOREARM, at_end=True)
    activation = ActivationCurve(1.7, 2.1, 2.7, 3.1)
    return PositionConstraint("front_kick", "Guard up", point, Chain(trunk=0.3), 1, activation, target=(0.3, 0.1, 1.35))
