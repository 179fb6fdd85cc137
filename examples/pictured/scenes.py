"""Scenes of the papers, drawn as ``render`` draws them."""

import os

os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")

import numpy as np
from PySide6.QtGui import QImage

from studio.cli.render import adapted_performers
from studio.library.scenes import SCENES
from studio.viewport.offscreen import render_frame

SIZE = (1280, 640)
FISTS_MEET_HEADS = 3.0
"""Seconds."""


def fight() -> QImage:
    """Eight fighters in pairs as fists meet heads (as in Kulpa's figure 14)."""
    project = next(scene for scene in SCENES if scene.title == "Fight training").make()
    pixels = np.ascontiguousarray(render_frame(project, adapted_performers(project), FISTS_MEET_HEADS, SIZE))
    return QImage(pixels.data, *SIZE, QImage.Format.Format_RGBA8888).copy()
