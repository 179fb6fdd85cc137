"""Choice of the motion library that a verb works with."""

import sys
from argparse import Namespace

from studio.core.errors import StudioError
from studio.library.catalogue import Catalogue
from studio.library.indexing import index_folders, load_library
from studio.library.library import Library
from studio.resources_folder import bundled_strikes_folder
from studio.startup.progress import progress_line


def library_with_clips(arguments: Namespace) -> Library:
    """Library of ``--library``, with the bundled strikes if ``--bundled`` is given. Raises StudioError if
    it is empty.
    """
    with Catalogue(arguments.library) as catalogue:
        if arguments.bundled:
            index_folders(catalogue, [bundled_strikes_folder()], progress_line())
        library = load_library(catalogue, progress_line())
        if catalogue.remarks:
            print(catalogue.remarks, file=sys.stderr)
    if not library.clips:
        raise StudioError(
            f"The library in '{arguments.library}' is empty. Add captures with `index FOLDER`, or the bundled"
            " strikes with `--bundled`."
        )
    return library
