"""Names that are unique among things of one kind, and names of files."""

import re
from collections.abc import Collection


def free_name(name: str, taken: Collection[str]) -> str:
    """``name`` itself or, if it is taken, with the next free number: ``Right wrist 2``, ``Right wrist 3``."""
    if name not in taken:
        return name
    base = re.sub(r" \d+$", "", name)
    number = 2
    while f"{base} {number}" in taken:
        number += 1
    return f"{base} {number}"


def safe_name(name: str) -> str:
    """File name that is valid on every system."""
    return re.sub(r'[\\/:*?"<>|]', "_", name)


def readable_name(text: str) -> str:
    """``text`` with the replacement character in place of bytes of file names that are not UTF-8."""
    return text.encode(errors="surrogateescape").decode(errors="replace")


def tags_in(text: str) -> tuple[str, ...]:
    """Tags in a text, separated by commas, without repetitions."""
    return tuple(dict.fromkeys(word.strip() for word in text.split(",") if word.strip()))


def counted_noun(number: int, thing: str, things: str = "") -> str:
    """Number and noun, such as ``1 character``, ``3 characters``; ``things`` is the plural, by default with an s."""
    return f"{number} {thing if number == 1 else things or f'{thing}s'}"
