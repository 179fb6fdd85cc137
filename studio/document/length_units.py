"""Display units of lengths, chosen in the preferences before the views are made."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

PER_METRE = {"m": 1.0, "cm": 100.0, "mm": 1000.0, "in": 1.0 / 0.0254}
LENGTH_CHOICES: Mapping[str, Mapping[str, str]] = {
    "usual": {},
    "cm": {"m": "cm"},
    "m": {"cm": "m"},
    "in": dict.fromkeys(("m", "cm", "mm"), "in"),
}
"""Replacements of usual units by the choice in the preferences; residuals stay in mm unless inches are chosen."""
_PER_SECOND = "/s"
_replaced: dict[str, str] = {}


@dataclass(frozen=True)
class ShownUnit:
    """Unit that replaces a usual one in the display; shown values are usual values times ``factor``."""

    symbol: str
    factor: float = 1.0
    added_decimals: int = 0
    """Decimals in addition to those of the usual unit, so that no precision is lost."""


def use_lengths(choice: str) -> None:
    """Use one of ``LENGTH_CHOICES`` in all views made from now on."""
    _replaced.clear()
    _replaced.update(LENGTH_CHOICES[choice])


def shown_unit(usual: str) -> ShownUnit:
    """Unit that replaces a usual one; the same unit unless it measures lengths or speeds."""
    length, per_second = usual.removesuffix(_PER_SECOND), _PER_SECOND if usual.endswith(_PER_SECOND) else ""
    if length not in _replaced:
        return ShownUnit(usual)
    shown = _replaced[length]
    factor = PER_METRE[shown] / PER_METRE[length]
    return ShownUnit(shown + per_second, factor, math.ceil(-math.log10(factor)))


def length_text(metres: float, usual: str, decimals: int, sign: str = "") -> str:
    """Length as text in the display unit, with ``decimals`` for the usual unit: ``1.66 m``, or ``+1.66 m`` with
    ``sign`` "+".
    """
    unit = shown_unit(usual)
    value = metres * PER_METRE[usual] * unit.factor
    return f"{value:{sign}.{max(decimals + unit.added_decimals, 0)}f} {unit.symbol}"
