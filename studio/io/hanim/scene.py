"""Nodes of a VRML or X3D scene, in either encoding."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError

FloatArray = NDArray[np.float64]

DEEPEST_NODE = 120
"""Maximum depth of nested nodes; a body of H-Anim's finest level has about 60."""
MOST_VISITS = 300_000
"""Maximum number of visited nodes; nodes that USE repeats are counted again."""
MOST_HANIM_NODES = 200_000
"""Maximum number of nodes written in one file."""
LARGEST_TEXT_BYTES = 60_000_000
"""Maximum size of a text file in bytes."""

_ALLOWED = str.maketrans("", "", "0123456789+-.eE \t\r\n\f\v,")
QUOTED_STRING_PATTERN = r'"(?s:.*?)(?<!\\)(?:\\\\)*"'
"""Pattern of a text in quotes: it ends at the first quote behind an even number of backslashes.

Possessive groups would say it more directly, but Python 3.11 reads them wrongly before 3.11.5.
"""
_ABSURD = 1e12


@dataclass(eq=False)
class SceneNode:
    """Node with its fields: nodes, arrays of numbers, lists of texts, words, or the text of an XML attribute."""

    kind: str
    where: str
    """File and line of the node, for messages: ``joe.x3d, line 12``."""
    definition: str = ""
    fields: dict[str, Any] = field(default_factory=dict)

    def nodes(self, *names: str) -> list["SceneNode"]:
        """Nodes in the fields with these names."""
        found: list[SceneNode] = []
        for name in names:
            value = self.fields.get(name)
            if isinstance(value, list):
                found += [item for item in value if isinstance(item, SceneNode)]
        return found

    def node(self, name: str) -> "SceneNode | None":
        """Node in the field ``name``; None if it has none."""
        found = self.nodes(name)
        return found[0] if found else None

    def numbers(self, name: str, width: int = 1) -> FloatArray:
        """Finite numbers (n, width) of a field; empty if the field is missing."""
        value = self.fields.get(name)
        if isinstance(value, str):
            value = row_of(value, f"{self.where}, {name}")
        if not isinstance(value, np.ndarray):
            return np.empty((0, width))
        if value.size % width:
            raise StudioError(
                f"{self.where}: '{name}' has {value.size} numbers, which is not a multiple of {width}. Export it again."
            )
        return value.reshape(-1, width)

    def vector(self, name: str, default: tuple[float, ...]) -> FloatArray:
        """Vector of a field; ``default`` if the field is missing."""
        value = self.numbers(name, len(default))
        return value[0] if len(value) else np.array(default)

    def text(self, name: str) -> str:
        """Text of a field; empty if it is missing."""
        value = self.fields.get(name, "")
        if isinstance(value, list):
            value = value[0] if value and isinstance(value[0], str) else ""
        return value if isinstance(value, str) else ""

    def texts(self, name: str) -> list[str]:
        """All texts of a field."""
        value = self.fields.get(name, [])
        if isinstance(value, str):
            return [unquoted(text) for text in re.findall(QUOTED_STRING_PATTERN, value)] or [value]
        return [item for item in value if isinstance(item, str)] if isinstance(value, list) else []

    def flag(self, name: str, default: bool) -> bool:
        """Boolean of a field; ``default`` if the field is missing."""
        value = self.fields.get(name)
        return value.strip().upper() == "TRUE" if isinstance(value, str) else default


def walk(roots: list[SceneNode]) -> Iterator[SceneNode]:
    """Every node below ``roots``, each once."""
    seen: set[int] = set()
    waiting = list(reversed(roots))
    while waiting:
        node = waiting.pop()
        if id(node) not in seen:
            seen.add(id(node))
            yield node
            waiting += [inner for name in reversed(node.fields) for inner in reversed(node.nodes(name))]


def unquoted(text: str) -> str:
    """Text without its quotes and escapes."""
    return re.sub(r"(?s)\\(.)", r"\1", text[1:-1])


def too_many(what: str, most: int, where: str) -> StudioError:
    """Error for a file that would need too much memory."""
    return StudioError(f"{where}: there are more than {most:,} {what}. Simplify the file.")


def row_of(text: str, where: str) -> FloatArray:
    """All numbers of a text. Raises StudioError at a word that is not a plain, plausible number."""
    if wrong := text.translate(_ALLOWED):
        raise StudioError(f"{where}: '{wrong[:20]}' is among its numbers. Export the file again.")
    try:
        row = np.array(text.replace(",", " ").split(), dtype=np.float64)
    except ValueError as error:
        raise StudioError(f"{where}: a number is not readable ({error}). Export the file again.") from error
    if row.size and not (np.abs(row) <= _ABSURD).all():
        raise StudioError(f"{where}: it contains a number that is out of range. Export the file again.")
    return row
