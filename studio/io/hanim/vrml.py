"""VRML97 and classic X3D: text parsed to nodes. PROTO instances keep their name and fields, with defaults filled in."""

import re
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from studio.core.errors import StudioError
from studio.io.hanim.scene import (
    DEEPEST_NODE,
    LARGEST_TEXT_BYTES,
    MOST_HANIM_NODES,
    QUOTED_STRING_PATTERN,
    FloatArray,
    SceneNode,
    row_of,
    too_many,
    unquoted,
)
from studio.io.referenced_files import read_bytes

_NUMBER = r"[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?"
_LONGEST_ROW = 1000
"""Numbers in one token: the stack of a repeated group grows with every repetition."""
_TOKEN = re.compile(
    rf"""(?P<gap>[\s,]+|\#[^\n\r]*|0[xX][0-9a-fA-F]+)
    |(?P<string>{QUOTED_STRING_PATTERN})
    |(?P<numbers>(?:{_NUMBER}(?:[\s,]+|(?=[\]\}}\#])|\Z)){{1,{_LONGEST_ROW}}})
    |(?P<mark>[\[\]\{{\}}])
    |(?P<word>[^\s,"\#\[\]\{{\}}]+)
    |(?P<wrong>.)""",
    re.VERBOSE | re.DOTALL,
)
_INTERFACE = frozenset({
    "field", "exposedField", "eventIn", "eventOut", "inputOutput", "initializeOnly", "inputOnly", "outputOnly",
})  # fmt: skip
_LINES = frozenset({"PROFILE", "COMPONENT", "META", "UNIT", "IMPORT", "EXPORT"})
_MOST_WORDS = 1_000_000
"""Names, texts, signs and rows of numbers."""
_LITERALS = frozenset({"TRUE", "FALSE", "NULL"})


class _Token(NamedTuple):
    """Token of the text, with its position."""

    kind: str
    text: str
    start: int


def read_vrml(path: Path) -> list[SceneNode]:
    """Top-level nodes of a .wrl or .x3dv file. Raises StudioError with file and line."""
    content = _unpacked(read_bytes(path, LARGEST_TEXT_BYTES), path.name)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("latin-1")
    if not text.lstrip().startswith(("#VRML V2.0", "#X3D V")):
        raise StudioError(f"{path.name} does not begin with '#VRML V2.0' or '#X3D V3'. Export it as VRML97 or X3D.")
    return _Parser(text, path.name).scene()


def _unpacked(content: bytes, name: str) -> bytes:
    """Text of a file, unpacked if it was packed with gzip, as VRML allows."""
    if content[:2] != b"\x1f\x8b":
        return content
    unpacker = zlib.decompressobj(wbits=31)
    damaged = StudioError(f"{name} is packed with gzip and damaged or cut off. Copy it again.")
    try:
        text = unpacker.decompress(content, LARGEST_TEXT_BYTES + 1)
    except zlib.error as error:
        raise damaged from error
    if len(text) > LARGEST_TEXT_BYTES:
        raise StudioError(f"{name} would unpack to more than {LARGEST_TEXT_BYTES / 1e6:.0f} MB. Simplify the file.")
    if not unpacker.eof:
        raise damaged
    return text


