"""Playback of the project's sounds while the playhead plays or is dragged."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QObject, Signal

from studio.app.relinking import known_folders, offer_media_relinking
from studio.app.workbench import Workbench
from studio.core.errors import StudioError
from studio.core.stage.playback_run import PlaybackRun
from studio.core.stage.sound_track import SoundTrack
from studio.io.media.media_files import MediaMissing, find_media
from studio.io.media.sound_file import read_samples
from studio.io.media.sound_output import HeardSound, SoundOutput

SCRUB_SECONDS = 0.1
"""Length in seconds of the sound that is heard at each position of a dragged playhead."""


class SoundPlayback(QObject):
    """Controller that plays sounds in sync with the playhead; a file is read in the background at its first use."""

    failed = Signal(str)

    def __init__(self, bench: Workbench, parent: QObject, output: SoundOutput | None = None) -> None:
        super().__init__(parent)
        self._bench, self._playhead = bench, bench.document.playhead
        self.output = output or SoundOutput(self.failed.emit)
        self.muted = False
        self._samples: dict[str, NDArray[np.int16] | None] = {}
        """Samples by the source of the sound; None while it is read, or where it cannot be."""
        self._told: set[str] = set()
        self.failed.connect(self._tell_once)
        self._playhead.changed.connect(self._follow_playhead)
        self._playhead.playing_changed.connect(self._follow_playing)
        bench.document.project_opened.connect(self._samples.clear)
        bench.media_relinked.connect(lambda path: self._samples.pop(path, None))

    def set_muted(self, muted: bool) -> None:
        """Mute or unmute."""
        self.muted = muted
        self._follow_playing(self._playhead.playing)

    def close(self) -> None:
        """Release the audio device."""
        self.output.close()

    def _follow_playing(self, playing: bool) -> None:
        if playing:
            self._play(self._playhead.run)
        else:
            self.output.pause()

    def _follow_playhead(self, seconds: float) -> None:
        """Continue playback, or play a short sample if the playhead was dragged."""
        run = self._playhead.run
        if not self._playhead.playing:
            end = seconds + SCRUB_SECONDS
            run = replace(run, start=seconds, speed=1.0, begin=seconds, end=end, loop=False)
        self._play(run)

    def _play(self, run: PlaybackRun) -> None:
        sounds = [] if self.muted else list(self._bench.document.project.sounds.values())
        for sound in sounds:
            if sound.source not in self._samples:
                self._read(sound)
        heard = [(self._samples.get(sound.source), sound.start) for sound in sounds]
        known = [HeardSound(samples, start) for samples, start in heard if samples is not None]
        if known:
            self.output.play(run, known)
        else:
            self.output.pause()

    def _read(self, sound: SoundTrack) -> None:
        self._samples[sound.source] = None
        folders, source = known_folders(self._bench), sound.source

        def read(progress: Callable[[float, str], None]) -> NDArray[np.int16]:
            path = find_media(source, sound.name, folders)
            return read_samples(path, lambda: progress(0.0, path.name))

        def done(samples: NDArray[np.int16]) -> None:
            self._samples[source] = samples

        def missed(error: StudioError) -> None:
            if isinstance(error, MediaMissing):
                offer_media_relinking(self._bench, "sounds", source, error)

        self._bench.runner.run(f"Reading {sound.name}", read, done, missed)

    def _tell_once(self, sentence: str) -> None:
        if sentence not in self._told:
            self._told.add(sentence)
            self._bench.post_message(sentence)
