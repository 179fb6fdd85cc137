"""Names of things of one kind: a second one of a name is numbered."""

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
