"""glTF whose JSON says other things than it should: described or refused in a sentence, and never anything else."""

from pathlib import Path
from random import Random
from typing import Any

import pytest

from tests.io.character_files import Gltf
from tests.io.test_fuzz import look_at

VALUES: list[Any] = [
    *(0, 1, -1, 3, 18, 19, 151, 10**9, 2**60, 0.5, -1e9, 1e300, 1e-300, True, None, "", "x", "../x"),
    *([], {}, [0], [1e9, 0, 0], [0, 0, 0, 0], [None], ["x"], {"x": 1}),
]


def places(value: Any) -> list[tuple[Any, Any]]:
    """Every container with each of its keys."""
    found: list[tuple[Any, Any]] = []
    waiting = [value]
    while waiting:
        container = waiting.pop()
        keys = list(container) if isinstance(container, dict) else list(range(len(container)))
        found += [(container, key) for key in keys]
        waiting += [container[key] for key in keys if isinstance(container[key], dict | list)]
    return found


def changed(random: Random) -> bytes:
    """A figure with some values of its JSON changed, or some bytes of its buffer."""
    made = Gltf(vrm=random.choice([None, 0, 1]))
    made.root["nodes"][3]["rotation"] = [0.0, 0.0, 0.1, 0.9]
    for _ in range(random.choice([0, 1, 1, 1, 2, 4])):
        container, key = random.choice(places(made.root))
        match random.randrange(4):
            case 0 if isinstance(container, dict):
                del container[key]
            case 1 if isinstance(container, list):
                container.append(container[key])
            case _:
                container[key] = random.choice(VALUES)
    if random.random() < 0.4:
        binary = bytearray(made.binary)
        for _ in range(random.choice([1, 8, 64])):
            binary[random.randrange(len(binary))] = random.choice([0, 1, 0x7F, 0x80, 0xFF, random.randrange(256)])
        made.binary = bytes(binary)
    return made.glb()


@pytest.mark.parametrize("seed", range(3))
def test_a_gltf_with_other_values_is_described_or_refused(tmp_path: Path, seed: int) -> None:
    path, read = tmp_path / "hero.glb", 0
    for number in range(50):
        path.write_bytes(changed(Random(1000 * seed + number)))
        read += look_at(path)
    assert 0 < read < 50
