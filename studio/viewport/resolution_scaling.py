"""Resolution of the picture during motion: lower if drawing is slow, as without a graphics card."""

SHARES = (1.0, 2 / 3, 1 / 2)
"""Parts of the width and the height."""
SLOW_DRAG_SECONDS, SLOW_PLAY_SECONDS = 0.006, 0.022
"""Seconds of drawing above which fewer pixels are drawn from then on: a hand waits for each picture, of whose 33 ms
drawing may take a fifth, and what plays needs 30 of them a second, of which drawing may take two thirds."""
SLOW_PICTURES = 6
"""Least surplus of slow over quick pictures before that, so that a hiccup of the machine changes nothing."""
RETRY = 60
"""Pictures so quick that more pixels should do as well, before that is tried; twice as many each time it failed."""


class ResolutionScaling:
    """Resolution from the drawing times of pictures during motion; above ``slow`` seconds is too long."""

    def __init__(self, slow: float) -> None:
        self._limit, self._retry = slow, RETRY
        self._step = self._slow = self._quick = 0

    def size(self, full: tuple[int, int]) -> tuple[int, int]:
        """Pixels of the next picture during motion; at rest the full size is drawn."""
        share = SHARES[self._step]
        return max(round(full[0] * share), 1), max(round(full[1] * share), 1)

    def note_duration(self, seconds: float) -> None:
        """Note the drawing time of a picture."""
        self._slow = max(self._slow + (1 if seconds > self._limit else -1), 0)
        finer = SHARES[max(self._step - 1, 0)] / SHARES[self._step]  # as its time is: half of it is not of the pixels
        self._quick = max(self._quick + (1 if seconds * finer < self._limit else -1), 0)
        if self._slow >= SLOW_PICTURES and self._step < len(SHARES) - 1:
            self._go(self._step + 1)
            self._retry *= 2
        elif self._quick >= self._retry and self._step > 0:
            self._go(self._step - 1)

    def note_rest(self) -> None:
        """Note that nothing moves: the next motion starts with a slightly higher resolution."""
        self._go(max(self._step - 1, 0))
        self._retry = RETRY

    def _go(self, step: int) -> None:
        self._step, self._slow, self._quick = step, 0, 0
