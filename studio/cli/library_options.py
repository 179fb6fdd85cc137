"""What verbs of the motion library share: where it is."""

from argparse import ArgumentParser
from pathlib import Path

import platformdirs


def add_library_option(parser: ArgumentParser) -> None:
    """``--library DIR``."""
    parser.add_argument(
        "--library",
        type=Path,
        default=library_folder(),
        metavar="DIR",
        help="folder of the library's catalogue; by default the user's own",
    )


def library_folder() -> Path:
    """Where the user's own library has its catalogue."""
    return Path(platformdirs.user_data_path("morpho-studio", appauthor=False)) / "library"