class _Parser:
    """Parser of one file."""

    def __init__(self, text: str, name: str) -> None:
        self._text, self._name = text, name
        self._tokens = _tokens(text)
        self._next: _Token | None = next(self._tokens, None)
        self._definitions: dict[str, SceneNode] = {}
        self._protos: dict[str, dict[str, Any]] = {}
        self._depth, self._nodes, self._taken = 0, 0, 0
        self._counted, self._lines = 0, 1

    def scene(self) -> list[SceneNode]:
        """All statements to the end of the text."""
        nodes: list[SceneNode] = []
        while self._next is not None:
            if self._next.text in _LINES and self._next.kind == "word":
                self._skip_line()
            else:
                nodes += self._statement()
        return nodes

    def _skip_line(self) -> None:
        """Skip a statement on one line, such as ``PROFILE Immersive`` or ``META "a" "b"``."""
        end = self._text.find("\n", self._next.start if self._next else 0)
        while self._next is not None and (end < 0 or self._next.start < end):
            self._take()

    def _statement(self) -> list[SceneNode]:
        word = self._peek("word")
        match word.text:
            case "PROTO":
                self._proto()
                return []
            case "EXTERNPROTO":
                self._extern_proto()
                return []
            case "ROUTE":
                for _ in range(4):
                    self._take()
                return []
        node = self._node()
        return [node] if node is not None else []

    def _node(self) -> SceneNode | None:
        """Parse ``DEF name Kind { ... }``, ``USE name``, ``Kind { ... }`` or ``NULL``, and return the node, None for
        ``NULL``.
        """
        word = self._word()
        if word.text == "NULL":
            return None
        if word.text == "USE":
            name = self._word()
            return self._definitions.get(name.text)  # what was never defined, a hidden file may have defined
        definition = ""
        if word.text == "DEF":
            definition = self._word().text
            word = self._word()
        self._depth += 1
        if self._depth > DEEPEST_NODE:
            raise StudioError(
                f"{self._where(word)}: its nodes are nested more than {DEEPEST_NODE} deep. Simplify the file."
            )
        self._nodes += 1
        if self._nodes > MOST_HANIM_NODES:
            raise too_many("nodes", MOST_HANIM_NODES, self._where(word))
        node = SceneNode(word.text, self._where(word), definition, dict(self._protos.get(word.text, {})))
        self._mark("{")
        while not self._at("}"):
            self._field(node)
        self._mark("}")
        self._depth -= 1
        if definition:
            self._definitions[definition] = node  # only now, so that no node can hold itself
        return node

    def _field(self, node: SceneNode) -> None:
        word = self._peek("word")
        if word.text in ("PROTO", "EXTERNPROTO", "ROUTE"):
            self._statement()
        elif word.text in _INTERFACE:  # a Script's own fields
            self._interface_row()
        else:
            self._take()
            node.fields[word.text] = self._value()

    def _value(self) -> Any:
        token = self._next
        if token is None:
            raise self._ended()
        if token.kind == "mark":
            return self._list()
        if token.kind == "numbers":
            return self._row()
        if token.kind == "string":
            return [unquoted(self._take().text)]
        if token.text == "IS":
            self._take()
            self._word()
            return None
        if token.text in _LITERALS:
            return self._take().text
        node = self._node()
        return [node] if node is not None else []

    def _list(self) -> Any:
        self._mark("[")
        items: list[Any] = []
        rows: list[Any] = []
        while not self._at("]"):
            token = self._next
            if token is None:
                raise self._ended()
            match token.kind:
                case "numbers":
                    rows.append(self._row())
                case "string":
                    items.append(unquoted(self._take().text))
                case "word" if token.text in ("TRUE", "FALSE"):
                    items.append(self._take().text)
                case _:
                    items += self._statement()
        self._mark("]")
        return np.concatenate(rows) if rows and not items else items

    def _row(self) -> FloatArray:
        """Parse all numbers (n,) up to the next text, name or sign."""
        parts = []
        while self._next is not None and self._next.kind == "numbers":
            where = self._where(self._next)
            parts.append(row_of(self._take().text, where))
        return np.concatenate(parts)

    def _proto(self) -> None:
        """Parse the interface of a PROTO with its defaults; its body is skipped."""
        self._word()
        name = self._word().text
        self._mark("[")
        defaults: dict[str, Any] = {}
        while not self._at("]"):
            field, value = self._interface_row()
            if value is not None:
                defaults[field] = value
        self._mark("]")
        self._protos[name] = defaults
        opened = self._mark("{")
        depth = 1
        while depth:
            if self._next is None:
                raise StudioError(f"{self._where(opened)}: the PROTO {name} is not closed. The file is cut off.")
            token = self._take()
            depth += (token.text == "{") - (token.text == "}") if token.kind == "mark" else 0

    def _extern_proto(self) -> None:
        self._word()
        self._protos[self._word().text] = {}
        self._mark("[")
        while not self._at("]"):
            self._word(), self._word(), self._word()
        self._mark("]")
        self._value()

    def _interface_row(self) -> tuple[str, Any]:
        access, _, name = self._word(), self._word(), self._word()
        if access.text in ("eventIn", "eventOut", "inputOnly", "outputOnly"):
            return name.text, None
        return name.text, self._value()

    # Tokens

    def _take(self) -> _Token:
        token = self._next
        if token is None:
            raise self._ended()
        if token.kind == "wrong":
            raise self._wrong(token)
        self._taken += 1
        if self._taken > _MOST_WORDS:
            raise too_many("words", _MOST_WORDS, self._where(token))
        self._next = next(self._tokens, None)
        return token

    def _peek(self, kind: str) -> _Token:
        token = self._next
        if token is None:
            raise self._ended()
        if token.kind == "wrong":
            raise self._wrong(token)
        if token.kind != kind:
            raise StudioError(
                f"{self._where(token)}: a name was expected, not '{token.text[:20].strip()}'. Export the file again."
            )
        return token

    def _word(self) -> _Token:
        self._peek("word")
        return self._take()

    def _at(self, mark: str) -> bool:
        if self._next is None:
            raise self._ended()
        return self._next.kind == "mark" and self._next.text == mark

    def _mark(self, mark: str) -> _Token:
        if not self._at(mark):
            token = self._next
            shown = token.text[:20].strip() if token else ""
            raise StudioError(f"{self._where(token)}: '{mark}' was expected, not '{shown}'. Export the file again.")
        return self._take()

    def _where(self, token: _Token | None) -> str:
        if token is not None and token.start >= self._counted:
            self._lines += self._text.count("\n", self._counted, token.start)
            self._counted = token.start
        return f"{self._name}, line {self._lines}"

    def _wrong(self, token: _Token) -> StudioError:
        return StudioError(
            f"{self._where(token)}: a text is not closed, or a sign is out of place. Copy the file again."
        )

    def _ended(self) -> StudioError:
        return StudioError(f"{self._name} is cut off: a brace or bracket is still open at its end. Copy it again.")


def _tokens(text: str) -> Iterator[_Token]:
    for found in _TOKEN.finditer(text):
        if found.lastgroup != "gap":
            yield _Token(found.lastgroup or "wrong", found.group(), found.start())
