"""The colours of the studio, shared by every view: one meaning each, ``#RRGGBB``."""

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

VIEWPORT_TOP = "#2a3038"
VIEWPORT_BOTTOM = "#1d2126"
GRID = "#3a424b"

CHARACTERS = ("#7FB4E6", "#E8A95B", "#8FCB8A", "#D98BB5", "#B9A6E8")

KINDS = {
    **{kind: each.shown.colour for kind, each in CONSTRAINTS.items()},
    "contact": "#95ad74",
    "label": "#8fa8cf",
    "correction": "#d98bb5",
}

HELD = "#3f7f57"
PARTLY = "#E3A23C"
NOT_REACHED = "#E4574F"
LEFT, RIGHT = "#6aa5e3", "#e3a23c"
"""The sides of a body, where a figure tells them apart."""


def character_colour(number: int) -> str:
    """The colour of the ``number``-th character: the five, then darker and lighter turns of them."""
    colour = CHARACTERS[number % len(CHARACTERS)]
    turn = number // len(CHARACTERS)
    if turn == 0:
        return colour
    factor = 0.72 ** ((turn + 1) // 2)
    return mixed(colour, "#000000" if turn % 2 else "#ffffff", 1.0 - factor)


def kind_colour(kind: str) -> str:
    """The colour of a constraint kind; one that brings none of its own takes the second text's grey."""
    return KINDS.get(kind, TEXT_SECOND)


def mixed(colour: str, other: str, share: float) -> str:
    """``colour`` moved towards ``other`` by ``share`` from 0 to 1."""
    return "#" + "".join(
        f"{round((1.0 - share) * int(colour[k : k + 2], 16) + share * int(other[k : k + 2], 16)):02x}"
        for k in (1, 3, 5)
    )
