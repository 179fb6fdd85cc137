"""Parsers for numbers of the command line: each number is finite and within a range."""

from argparse import ArgumentTypeError
from collections.abc import Callable
from math import isfinite


def number_parser(least: float, most: float, meaning: str) -> Callable[[str], float]:
    """Parser of a number from ``least`` to ``most``; ``meaning`` names it in the ArgumentTypeError that the parser
    raises.
    """

    def parsed(text: str) -> float:
        return _within(text, _value(text, float), least, most, meaning)

    return parsed


def whole_parser(least: int, most: int, meaning: str) -> Callable[[str], int]:
    """Parser of an integer from ``least`` to ``most``; ``meaning`` names it in the ArgumentTypeError that the parser
    raises.
    """

    def parsed(text: str) -> int:
        return int(_within(text, _value(text, int), least, most, meaning))

    return parsed


def size_parser(least: int, most: int) -> Callable[[str], tuple[int, int]]:
    """Parser of width and height in pixels, written ``1280x720``; it raises ArgumentTypeError."""

    def parsed(text: str) -> tuple[int, int]:
        sides = [_value(side, int) for side in text.split("x")]
        if len(sides) != 2 or not all(isfinite(side) and least <= side <= most for side in sides):
            raise ArgumentTypeError(f"'{text}' is not a size: width x height in pixels, {least} to {most}, as 1280x720")
        return int(sides[0]), int(sides[1])

    return parsed


def key_press(text: str) -> tuple[float, str]:
    """Seconds and key of ``KEY@SECONDS``. Raises ArgumentTypeError."""
    key, _, when = text.rpartition("@")
    seconds = _value(when, float)
    if not key or not 0.0 <= seconds <= LONGEST_SECONDS:
        raise ArgumentTypeError(f"'{text}' is not a key press: write KEY@SECONDS, as in K@1.5")
    return seconds, key.upper()


LONGEST_SECONDS = 86_400.0
"""Maximum length of a motion or a session in seconds."""


def _value(text: str, kind: Callable[[str], float]) -> float:
    try:
        return kind(text)
    except ValueError:
        return float("nan")


def _within(text: str, value: float, least: float, most: float, meaning: str) -> float:
    if not least <= value <= most:
        raise ArgumentTypeError(f"'{text[:40]}' is not {meaning} from {least:,.12g} to {most:,.12g}")
    return value
