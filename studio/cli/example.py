"""Example for machines without a display: a bundled capture is adapted and drawn."""

from pathlib import Path

from studio.cli.main import main
from studio.core.errors import StudioError
from studio.resources_folder import example_captures_folder
from studio.startup.process import check_libraries

EXAMPLE_FILE = "front_kick.bvh"
EXAMPLE_FOLDER = Path("morpho-studio-example")


def run_example() -> int:
    """Adapt a bundled capture to every bundled character, draw it, and name the files."""
    print("There is no display, so no window opens. The bundled example is adapted instead.", flush=True)
    capture = example_captures_folder() / EXAMPLE_FILE
    if not capture.exists():
        raise StudioError("No example capture is bundled. Make them with `make examples`.")
    picture = EXAMPLE_FOLDER / f"{capture.stem}.png"
    code = main(["adapt", str(capture), "--out", str(EXAMPLE_FOLDER), "--overwrite"])
    try:
        check_libraries()
    except StudioError as error:
        print(f"\nNo image of it was rendered. {error}")
        return code
    return code or main(["render", str(capture), "--out", str(picture), "--overwrite"])
