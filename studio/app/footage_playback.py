"""Reference footage in sync with the playhead: the current frame in the footage panel."""

from pathlib import Path

from PySide6.QtCore import QObject

from studio.app.relinking import known_folders, offer_media_relinking
from studio.app.workbench import Workbench
from studio.core.stage.footage import Footage
from studio.engine.footage_frames import FootageFrame, FootageFrames
from studio.io.media.media_files import MediaMissing, find_media
from studio.panels.footage_view import NO_FOOTAGE_HINT, FootageView


class FootagePlayback(QObject):
    """Controller that shows the footage frame at the playhead while the panel is visible. Missing files are searched
    once per session.
    """

    def __init__(self, bench: Workbench, parent: QObject) -> None:
        super().__init__(parent)
        self._bench, self.view, self.frames = bench, FootageView(), FootageFrames(self)
        self._found: dict[str, Path | None] = {}
        """Files by the source of the footage; None where it is nowhere or cannot be read."""
        self._shown: FootageFrame | None = None
        document = bench.document
        document.playhead.changed.connect(self._refresh)
        document.entity_changed.connect(self._follow_edit)
        document.selection.changed.connect(self._refresh)
        document.project_opened.connect(self._forget)
        bench.media_relinked.connect(self._try_again)
        self.view.opened.connect(self._refresh)
        self.frames.frame_ready.connect(self._refresh)
        self.frames.failed.connect(self._refuse)

    def close(self) -> None:
        """Stop reading."""
        self.frames.close()

    def _footage(self) -> Footage | None:
        """Selected footage, else the first one with a frame at the playhead, else the first one."""
        document = self._bench.document
        footage = document.project.footage
        selected = [footage[key] for key in document.selection.of("footage") if key in footage]
        seen = [each for each in footage.values() if each.frame_at(document.playhead.time) is not None]
        return next(iter((*selected, *seen, *footage.values())), None)

    def _refresh(self) -> None:
        if not self.view.isVisible():
            return
        footage = self._footage()
        if footage is None:
            self._show_nothing(NO_FOOTAGE_HINT)
            return
        path, index = self._path_of(footage), footage.frame_at(self._bench.document.playhead.time)
        if path is None:
            self._show_nothing(f"{Path(footage.source).name} cannot be shown: the file is missing or unreadable.")
        elif index is None:
            self._show_nothing(f"{footage.name} has no frame here. Move the playhead, or the footage on the timeline.")
        elif (frame := FootageFrame(path, footage.file_rate, footage.frames, index)) != self._shown:
            picture = self.frames.picture(frame)
            if picture is None:  # the one of a moment before stays until it is read
                if self.view.image.isNull():
                    self._show_nothing(f"Reading {footage.name}")
            else:
                self._shown = frame
                self.view.show_picture(picture, f"{footage.name}, frame {index + 1} of {footage.frames}")

    def _show_nothing(self, words: str) -> None:
        self._shown = None
        self.view.show_picture(None, words)

    def _path_of(self, footage: Footage) -> Path | None:
        source = footage.source
        if source not in self._found:
            try:
                self._found[source] = find_media(source, footage.name, known_folders(self._bench))
            except MediaMissing as error:
                self._found[source] = None
                offer_media_relinking(self._bench, "footage", source, error)
        return self._found[source]

    def _follow_edit(self, collection: str) -> None:
        if collection == "footage":
            self._refresh()

    def _forget(self) -> None:
        self._found.clear()
        self._refresh()

    def _try_again(self, path: str) -> None:
        self._found.pop(path, None)
        self.frames.try_again(Path(path))
        self._refresh()

    def _refuse(self, path: str, sentence: str) -> None:
        self._found = {key: None if str(each) == path else each for key, each in self._found.items()}
        """Paths by the source of the footage; None if the file is missing or unreadable."""
        self._bench.post_message(sentence)
        self._refresh()
