"""Projects that verbs play or draw, given by path or by the name of a bundled scene."""

from pathlib import Path

from studio.core.errors import StudioError
from studio.core.stage.project import Project
from studio.io.project.project_file import read_project
from studio.library.scenes import SCENES

BUNDLED_SCENES = {scene.title.lower().replace(",", "").replace(" ", "-"): scene for scene in SCENES}
"""Bundled scenes by the name that the user types: ``fight-training``."""


def is_project(source: Path) -> bool:
    """True if ``source`` is the name of a project file or of a bundled scene."""
    return source.suffix.lower() == ".studio" or (str(source) in BUNDLED_SCENES and not source.exists())


def open_project(source: Path) -> Project:
    """Project in a file, or the bundled scene with that name. Raises StudioError if there is neither."""
    if source.exists() or source.suffix:
        return read_project(source).project
    if (scene := BUNDLED_SCENES.get(str(source))) is None:
        raise StudioError(f"There is no project '{source}'. Name a file, or a scene: {', '.join(BUNDLED_SCENES)}.")
    return scene.make()
