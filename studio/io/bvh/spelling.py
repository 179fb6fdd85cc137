"""What some programs write into BVH files beside BVH: comments, the DOS mark of the end, commas, semicolons."""

import re

_COMMENT = re.compile(rb"^[ \t]*(?:#|//)[^\r\n]*", re.MULTILINE)
_NUMBERS = re.compile(rb"^[ \t]*OFFSET[^\r\n]*|^[ \t]*MOTION[ \t]*$.*\Z", re.MULTILINE | re.DOTALL | re.IGNORECASE)
_HEADER = re.compile(rb"^[ \t]*(?:MOTION|FRAMES?\b)[^\n]*", re.MULTILINE | re.IGNORECASE)
_COMMA_AND_BLANK = re.compile(rb",(?=\s)|(?<=\s),")
_DECIMAL_COMMA = re.compile(rb"\d,\d")
_COMMAS_BETWEEN = re.compile(rb",[-+\d.eE]*,")


def plainly_spelled(name: str, content: bytes, repairs: list[str]) -> bytes:
    """The file as BVH has it, every line in its place; decimal commas only where no number has a point."""
    content = content.rstrip(b"\x1a")
    if b"#" in content or b"/" in content:
        content = _COMMENT.sub(b"", content)
    if b"," in content or b";" in content:
        content = _plain_numbers(name, content, repairs)
    return content


def _plain_numbers(name: str, content: bytes, repairs: list[str]) -> bytes:
    """Offsets and rows with blanks between their numbers and points in them; the header of the motion stays."""
    content = content.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    numbers = _HEADER.sub(b"", b"\n".join(_NUMBERS.findall(content)))
    changes: list[tuple[re.Pattern[bytes], bytes, str]] = []
    if b";" in numbers:
        changes.append((re.compile(b";"), b" ", "its numbers have semicolons between them; they were read as blanks."))
    if _COMMA_AND_BLANK.search(numbers):
        changes.append((_COMMA_AND_BLANK, b" ", "its numbers have commas between them; they were read as blanks."))
    for pattern, plain, _ in changes:
        numbers = pattern.sub(plain, numbers)
    if _COMMAS_BETWEEN.search(numbers):
        changes.append((re.compile(b","), b" ", "its numbers have commas between them; they were read as blanks."))
    elif b"." not in numbers and _DECIMAL_COMMA.search(numbers):
        changes.append((re.compile(b","), b".", "its numbers have decimal commas; they were read as points."))

    def respelled(found: re.Match[bytes]) -> bytes:
        start = max((header.end() for header in _HEADER.finditer(found[0])), default=0)
        rows = found[0][start:]
        for pattern, plain, _ in changes:
            rows = pattern.sub(plain, rows)
        return found[0][:start] + rows

    repairs += dict.fromkeys(f"{name}: {words}" for _, _, words in changes)
    return _NUMBERS.sub(respelled, content) if changes else content
