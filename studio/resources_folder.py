"""Paths of the studio's own files: inside the installed package, or at the top of a checkout."""

from pathlib import Path

from studio.core.errors import StudioError

PACKAGE = Path(__file__).resolve().parent


def resources_folder() -> Path:
    """Folder of icons, theme, characters, body maps and shortcuts."""
    return _bundled("resources")


def example_captures_folder() -> Path:
    """Folder of the captures that the project's own scripts make."""
    return _bundled("examples/captures")


def bundled_strikes_folder() -> Path:
    """Folder of the captures of the bundled motion library: strikes by two actors."""
    return _bundled("examples/strikes")


def help_file() -> Path:
    """Path of the help text about the command line."""
    return _bundled("docs") / "headless.md"


def guide_file() -> Path:
    """Path of the user's guide."""
    return _bundled("docs") / "guide.md"


def sample_folder() -> Path:
    """Folder of the sample that the window opens with, adapted when it was made."""
    return _bundled("examples/sample")


def _bundled(name: str) -> Path:
    """Bundled folder: inside the package in a wheel, beside it in a checkout. Raises StudioError if it is missing."""
    for folder in (PACKAGE / name, PACKAGE.parent / name):
        if folder.is_dir():
            return folder
    raise StudioError(f"The folder '{name}' is missing beside {PACKAGE}. Install Morpho Studio again.")
