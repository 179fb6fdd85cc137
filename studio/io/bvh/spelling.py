"""Dialects of BVH files: comments, the end-of-file mark of DOS, commas, semicolons."""

import re

_COMMENT = re.compile(rb"^[ \t]*(?:#(?!N/A)|//)[^\r\n]*", re.MULTILINE)
_OFFSETS = re.compile(rb"^[ \t]*OFFSET[^\n]*", re.MULTILINE | re.IGNORECASE)
_MOTION = re.compile(rb"^[ \t]*MOTION[ \t]*$.*\Z", re.MULTILINE | re.DOTALL | re.IGNORECASE)
_HEADER = re.compile(rb"^[ \t]*(?:MOTION|FRAMES?\b)[^\n]*", re.MULTILINE | re.IGNORECASE)
_COMMA_AND_BLANK = re.compile(rb",(?=\s)|(?<=\s),")
_DECIMAL_COMMA = re.compile(rb"\d,\d")
_SEMICOLON, _COMMA = re.compile(rb";"), re.compile(rb",")
_COMMAS_BETWEEN = re.compile(rb",[-+\d.eE]*,")


def plain_bvh(name: str, content: bytes, repairs: list[str]) -> bytes:
    """File in plain BVH, with the same line numbers; decimal commas are read only if no number has a point."""
    content = content.rstrip(b"\x1a")
    if b"#" in content or b"/" in content:
        content = _COMMENT.sub(b"", content)
    if b"," in content or b";" in content:
        content = _plain_numbers(name, content, repairs)
    return content


def _plain_numbers(name: str, content: bytes, repairs: list[str]) -> bytes:
    """Offsets and rows with blanks between numbers and decimal points; headers are unchanged."""
    content = content.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    for block in (_OFFSETS, _MOTION):
        changes = _changes(_HEADER.sub(b"", b"\n".join(block.findall(content))))
        repairs += [f"{name}: {words}" for words in changes.values() if f"{name}: {words}" not in repairs]
        content = block.sub(lambda found, changes=tuple(changes): _respelled(found[0], changes), content)  # type: ignore[misc]
    return content


def _changes(numbers: bytes) -> dict[tuple[re.Pattern[bytes], bytes], str]:
    """Replacements by (pattern, replacement), in order, each with the sentence that reports it."""
    changes: dict[tuple[re.Pattern[bytes], bytes], str] = {}
    if b";" in numbers:
        changes[_SEMICOLON, b" "] = "its numbers have semicolons between them; they were read as blanks."
    if _COMMA_AND_BLANK.search(numbers):
        changes[_COMMA_AND_BLANK, b" "] = "its numbers have commas between them; they were read as blanks."
    for pattern, plain in changes:
        numbers = pattern.sub(plain, numbers)
    if _COMMAS_BETWEEN.search(numbers):
        changes[_COMMA, b" "] = "its numbers have commas between them; they were read as blanks."
    elif b"." not in numbers and _DECIMAL_COMMA.search(numbers):
        changes[_COMMA, b"."] = "its numbers have decimal commas; they were read as points."
    return changes


def _respelled(block: bytes, changes: tuple[tuple[re.Pattern[bytes], bytes], ...]) -> bytes:
    start = max((header.end() for header in _HEADER.finditer(block)), default=0)
    rows = block[start:]
    for pattern, plain in changes:
        rows = pattern.sub(plain, rows)
    return block[:start] + rows
