"""Sample project of the first start: one bundled motion on five characters, side by side and playing.

Its adapted motions are stored with it (``examples/make_sample.py``), because the solver is still being compiled at a
first start.
"""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from studio.app.workbench import Workbench
from studio.core.mesh.hand_shapes import FIST_GRIP
from studio.core.solver.request import AdaptedMotion
from studio.core.stage.project import Project
from studio.core.stage.staging import performers_side_by_side, project_of_capture
from studio.io.adapted_file import read_adapted
from studio.io.project.character_file import bundled_characters
from studio.io.project.project_file import read_project
from studio.library.scenes import BundledScene
from studio.panels.message_strip import Lifetime
from studio.resources_folder import example_captures_folder, sample_folder

SAMPLE_NAME, SAMPLE_MOTION_ID = "front_kick", "sample"
SAMPLE_PROJECT, SAMPLE_MOTIONS = f"{SAMPLE_NAME}.studio", f"{SAMPLE_NAME}.npz"


def empty_project() -> Project:
    """Project with the bundled characters and no capture."""
    characters = bundled_characters()
    return Project(characters=characters, performers=performers_side_by_side(characters))


def capture_file() -> Path:
    """Path of the sample's capture."""
    return example_captures_folder() / f"{SAMPLE_NAME}.bvh"


def read_sample() -> tuple[Project, dict[str, AdaptedMotion]]:
    """Sample project, and its stored adapted motions by performer id."""
    folder = sample_folder()
    characters = {name: replace(each, grip=FIST_GRIP) for name, each in bundled_characters().items()}
    kept = read_project(folder / SAMPLE_PROJECT).project
    capture = kept.captures[SAMPLE_MOTION_ID]
    bodies = {key: character.morphology for key, character in characters.items()}
    project = project_of_capture(capture, tuple(kept.contacts.values()), characters, SAMPLE_MOTION_ID)
    return project, read_adapted(folder / SAMPLE_MOTIONS, bodies, capture.frame_rate)


def open_sample(bench: Workbench) -> None:
    """Read the sample in the background, show it and start playback."""
    revision = bench.document.revision

    def show(read: tuple[Project, dict[str, AdaptedMotion]]) -> None:
        if bench.document.revision != revision:
            return  # the user has opened or recovered something meanwhile
        project, motions = read
        bench.document.new(project)
        bench.live.show_until_solved(motions)
        bench.sources[SAMPLE_MOTION_ID] = capture_file()
        bench.document.playhead.play()

    def work(_progress: Callable[[float, str], None]) -> tuple[Project, dict[str, AdaptedMotion]]:
        return read_sample()

    bench.runner.run(f"Opening {SAMPLE_NAME}", work, show)


def open_scene(bench: Workbench, scene: BundledScene) -> None:
    """Create an example scene in the background, show it, start playback, and show its description."""
    revision = bench.document.revision

    def show(project: Project) -> None:
        if bench.document.revision != revision:
            return  # as above
        bench.document.new(project)
        bench.inform(scene.text, until=Lifetime.PROJECT_OPENED)
        bench.document.playhead.play()

    bench.runner.run(f"Opening {scene.title.lower()}", lambda _progress: scene.make(), show)
