"""Times as text with units."""


def time_text(frame: float, seconds: float) -> str:
    """Time and frame as text: ``0.767 s · frame 23``."""
    return f"{seconds:.3f} s · frame {number_text(frame)}"


def number_text(frame: float) -> str:
    """Frame number as text: ``23``, or ``23.50`` between frames."""
    return f"{round(frame)}" if abs(frame - round(frame)) < 0.005 else f"{frame:.2f}"


def rate_text(frame_rate: float) -> str:
    """Frame rate as text, with its unit."""
    return f"{frame_rate:.2f}".rstrip("0").rstrip(".") + " fps"
