"""Every kind of file that the studio reads, spoilt in a few places: read, or refused in a sentence. Seeded.

Kinds come from the registry, so that none is forgotten; ``make soak`` tries 5,000 to 100,000 of each.
"""

from pathlib import Path
from random import Random

import pytest

from studio.core.errors import StudioError
from studio.io.registry import OWN_FORMATS
from tests.io.seeds import SEEDS, read, spoiled

MUTATIONS = 250
ELSEWHERE = {
    ".fbx": 8,
    ".usda": 8,
    ".usdc": 4,
    ".usd": 2,
    ".usdz": 2,
    ".c3d": 100,
    ".trc": 100,
    ".amc": 100,
    ".asf": 100,
    ".gltf": 100,
    ".vrm": 100,
    ".vrma": 100,
    ".vrml": 100,
    ".x3dv": 100,
    ".s4d": 1000,
    ".npz": 1000,
}
"""Of those that are spoilt in tests of their own, are read as another of the same parser, or take long to be read; and
of those in which few changes are not told by a checksum."""

COMPRESSED = (".usdc", ".usd", ".usdz")
"""Kinds in which hardly a byte can change unnoticed, so that all of the few that are tried may be refused."""


def test_every_kind_of_file_that_is_read_is_spoilt() -> None:
    readers = [known for known in OWN_FORMATS if known.capture_reader or known.character_reader]
    assert {suffix for known in readers for suffix in known.suffixes} <= set(SEEDS)


@pytest.mark.parametrize("suffix", SEEDS)
def test_a_spoilt_file_is_read_or_refused_in_a_sentence(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"take{suffix}"
    SEEDS[suffix](path)
    read(path)
    original, opened = path.read_bytes(), 0
    sentences: list[str] = []
    count = ELSEWHERE.get(suffix, MUTATIONS)
    for seed in range(count):
        path.write_bytes(spoiled(Random(seed), original))
        try:
            read(path)
            opened += 1
        except StudioError as error:
            sentences.append(str(error))
    assert (0 if suffix in COMPRESSED else 1) <= opened < count
    assert all(10 < len(sentence) < 4000 for sentence in sentences)
