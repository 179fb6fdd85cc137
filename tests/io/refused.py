"""The check of every file that is refused, whatever its format."""

from collections.abc import Callable
from pathlib import Path

import pytest

from studio.core.errors import StudioError


def refused(read: Callable[[Path], object], path: Path, content: bytes | str, words: str) -> str:
    """Sentence with which a file of ``content`` is refused; it has ``words`` (a pattern) in it and names a file."""
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    with pytest.raises(StudioError, match=words) as refusal:
        read(path)
    sentence = str(refusal.value)
    assert path.stem in sentence or "gone" in sentence
    assert len(sentence) < 1000
    return sentence
