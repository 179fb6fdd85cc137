"""Figures of bodies: posed by the solver, clothed in their own skins, with the places they were asked to reach."""

import os
from collections.abc import Sequence
from dataclasses import dataclass

os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")

import numpy as np
import pyvista as pv
from numpy.typing import NDArray
from PySide6.QtGui import QImage
from scipy.spatial.transform import Rotation

from pictured.session import example
from studio.core.body.canonical import BodyPart
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.grounds.ground import Ground
from studio.core.mesh.character import Character
from studio.core.mesh.skin import skin_vertices
from studio.core.solver.adapt import solve_constraints
from studio.core.solver.grounding.grounded_motion import ground_motion
from studio.core.solver.request import AdaptedMotion
from studio.io.importing import GUESS_ALL
from studio.io.project.character_file import bundled_characters
from studio.jobs.adaptation import ADAPTED_MOTION_ID, ready_capture

FloatArray = NDArray[np.float64]

WIDTH = 1200
WRIST, ELBOW = "#D0352B", "#2F6FB3"
ALWAYS = ActivationCurve(-1.0, -1.0, 1e6, 1e6)
REACHING = Chain(trunk=1.0)
ROOT = Chain(0.0, 0.0, 0.0, 0.0, 1.0)


@dataclass(frozen=True, eq=False)
class Shown:
    """One body in one frame, and coloured balls beside it; ``place`` (2,) where it stands in the picture."""

    character: Character
    adapted: AdaptedMotion
    frame: int
    balls: Sequence[tuple[FloatArray, str]] = ()


def priorities() -> QImage:
    """Wrist before elbow of the same arm: as captured, both reached, and the wrist alone (as in Kulpa's figure 13)."""
    ready = ready_capture(example("reach_grasp"), GUESS_ALL)
    woman = bundled_characters()["adult_woman"]
    standing = ground_motion(ready.motion, woman.morphology, ready.contacts, Ground())
    frame, layout = 0, woman.morphology.layout
    arm = [standing.positions[frame, layout.collar_point(1) + k] for k in (1, 2, 3)]
    wrist_place = arm[0] + np.array([0.44, -0.06, -0.10])
    wrist = _position(BodyPart.RIGHT_FOREARM, wrist_place, 0)
    balance = BalanceConstraint(ADAPTED_MOTION_ID, "balance", BodyPoint(BodyPart.PELVIS), ROOT, 0, ALWAYS)
    alone = solve_constraints(standing, (balance, wrist), frame, frame)
    shoulder, elbow, end = (alone.positions[0, layout.collar_point(1) + k] for k in (1, 2, 3))
    axis = (end - shoulder) / np.linalg.norm(end - shoulder)
    turned = shoulder + Rotation.from_rotvec(np.radians(50.0) * axis).apply(elbow - shoulder)
    both = []
    for place in (turned, turned + np.array([-0.05, -0.40, 0.02])):
        wishes = balance, wrist, _position(BodyPart.RIGHT_UPPER_ARM, place, 1)
        balls = [(wrist_place, WRIST), (place, ELBOW)]
        both.append(Shown(woman, solve_constraints(standing, wishes, frame, frame), 0, balls))
    return _drawn([Shown(woman, solve_constraints(standing, (), frame, frame), 0), *both], np.radians(-55.0), 1.3, 1.8)


def bodies() -> QImage:
    """One posture of one capture on the five bundled characters."""
    ready = ready_capture(example("front_kick"), GUESS_ALL)
    shown = []
    for character in bundled_characters().values():
        standing = ground_motion(ready.motion, character.morphology, ready.contacts, Ground())
        shown.append(Shown(character, solve_constraints(standing, (), 154, 154), 0))
    return _drawn(shown, np.radians(-40.0), 1.45, 2.35)


def _position(part: BodyPart, position: FloatArray, priority: int) -> PositionConstraint:
    target = (float(position[0]), float(position[1]), float(position[2]))
    return PositionConstraint(
        ADAPTED_MOTION_ID, part.label, BodyPoint(part, at_end=True), REACHING, priority, ALWAYS, target=target
    )


def _drawn(shown: Sequence[Shown], azimuth: float, apart: float, height: float) -> QImage:
    """Side by side without perspective, the first left; seen from ``azimuth`` radians left of where they look."""
    width = apart * len(shown) + 0.3
    plotter = pv.Plotter(off_screen=True, window_size=[WIDTH, round(WIDTH * height / width)])
    plotter.set_background("white")
    eye = np.array([np.cos(azimuth), np.sin(azimuth), 0.12])
    rightward = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    for number, each in enumerate(shown):
        beside = apart * (number - 0.5 * (len(shown) - 1)) * rightward
        beside = beside - [*each.adapted.positions[each.frame, 0, :2], 0.0]
        vertices, _ = skin_vertices(
            each.character.skin, each.character.build, each.adapted.morphology,
            each.adapted.positions[each.frame], each.adapted.rotations[each.frame],
        )  # fmt: skip
        triangles = each.character.skin.triangles
        faces = np.column_stack([np.full(len(triangles), 3), triangles]).ravel()
        skin = pv.PolyData(np.asarray(vertices, dtype=float) + beside, faces)
        plotter.add_mesh(skin, color=each.character.colour, smooth_shading=True, specular=0.1)
        for place, colour in each.balls:
            ball = pv.Sphere(radius=0.035, center=place + beside)
            plotter.add_mesh(ball, color=colour, smooth_shading=True)
    middle = np.array([0.0, 0.0, 0.5 * height - 0.08])
    plotter.camera_position = [tuple(middle + 10.0 * eye), tuple(middle), (0.0, 0.0, 1.0)]
    plotter.camera.parallel_projection = True
    plotter.camera.parallel_scale = 0.5 * height
    plotter.enable_anti_aliasing("ssaa")
    pixels = np.ascontiguousarray(plotter.screenshot(return_img=True))
    plotter.close()
    rows, columns, _ = pixels.shape
    return QImage(pixels.tobytes(), columns, rows, 3 * columns, QImage.Format.Format_RGB888).copy()
