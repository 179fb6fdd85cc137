"""How many pixels a picture has while something moves: fewer where drawing takes too long, as on a processor."""

SHARES = (1.0, 2 / 3, 1 / 2)
"""Of the width and the height."""
SLOW = 0.012
"""Seconds of drawing above which fewer pixels are drawn from then on."""
PATIENCE = 2
"""Slow pictures in a row before that."""


class Sharpness:
    """Hears how long each picture took that was drawn while something moved."""

    def __init__(self) -> None:
        self._step = self._slow = 0

    def size(self, full: tuple[int, int]) -> tuple[int, int]:
        """Pixels of the next picture that moves; at rest all are drawn."""
        share = SHARES[self._step]
        return max(round(full[0] * share), 1), max(round(full[1] * share), 1)

    def took(self, seconds: float) -> None:
        """One picture was drawn."""
        self._slow = self._slow + 1 if seconds > SLOW else 0
        if self._slow >= PATIENCE and self._step < len(SHARES) - 1:
            self._step, self._slow = self._step + 1, 0

    def rest(self) -> None:
        """Nothing moves: the next time a little more is tried."""
        self._step, self._slow = max(self._step - 1, 0), 0
