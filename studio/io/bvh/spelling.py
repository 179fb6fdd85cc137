"""What some programs write into BVH files beside BVH: comments, the DOS mark of the end, decimal commas."""

import re

_COMMENT = re.compile(rb"^[ \t]*(?:#|//)[^\r\n]*", re.MULTILINE)
_NUMBERS = re.compile(rb"^[ \t]*OFFSET[^\r\n]*|^[ \t]*MOTION[ \t]*$.*\Z", re.MULTILINE | re.DOTALL | re.IGNORECASE)
_DECIMAL_COMMA = re.compile(rb"\d,\d")
_COMMAS_BETWEEN = re.compile(rb",\s|,[-+\d]*,")


def plainly_spelled(name: str, content: bytes, repairs: list[str]) -> bytes:
    """The file as BVH has it, every line in its place; decimal commas only where no number has a point."""
    content = content.rstrip(b"\x1a")
    if b"#" in content or b"/" in content:
        content = _COMMENT.sub(b"", content)
    if b"," in content:
        content = _with_points(name, content, repairs)
    return content


def _with_points(name: str, content: bytes, repairs: list[str]) -> bytes:
    numbers = b"\n".join(_NUMBERS.findall(content.replace(b"\r", b"\n")))
    if b"." in numbers or _COMMAS_BETWEEN.search(numbers) or not _DECIMAL_COMMA.search(numbers):
        return content
    repairs.append(f"{name}: its numbers have decimal commas; they were read as points.")
    return _NUMBERS.sub(
        lambda found: found[0].replace(b",", b"."), content.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    )
