"""SMPTE timecode: hours, minutes, seconds and frames; drop-frame at the rates of NTSC video."""

import re

DROP_RATES = (30, 60)
"""Nominal frame rates whose NTSC variant, 1000/1001 of them, drops frame numbers to stay in step with the clock."""
NTSC_FACTOR = 1000.0 / 1001.0
TIMECODE = re.compile(r"\d+(?:[:;.]\d+){0,3}")


def timecode(frame: int, frame_rate: float) -> str:
    """Timecode of a frame, 0 or later: ``01:02:03:04``, or drop-frame ``01:02:03;04`` at 29.97 and 59.94 Hz."""
    nominal, dropped = _counting(frame_rate)
    if dropped:  # the first numbers of every minute but the tenth are skipped
        minute = 60 * nominal - dropped
        tens, rest = divmod(frame, 10 * minute + dropped)
        frame += dropped * (9 * tens + max(0, rest - dropped) // minute)
    seconds, frames = divmod(frame, nominal)
    digits = max(2, len(str(nominal - 1)))
    clock = f"{seconds // 3600:02}:{seconds // 60 % 60:02}:{seconds % 60:02}"
    return f"{clock}{';' if dropped else ':'}{frames:0{digits}}"


def frame_of_timecode(text: str, frame_rate: float) -> int:
    """Frame at a timecode; parts omitted at the left are 0. Raises ValueError for any other text."""
    if not TIMECODE.fullmatch(text):
        raise ValueError(f"'{text}' is not a timecode. Write hours:minutes:seconds:frames.")
    nominal, dropped = _counting(frame_rate)
    frames, seconds, minutes, hours = [*map(int, reversed(re.split("[:;.]", text))), 0, 0, 0][:4]
    minutes += 60 * hours + seconds // 60
    return nominal * (60 * minutes + seconds % 60) + frames - dropped * (minutes - minutes // 10)


def _counting(frame_rate: float) -> tuple[int, int]:
    """Frame numbers per second, and dropped numbers per minute."""
    nominal = max(1, round(frame_rate))
    is_drop = nominal in DROP_RATES and abs(frame_rate - nominal * NTSC_FACTOR) < 0.005
    return nominal, nominal // 15 if is_drop else 0
