"""Dynamic resolution: fewer pixels during motion if rendering is slow, as without a graphics card."""

RESOLUTION_FRACTIONS = (1.0, 2 / 3, 1 / 2)
"""Available fractions of width and height."""
SLOW_DRAG_SECONDS, SLOW_PLAY_SECONDS = 0.006, 0.022
"""Rendering times in seconds above which the resolution is reduced, during a drag and during playback.

A drag waits for each image, whose 33 ms may be used for rendering by a fifth; playback needs 30 images per second,
whose time may be used by two thirds.
"""
SLOW_PICTURES = 6
"""Excess of slow over fast images that reduces the resolution, so that a single hiccup does not."""
FAST_FRAMES_BEFORE_RETRY = 60
"""Number of fast images after which a higher resolution is tried; it doubles each time that fails."""


class ResolutionScaling:
    """Resolution derived from the rendering times of images during motion; above ``slow`` seconds an image is slow."""

    def __init__(self, slow: float) -> None:
        self._limit, self._retry = slow, FAST_FRAMES_BEFORE_RETRY
        self._step = self._slow = self._quick = 0

    def size(self, full: tuple[int, int]) -> tuple[int, int]:
        """Size in pixels of the next image during motion; at rest the ``full`` size is rendered."""
        share = RESOLUTION_FRACTIONS[self._step]
        return max(round(full[0] * share), 1), max(round(full[1] * share), 1)

    def note_duration(self, seconds: float) -> None:
        """Record the rendering time of an image."""
        self._slow = max(self._slow + (1 if seconds > self._limit else -1), 0)
        finer = (
            RESOLUTION_FRACTIONS[max(self._step - 1, 0)] / RESOLUTION_FRACTIONS[self._step]
        )  # as its time is: half of it is not of the pixels
        self._quick = max(self._quick + (1 if seconds * finer < self._limit else -1), 0)
        if self._slow >= SLOW_PICTURES and self._step < len(RESOLUTION_FRACTIONS) - 1:
            self._go(self._step + 1)
            self._retry *= 2
        elif self._quick >= self._retry and self._step > 0:
            self._go(self._step - 1)

    def note_rest(self) -> None:
        """Record that nothing moves: the next motion starts with a slightly higher resolution."""
        self._go(max(self._step - 1, 0))
        self._retry = FAST_FRAMES_BEFORE_RETRY

    def _go(self, step: int) -> None:
        self._step, self._slow, self._quick = step, 0, 0
