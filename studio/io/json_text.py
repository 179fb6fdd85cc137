"""Parsing of JSON from any source, which refuses values that no file of the studio contains."""

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from studio.core.errors import StudioError
from studio.io.atomic_write import write_text
from studio.io.referenced_files import LARGEST_REFERENCED_BYTES, read_bytes

Parse = Callable[[str], Any]
JsonObject = dict[str, Any]
"""JSON object, by key."""

MOST_JSON_DEPTH = 100
"""Maximum depth of nested records."""
MOST_INTEGER_DIGITS = 1000
"""Maximum number of digits of an integer."""
_ESCAPE, _STRING = re.compile(rb"\\.", re.DOTALL), re.compile(rb'"[^"]*"?')
"""Escapes and strings, left out before brackets are counted: brackets in names nest nothing."""
_OPENING, _CLOSING = np.zeros((2, 256), dtype=np.int32)
_OPENING[list(b"[{")] = _CLOSING[list(b"]}")] = 1


def read_json(path: Path, largest: int = LARGEST_REFERENCED_BYTES) -> Any:
    """JSON value in an ordinary file of at most ``largest`` bytes. Raises StudioError, which names the file."""
    content = read_bytes(path, largest)
    try:
        return json_of(content)
    except ValueError as error:
        raise StudioError(f"{path} is not readable as JSON: {error}. Correct it there.") from error


def json_of(content: bytes, parse_float: Parse | None = None, parse_constant: Parse | None = None) -> Any:
    """JSON value in ``content``; ``parse_float`` and ``parse_constant`` are passed to ``json.loads``.

    Raises ValueError, also for deep nesting, lone surrogates and integers of excessive size.
    """
    kinds = np.frombuffer(_STRING.sub(b"", _ESCAPE.sub(b"", content)), dtype=np.uint8)
    if np.cumsum(_OPENING[kinds] - _CLOSING[kinds]).max(initial=0) > MOST_JSON_DEPTH:
        raise ValueError("its records are nested too deeply")
    try:
        record = json.loads(content, parse_float=parse_float, parse_constant=parse_constant, parse_int=_whole)
    except RecursionError as error:
        raise ValueError("its records are nested too deeply") from error
    if b"\\u" in content:  # half a character could be read, but never be written again
        json.dumps(record, ensure_ascii=False).encode()
    return record


def _whole(text: str) -> int:
    if len(text) > MOST_INTEGER_DIGITS:
        raise ValueError(f"'{text[:20]}…' is a number out of range")
    return int(text)


def write_json(path: Path, value: object) -> None:
    """Write ``value`` as JSON, whole or not at all. Raises StudioError if it cannot be written."""
    write_text(path, json.dumps(value, indent=1, ensure_ascii=False, allow_nan=False) + "\n")
