"""Names of things of one kind, of which a second one of a name is numbered, and of files."""

import re
from collections.abc import Collection


def free_name(name: str, taken: Collection[str]) -> str:
    """``name`` itself, or where that is taken with the next number: ``Right wrist 2``, ``Right wrist 3``."""
    if name not in taken:
        return name
    base = re.sub(r" \d+$", "", name)
    number = 2
    while f"{base} {number}" in taken:
        number += 1
    return f"{base} {number}"


def safe_name(name: str) -> str:
    """A name of a file that every system allows."""
    return re.sub(r'[\\/:*?"<>|]', "_", name)


def readable(text: str) -> str:
    """``text`` with the sign for an unknown character in place of bytes of file names that are no UTF-8."""
    return text.encode(errors="surrogateescape").decode(errors="replace")


def counted(number: int, thing: str, things: str = "") -> str:
    """Number and noun, such as ``1 character``, ``3 characters``; ``things`` is the plural, by default with an s."""
    return f"{number} {thing if number == 1 else things or f'{thing}s'}"
