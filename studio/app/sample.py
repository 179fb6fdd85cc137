"""What the studio opens with: one bundled motion on five characters, side by side and playing."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from studio.app import importing
from studio.app.workbench import Workbench
from studio.core.hand_shapes import FIST
from studio.core.project import Project
from studio.core.staging import side_by_side, staged
from studio.io.character_file import bundled_characters
from studio.io.importing import ImportOptions
from studio.resources_folder import example_captures_folder

FIRST_CHOICE = "front_kick"


def empty_project() -> Project:
    """The bundled characters, waiting for a capture."""
    characters = bundled_characters()
    return Project(characters=characters, performers=side_by_side(characters))


def sample_file() -> Path | None:
    """The capture to begin with; None where none is bundled."""
    files = sorted(example_captures_folder().glob("*.bvh"))
    return next((file for file in files if file.stem == FIRST_CHOICE), next(iter(files), None))


def sample_project(read: importing.ReadMotion) -> Project:
    """The bundled characters performing one motion."""
    contacts = read.annotations.of_motion("sample").contacts or ()
    fighters = {name: replace(character, grip=FIST) for name, character in bundled_characters().items()}
    return staged(read.capture, contacts, fighters, "sample")


def open_sample(bench: Workbench) -> None:
    """Read the bundled motion in the background, show it and play."""
    file = sample_file()
    if file is None:
        bench.document.new(empty_project())
        return

    revision = bench.document.revision

    def show(project: Project) -> None:
        if bench.document.revision != revision:
            return  # the user has opened or recovered something meanwhile
        bench.document.new(project)
        bench.sources["sample"] = file
        bench.document.playhead.play()

    def work(progress: Callable[[float, str], None]) -> Project:
        return sample_project(importing.read_motion(file, ImportOptions(), progress))

    bench.runner.run(f"Opening {file.stem}", work, show)
