"""Where the studio's own files lie: inside the installed package, or at the top of a checkout."""

from pathlib import Path

from studio.core.errors import StudioError

PACKAGE = Path(__file__).resolve().parent


def resources_folder() -> Path:
    """Icons, theme, characters, body maps, shortcuts."""
    return _bundled("resources")


def example_captures_folder() -> Path:
    """The captures that the project's own scripts make."""
    return _bundled("examples/captures")


def bundled_strikes_folder() -> Path:
    """The captures of the bundled motion library: strikes by two actors."""
    return _bundled("examples/strikes")


def help_file() -> Path:
    """What is said of the command line."""
    return _bundled("docs") / "headless.md"


def sample_folder() -> Path:
    """What the window opens with, adapted when it was made."""
    return _bundled("examples/sample")


def _bundled(name: str) -> Path:
    """The wheel carries the folder inside the package; a checkout has it beside the package."""
    for folder in (PACKAGE / name, PACKAGE.parent / name):
        if folder.is_dir():
            return folder
    raise StudioError(f"The folder '{name}' is missing beside {PACKAGE}. Install Morpho Studio again.")
