"""Scenes of the papers, drawn as ``render`` draws them."""

import os

os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")

import numpy as np
from PySide6.QtGui import QImage

from studio.jobs.performances import adapted_performers
from studio.library.scenes import SCENES
from studio.viewport.offscreen import render_frame

SIZE, SMALL = (1040, 520), (560, 280)
FISTS_MEET_HEADS, UPSIDE_DOWN = 3.0, 3.4
"""Seconds."""


def fight() -> QImage:
    """Eight fighters in pairs as fists meet heads (as in Kulpa's figure 14)."""
    return _scene("Fight training", FISTS_MEET_HEADS)


def handstand() -> QImage:
    """Five bodies on their hands."""
    return _scene("Handstand and cartwheel", UPSIDE_DOWN, SMALL)


def _scene(title: str, seconds: float, size: tuple[int, int] = SIZE) -> QImage:
    project = next(scene for scene in SCENES if scene.title == title).make()
    pixels = np.ascontiguousarray(render_frame(project, adapted_performers(project), seconds, size))
    return QImage(pixels.data, *size, QImage.Format.Format_RGBA8888).copy()
