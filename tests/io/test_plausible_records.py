"""No number in a project can be absurd: each of every kind of record is refused beyond what is possible."""

import json
from collections.abc import Iterator
from typing import Any

from studio.core.errors import StudioError
from studio.core.grounds import Bumps, HeightMap, Slope, Steps
from studio.core.stage.project import COLLECTIONS, Entity
from studio.io.project.entity_json import entity_of, entity_record
from studio.library.scenes import SCENES
from tests.builders import make_project
from tests.io.test_constraint_kinds_stored import CONSTRAINTS, TARGETS

ABSURD = 1e30
DIRECTIONS = ("turn", "axis")
"""Of which only the way counts, not the length."""
Path = tuple[str | int, ...]


def entities() -> Iterator[tuple[str, Entity]]:
    for project in (make_project(), *(scene.make() for scene in SCENES)):
        for collection in COLLECTIONS:
            yield from ((collection, each) for each in getattr(project, collection).values())
    yield from (("constraints", each) for each in (*CONSTRAINTS, *TARGETS))
    yield from (("grounds", each) for each in (Slope(), Steps(), Bumps(), HeightMap()))


def numbers_in(value: Any, path: Path = ()) -> Iterator[Path]:
    if isinstance(value, dict | list):
        for key, each in value.items() if isinstance(value, dict) else enumerate(value):
            yield from numbers_in(each, (*path, key))
    elif isinstance(value, float | int) and not isinstance(value, bool):
        yield path


def with_number(record: Any, path: Path, number: float) -> Any:
    changed = container = json.loads(json.dumps(record))
    for key in path[:-1]:
        container = container[key]
    container[path[-1]] = number
    return changed


def is_direction(entity: Entity, names: list[str]) -> bool:
    quaternion = {"orientation": "target", "area": "tilt"}.get(getattr(entity, "kind", ""))
    turned = names[:1] == [quaternion] and "times" not in names
    return turned or (any(name in DIRECTIONS for name in names[-1:]) and not hasattr(entity, "clips"))


def test_every_number_of_every_kind_of_record_is_refused_beyond_what_is_possible() -> None:
    tried, taken = set(), []
    for collection, entity in entities():
        members: dict[str, Any] = {}
        record = json.loads(json.dumps(entity_record(collection, "one", entity, members)))
        for path in numbers_in(record):
            names = [each for each in path if isinstance(each, str)]
            place = (collection, record.get("kind"), *names)
            if place in tried or names == ["schema"] or is_direction(entity, names):
                continue
            tried.add(place)
            try:
                entity_of(collection, with_number(record, path, ABSURD), members.__getitem__)
                taken.append(place)
            except (ValueError, StudioError):
                pass
    assert taken == []
    assert len(tried) > 150
