"""Correction of the strike labels of library clips: a clip is opened, its label edited on a small timeline, and
stored.
"""

from typing import TYPE_CHECKING

from studio.library.clip_labels import ClipLabel
from studio.panels.clip_form import ClipForm

if TYPE_CHECKING:
    from studio.app.strike_search import StrikeSearchController
    from studio.library.label_motion import OpenedClip
    from studio.library.library import Library, LibraryClip


class LabelController:
    """Controller of the form of a library clip: loads the clip and stores its label."""

    def __init__(self, striking: "StrikeSearchController") -> None:
        self._striking = striking
        self.form = ClipForm()
        self._number = -1
        self.form.closed.connect(lambda: striking.pages.setCurrentIndex(0))
        self.form.confirmed.connect(self.keep)

    def open(self, clip: "LibraryClip") -> None:
        """Show a library clip in the form; its take is loaded in the background."""

        def work(_: object) -> "OpenedClip":
            from studio.library.label_motion import OpenedClip

            return OpenedClip.of(clip)

        def done(opened: "OpenedClip") -> None:
            self._number = clip.number
            self.form.open(opened)
            self._striking.pages.setCurrentWidget(self.form)

        self._striking.bench.runner.run(f"Opening {clip.name}", work, done)

    def keep(self, label: ClipLabel) -> None:
        """Store a label in the catalogue, and repeat the search with it."""
        number, folder = self._number, self._striking.folder

        def work(_: object) -> "Library":
            from studio.library.catalogue import Catalogue
            from studio.library.indexing import correct_label
            from studio.library.library import Library

            with Catalogue(folder) as catalogue:
                correct_label(catalogue, number, label)
                return Library.of(catalogue)

        def done(library: "Library") -> None:
            self._striking.search_in(library)
            if self._number == number:
                self.form.tell_confirmed()

        self._striking.bench.runner.run("Saving the classification", work, done)
