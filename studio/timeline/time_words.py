"""Times as text, always with their unit."""


def time_text(frame: float, seconds: float) -> str:
    """``0.767 s · frame 23``; fractions of frames are shown."""
    return f"{seconds:.3f} s · frame {number_text(frame)}"


def number_text(frame: float) -> str:
    """``23``; ``23.50`` between frames."""
    return f"{round(frame)}" if abs(frame - round(frame)) < 0.005 else f"{frame:.2f}"


def rate_text(frame_rate: float) -> str:
    """``30 Hz``, ``59.94 Hz``."""
    return f"{frame_rate:.2f}".rstrip("0").rstrip(".") + " fps"
