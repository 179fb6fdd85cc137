"""Output of the stage's sounds in step with its playhead, by miniaudio."""

import threading
import time
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError
from studio.core.stage.playback_run import PlaybackRun

if TYPE_CHECKING:
    import miniaudio

FloatArray = NDArray[np.float64]

HEARD_RATE = 48_000
"""Sample rate of the output in Hz."""
HEARD_CHANNELS = 2
PERIOD_MILLISECONDS, DEVICE_PERIODS = 40, 3
"""Length and number of the pieces that the device requests: enough for a busy window, and few enough for a
quick seek.
"""
SETTLING_PIECES = 12
"""Number of pieces after which the lead of requests over the clock is known."""
LEAD_CORRECTION_SECONDS, MOST_STRETCH = 5.0, 0.005
"""Seconds in which a deviation of the lead is corrected, and the greatest relative change of speed for this."""
LOST_SECONDS = 0.1
"""Deviation of the lead in seconds above which the sound jumps: the device has had nothing to play."""
SILENT_SECONDS = 0.5
"""Seconds of silence after which the device is released."""


@dataclass(frozen=True, eq=False)
class HeardSound:
    """Sound to play: samples (N, 2) of 16 bits at ``HEARD_RATE`` that begin at stage second ``start``."""

    samples: NDArray[np.int16]
    start: float


def mix(sounds: Sequence[HeardSound], seconds: FloatArray) -> NDArray[np.float32]:
    """Mixed samples (N, 2) from -1 to 1 at stage ``seconds`` (N,); silence where these are NaN."""
    mixed = np.zeros((len(seconds), HEARD_CHANNELS), dtype=np.float32)
    for sound in sounds:
        places = (seconds - sound.start) * HEARD_RATE
        inside = (places >= 0.0) & (places < len(sound.samples) - 1)
        before = places[inside].astype(np.int64)
        part = (places[inside] - before)[:, None]
        mixed[inside] += ((1.0 - part) * sound.samples[before] + part * sound.samples[before + 1]) / 32768.0
    return np.clip(mixed, -1.0, 1.0)


class StreamClock:
    """Clock times at which the samples of a stream are heard, estimated from the times of its device's requests.

    A device requests pieces at uneven times, and its sample rate is not exactly that of the clock. So the lead of the
    requests over the clock is measured once, and kept constant by playing slightly faster or slower.
    """

    def __init__(self) -> None:
        self._heard: float | None = None
        self._leads: list[float] = []

    def advance(self, now: float, count: int) -> FloatArray:
        """Clock seconds (count,) at which the next samples are heard, which the device requests at ``now``."""
        if self._heard is None:
            self._heard = now
        error = 0.0
        if len(self._leads) < SETTLING_PIECES:
            self._leads.append(self._heard - now)
        else:
            error = now + float(np.median(self._leads)) - self._heard
        if abs(error) > LOST_SECONDS:
            self._heard, error = self._heard + error, 0.0
        stretch = 1.0 + min(max(error / LEAD_CORRECTION_SECONDS, -MOST_STRETCH), MOST_STRETCH)
        seconds = self._heard + np.arange(count) * (stretch / HEARD_RATE)
        self._heard += count * stretch / HEARD_RATE
        return np.asarray(seconds)


class SoundOutput:
    """Sound device of the system, opened by a thread of its own while there is anything to play.

    ``report`` is called on that thread with a sentence if nothing can be played. ``backends`` names the allowed
    backends of miniaudio; by default all of the system, except the one that discards its input.
    """

    def __init__(
        self,
        report: Callable[[str], object],
        clock: Callable[[], float] = time.monotonic,
        backends: Sequence[str] = (),
    ) -> None:
        self._report, self._clock, self._backends = report, clock, backends
        self._run: PlaybackRun | None = None
        self._sounds: tuple[HeardSound, ...] = ()
        self._last_wanted = 0.0
        self._wanted, self._closed = threading.Event(), False
        self._thread: threading.Thread | None = None

    def play(self, run: PlaybackRun, sounds: Sequence[HeardSound]) -> None:
        """Play sounds along the run of the playhead; may be called at every move of the playhead."""
        self._run, self._sounds, self._last_wanted = run, tuple(sounds), self._clock()
        if self._thread is None:
            self._thread = threading.Thread(target=self._serve, name="sound", daemon=True)
            self._thread.start()
        self._wanted.set()

    def pause(self) -> None:
        """Stop playing at once; the device is released a little later."""
        self._run = None

    def close(self) -> None:
        """Release the device."""
        self._run, self._closed = None, True
        self._wanted.set()
        if self._thread is not None:
            self._thread.join(SILENT_SECONDS)

    def _serve(self) -> None:
        while self._wanted.wait() and not self._closed:
            try:
                with self._open() as device:
                    samples = self._samples()
                    next(samples)
                    device.start(samples)
                    while self._is_wanted() and not self._closed:
                        time.sleep(SILENT_SECONDS / 10.0)
            except StudioError as error:
                self._report(str(error))
            self._wanted.clear()

    def _is_wanted(self) -> bool:
        return self._clock() - self._last_wanted < SILENT_SECONDS

    def _open(self) -> "miniaudio.PlaybackDevice":
        try:
            import miniaudio
        except ImportError as error:
            raise StudioError(
                "Sounds are shown but not heard: the package miniaudio is not installed. Install it by"
                " pip install miniaudio."
            ) from error
        chosen = [miniaudio.Backend[name] for name in self._backends]
        try:
            return miniaudio.PlaybackDevice(
                miniaudio.SampleFormat.FLOAT32,
                HEARD_CHANNELS,
                HEARD_RATE,
                PERIOD_MILLISECONDS,
                callback_periods=DEVICE_PERIODS,
                backends=chosen or [each for each in miniaudio.Backend if each is not miniaudio.Backend.NULL],
                app_name="Morpho Studio",
            )
        except miniaudio.MiniaudioError as error:
            raise StudioError(
                "Sounds are shown but not heard: no sound device was found. Connect one and press play again."
            ) from error

    def _samples(self) -> Generator[Any, int, None]:
        """Generator that yields as many samples as the device sends it as a request, endlessly."""
        stream = StreamClock()
        count = yield b""
        while True:
            seconds = stream.advance(self._clock(), count)
            run = self._run
            heard = np.full(count, np.nan) if run is None else run.stage_seconds(seconds)
            count = yield mix(self._sounds, heard)
