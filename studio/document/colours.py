"""Colours of the studio, shared by every view, as ``#RRGGBB``."""

from collections.abc import Mapping
from types import MappingProxyType

from studio.core.constraints.kinds import CONSTRAINT_KINDS as CONSTRAINTS

WINDOW = "#0f1114"
WELL = "#16191d"
PANEL = "#1d2126"
BAR = "#22272d"
CONTROL = "#2a3037"
EDGE = "#30373f"

TEXT = "#d7dce2"
TEXT_SECOND = "#a3adb8"
TEXT_THIRD = "#8e98a4"

SELECTED_ROW = "#2b3a4d"
SELECTED_CONTROL = "#3d6fa8"
SELECTED_HANDLE = "#cfe3ff"
PLAYHEAD = "#ff6b5e"
LIVE = "#ff6b5e"
BEFORE_PLAYHEAD, AFTER_PLAYHEAD, KEPT_GHOST = "#e8915b", "#58bfb0", "#dfe6ee"
"""Colours of onion skins before and after the playhead, and of added ghosts."""

VIEWPORT_TOP = "#2a3038"
VIEWPORT_BOTTOM = "#1d2126"
GRID = "#3a424b"

CHARACTER_COLOURS = ("#7FB4E6", "#E8A95B", "#8FCB8A", "#D98BB5", "#B9A6E8")

KIND_COLOURS = {
    **{kind: each.value.shown.colour for kind, each in CONSTRAINTS.items()},
    "contact": "#95ad74",
    "label": "#8fa8cf",
    "correction": "#d98bb5",
}

HELD = "#3f7f57"
PARTLY = "#E3A23C"
NOT_REACHED = "#E4574F"
LEFT, RIGHT = "#6aa5e3", "#e3a23c"
"""Colours of the left and right side of the body in figures."""


STAGE_BAR, STAGE_CONTROL, STAGE_SELECTED_CONTROL = BAR, CONTROL, SELECTED_CONTROL
STAGE_TEXT, STAGE_TEXT_SECOND, STAGE_TEXT_THIRD, STAGE_SELECTED_HANDLE = TEXT, TEXT_SECOND, TEXT_THIRD, SELECTED_HANDLE
STAGE_PLAYHEAD, STAGE_PARTLY, STAGE_NOT_REACHED = PLAYHEAD, PARTLY, NOT_REACHED
"""Colours in the 3D view, which is dark in every theme."""

LIGHT: Mapping[str, str] = MappingProxyType(
    {
        "WINDOW": "#b9c0c7",
        "WELL": "#ffffff",
        "PANEL": "#f3f5f7",
        "BAR": "#e3e7eb",
        "CONTROL": "#d5dbe1",
        "EDGE": "#bcc4cc",
        "TEXT": "#1b1f24",
        "TEXT_SECOND": "#434c56",
        "TEXT_THIRD": "#58626c",
        "SELECTED_ROW": "#c6daf1",
        "SELECTED_HANDLE": "#1f5fa8",
        "PLAYHEAD": "#d8382a",
        "LIVE": "#d8382a",
        "PARTLY": "#8f5a05",
        "NOT_REACHED": "#c5332b",
    }
)
DARK: Mapping[str, str] = MappingProxyType({name: globals()[name] for name in LIGHT})
THEMES: Mapping[str, Mapping[str, str]] = MappingProxyType({"dark": DARK, "light": LIGHT})


def use_theme(name: str) -> None:
    """Use the colours of a theme for panels and timeline; widgets that exist already keep theirs."""
    globals().update(THEMES[name])


def character_colour(number: int) -> str:
    """Colour of the ``number``-th character: one of five, then darker and lighter variants of them."""
    colour = CHARACTER_COLOURS[number % len(CHARACTER_COLOURS)]
    turn = number // len(CHARACTER_COLOURS)
    if turn == 0:
        return colour
    factor = 0.72 ** ((turn + 1) // 2)
    return mixed_colour(colour, "#000000" if turn % 2 else "#ffffff", 1.0 - factor)


def kind_colour(kind: str) -> str:
    """Colour of a constraint kind; the grey of secondary text for kinds without a colour."""
    return KIND_COLOURS.get(kind, TEXT_SECOND)


def mixed_colour(colour: str, other: str, share: float) -> str:
    """``colour`` blended towards ``other`` by the fraction ``share``, 0 to 1."""
    return "#" + "".join(
        f"{round((1.0 - share) * int(colour[k : k + 2], 16) + share * int(other[k : k + 2], 16)):02x}"
        for k in (1, 3, 5)
    )
