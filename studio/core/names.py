"""Names that are unique among things of one kind, and names of files."""

import re
from collections.abc import Collection


def free_name(name: str, taken: Collection[str]) -> str:
    """Name that is not in ``taken``: ``name`` or, if it is taken, with a number: ``Right wrist 2``, ``Right
    wrist 3``.
    """
    if name not in taken:
        return name
    base = re.sub(r" \d+$", "", name)
    number = 2
    while f"{base} {number}" in taken:
        number += 1
    return f"{base} {number}"


def safe_name(name: str) -> str:
    """Name made of ``name`` that is valid for a file on every system."""
    return re.sub(r'[\\/:*?"<>|]', "_", name)


def readable_name(text: str) -> str:
    """``text`` with the replacement character for bytes of file names that are not UTF-8."""
    return text.encode(errors="surrogateescape").decode(errors="replace")


def tags_in(text: str) -> tuple[str, ...]:
    """Tags in ``text``, where they are separated by commas, without duplicates."""
    return tuple(dict.fromkeys(word.strip() for word in text.split(",") if word.strip()))


def counted_noun(number: int, thing: str, things: str = "") -> str:
    """Number and noun, such as ``1 character`` or ``3 characters``; ``things`` is the plural, ``thing`` with an s by
    default.
    """
    return f"{number} {thing if number == 1 else things or f'{thing}s'}"
