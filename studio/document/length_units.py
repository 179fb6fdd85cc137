"""Units in which every view shows lengths: chosen in the preferences, before the views are made."""

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
"""Unit that replaces the usual one of a field or a text, by choice; residuals stay in mm beside metric units."""
_PER_SECOND = "/s"
_replaced: dict[str, str] = {}


@dataclass(frozen=True)
class ShownUnit:
    """Unit that is shown in place of the usual one, and how values of the usual one become values of it."""

    symbol: str
    factor: float = 1.0
    added_decimals: int = 0
    """Decimals beyond those of the usual unit, so that no precision is lost."""


def use_lengths(choice: str) -> None:
    """Use one of ``LENGTH_CHOICES`` in all views that are made from now on."""
    _replaced.clear()
    _replaced.update(LENGTH_CHOICES[choice])


def shown_unit(usual: str) -> ShownUnit:
    """Unit that replaces a usual one; the same unit for all but lengths and speeds."""
    length, per_second = usual.removesuffix(_PER_SECOND), _PER_SECOND if usual.endswith(_PER_SECOND) else ""
    if length not in _replaced:
        return ShownUnit(usual)
    shown = _replaced[length]
    factor = PER_METRE[shown] / PER_METRE[length]
    return ShownUnit(shown + per_second, factor, math.ceil(-math.log10(factor)))


def length_text(metres: float, usual: str, decimals: int, sign: str = "") -> str:
    """Length as text, ``decimals`` of the usual unit: ``1.66 m``, with a ``sign`` of "+" ``+1.66 m``."""
    unit = shown_unit(usual)
    value = metres * PER_METRE[usual] * unit.factor
    return f"{value:{sign}.{max(decimals + unit.added_decimals, 0)}f} {unit.symbol}"
