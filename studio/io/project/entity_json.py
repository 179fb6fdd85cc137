"""Entities and whole projects as canonical JSON: sorted keys, one entity per line, arrays by their hash."""

import hashlib
import io
import json
import math
import re
import weakref
from collections.abc import Callable
from dataclasses import dataclass, field, fields, is_dataclass
from typing import Any

import numpy as np

from studio.core.body.morphology import Proportions
from studio.core.captures.contacts import ContactInterval, ContactPoint
from studio.core.constraints.area import AreaConstraint
from studio.core.constraints.base import Constraint
from studio.core.constraints.follow import UNTURNED
from studio.core.constraints.kinds import CONSTRAINT_KINDS
from studio.core.curves.keyed import KeyedNumber
from studio.core.errors import StudioError
from studio.core.grounds import GROUND_KINDS
from studio.core.grounds.ground import Ground
from studio.core.mesh.character import Character
from studio.core.stage.project import COLLECTION_CLASSES, COLLECTIONS, Entity, Project
from studio.core.stage.prop import Carried, InHand, Prop
from studio.io.json_text import json_of
from studio.io.project.value_json import Array, Json, MemberCodec, UnknownKind, from_json, to_json, unknown_fields

PROJECT_SCHEMA = 2
ENTITY_SCHEMAS = {
    **dict.fromkeys(COLLECTIONS, 1), "characters": 3, "performers": 2, "constraints": 7, "contacts": 3, "props": 6,
}  # fmt: skip
"""Current schema of each collection; an older version refuses a higher number, whose known fields it would misread."""
MEMBER_NAME_PATTERN = re.compile(r"(captures|characters)/[0-9a-f]{64}\.npy")
_HEADER = ("id", "kind", "schema")

Members = dict[str, Array]

_names: dict[int, tuple[weakref.ref[Array], str]] = {}


def npy_bytes(array: Array) -> bytes:
    """Bytes of an ``.npy`` file with an array; equal numbers always give equal bytes."""
    return b"".join(npy_parts(array))  # lets go of Python's lock


def npy_parts(array: Array) -> tuple[bytes, memoryview]:
    """Header and content of an ``.npy`` file with an array."""
    little = np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("<")).reshape(array.shape)
    stream = io.BytesIO()
    np.lib.format.write_array_header_1_0(stream, np.lib.format.header_data_from_array_1_0(little))
    return stream.getvalue(), little.reshape(-1).view(np.uint8).data


def member_name(array: Array, folder: str) -> str:
    """Name ``folder/<sha256>.npy`` of an array's member; cached for read-only arrays."""
    known = _names.get(id(array))
    if known is None or known[0]() is not array:
        digest = sha256_of(*npy_parts(array))
        if not array.flags.writeable:
            key = id(array)
            _names[key] = (weakref.ref(array, lambda _gone: _names.pop(key, None)), digest)
    else:
        digest = known[1]
    return f"{folder}/{digest}.npy"


def sha256_of(*parts: bytes | memoryview) -> str:
    """Digest of these bytes, concatenated."""
    total = hashlib.sha256()
    for part in parts:
        total.update(part)
    return total.hexdigest()


def entity_record(collection: str, entity_id: str, entity: Entity, members: Members) -> dict[str, Json]:
    """JSON record of an entity; its arrays are added to ``members`` under their names."""
    folder = "captures" if collection == "captures" else "characters"

    def store(array: Array) -> str:
        name = member_name(array, folder)
        members[name] = array
        return name

    record = to_json(entity, MemberCodec(store, _no_member))
    return {**record, "id": entity_id, "schema": _schema_of(collection, entity)}


def _schema_of(collection: str, entity: Entity) -> int:
    """Lowest schema that can hold an entity.

    A contact with the ground, a constant body or keys without tangents are so written as in earlier versions.
    """
    if isinstance(entity, Prop) and any(isinstance(hold, Carried) and hold.steady for hold in entity.holds):
        return ENTITY_SCHEMAS[collection]
    if isinstance(entity, Prop) and (entity.tilt != UNTURNED or any(_is_tilted(hold) for hold in entity.holds)):
        return 5
    if isinstance(entity, Constraint) and (isinstance(entity.weight, KeyedNumber) or entity.weight == 0.0):
        return ENTITY_SCHEMAS[collection]
    if isinstance(entity, AreaConstraint) and entity.tilt != UNTURNED:
        return 6
    if isinstance(entity, AreaConstraint) and entity.margin:
        return 5
    if isinstance(entity, Constraint | Character | Prop) and _has_curves(entity):
        return 3 if isinstance(entity, Character) else 4
    if isinstance(entity, Constraint):
        return 3
    if isinstance(entity, ContactInterval) and isinstance(entity.point, ContactPoint):
        return 2
    if isinstance(entity, Character):
        return 1 if isinstance(entity.proportions, Proportions) else 2
    if isinstance(entity, Prop):
        return 3 if entity.later else 2
    return ENTITY_SCHEMAS[collection]


def _is_tilted(hold: InHand | Carried) -> bool:
    return isinstance(hold, Carried) and hold.tilt != UNTURNED


def _has_curves(entity: Entity) -> bool:
    """True if it has tangents, weights, or keys with extrapolation."""
    return any(
        is_dataclass(value)
        and any(each.metadata.get("sparse") and getattr(value, each.name) != each.default for each in fields(value))
        for value in vars(entity).values()
    )


def entity_of(collection: str, record: Json, load: Callable[[str], Array]) -> Entity:
    """Entity in a record. Raises ValueError, which names the wrong field."""
    try:
        entity: Entity = from_json(record, _class_of(collection, record), MemberCodec(_no_member, load))
    except (TypeError, ArithmeticError, LookupError) as error:
        raise ValueError(f"invalid value ({error}).") from error
    return entity


def is_known(collection: str, record: Json) -> bool:
    """True if this version understands the record; others are preserved unchanged."""
    schema = record.get("schema", 1)
    return schema <= ENTITY_SCHEMAS[collection] and _class_of(collection, record) is not None


def record_line(record: Json) -> str:
    """JSON of one record on one line: sorted keys, no spaces, no number that is not finite."""
    return json.dumps(record, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False)


def parse_member(content: bytes, name: str) -> Json:
    """JSON value of a member. Raises StudioError, which names the member."""
    try:
        return json_of(content, parse_constant=_refuse_constant, parse_float=_finite)
    except ValueError as error:
        raise StudioError(f"'{name}' in the project file is not readable as JSON: {error}.") from error


def project_json(project: Project, members: Members) -> bytes:
    """Canonical JSON of a project: equal projects give equal bytes."""
    carried = project.carried
    lists = {}
    for collection in COLLECTIONS:
        records = [
            _with_unknown(
                entity_record(collection, key, entity, members),
                carried.get("fields", {}).get(f"{collection}/{key}", {}),
            )
            for key, entity in getattr(project, collection).items()
        ]
        lists[collection] = [*records, *carried.get("entities", {}).get(collection, ())]
    root: dict[str, Any] = {**carried.get("root", {}), "schema": PROJECT_SCHEMA}
    blocks = {
        name: "[\n" + ",\n".join(map(record_line, items)) + "\n]" if items else "[]" for name, items in lists.items()
    }
    blocks |= {name: record_line(item) for name, item in root.items()}
    return ("{\n" + ",\n".join(f"{record_line(name)}:{blocks[name]}" for name in sorted(blocks)) + "\n}\n").encode()


@dataclass
class ReadProject:
    """Project read from JSON, with sentences about lost parts (``losses``) and about parts kept without being
    understood.
    """

    project: Project
    losses: list[str] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)


def project_of(record: Json, load: Callable[[str], Array]) -> ReadProject:
    """Project in a record; unreadable entities are left out and listed.

    ``load`` returns the array of a member and raises ValueError if it is missing or damaged.
    """
    if not isinstance(record, dict):
        raise StudioError("'project.json' in the project file is not a record.")
    entities: dict[str, dict[str, Entity]] = {name: {} for name in COLLECTIONS}
    foreign: dict[str, list[Json]] = {}
    unknown: dict[str, Json] = {}
    losses: list[str] = []
    for collection in COLLECTIONS:
        for item in _records(record, collection, losses):
            if not is_known(collection, item):
                foreign.setdefault(collection, []).append(item)
                continue
            try:
                entities[collection][item["id"]] = entity_of(collection, item, load)
            except UnknownKind:
                foreign.setdefault(collection, []).append(item)
                continue
            except (ValueError, StudioError) as error:
                losses.append(f"{collection}, {_title(item)}: {error}")
                continue
            extra = {k: v for k, v in unknown_fields(item, _class_of(collection, item)).items() if k not in _HEADER}
            if extra:
                unknown[f"{collection}/{item['id']}"] = extra
    _part_with_dangling(entities, foreign, record, losses)
    root = {key: item for key, item in record.items() if key not in (*COLLECTIONS, "schema")}
    carried = {"root": root, "entities": foreign, "fields": unknown}
    carried = {key: item for key, item in carried.items() if item}
    if not entities["grounds"]:
        del entities["grounds"]
    remarks = [
        f"{name}, {_title(item)}: this version does not know it. It is not shown, and is kept as it is."
        for name, items in foreign.items()
        for item in items
    ]
    return ReadProject(Project(**entities, carried=carried), losses, remarks)  # type: ignore[arg-type]


def named_members(record: Json) -> set[str]:
    """Names of all members that a JSON value refers to."""
    return {match.group() for match in MEMBER_NAME_PATTERN.finditer(json.dumps(record))}


def _records(record: dict[str, Json], collection: str, losses: list[str]) -> list[dict[str, Json]]:
    """Valid records of a collection: each an object with a unique id and an integer schema."""
    items = record.get(collection, [])
    usable: dict[str, dict[str, Json]] = {}
    for item in items if isinstance(items, list) else [items]:
        key = item.get("id") if isinstance(item, dict) else None
        if not isinstance(key, str) or key in usable or type(item.get("schema", 1)) is not int:
            losses.append(f"{collection}: a record without a proper id or schema was left out.")
        else:
            usable[key] = item
    return list(usable.values())


def _part_with_dangling(
    entities: dict[str, dict[str, Entity]], foreign: dict[str, list[Json]], record: Json, losses: list[str]
) -> None:
    """Move entities that refer to unknown entities to ``foreign``; those that refer to lost ones are lost."""
    carried = {(name, item["id"]) for name, items in foreign.items() for item in items}
    while True:
        project = Project(**entities)  # type: ignore[arg-type]
        dangling = [
            (name, key, missing)
            for name in COLLECTIONS
            for key, entity in entities[name].items()
            if (missing := project.missing_references(entity))
        ]
        if not dangling:
            return
        for name, key, missing in dangling:
            del entities[name][key]
            item = next(item for item in record[name] if isinstance(item, dict) and item.get("id") == key)
            if set(missing) <= carried:
                foreign.setdefault(name, []).append(item)
                carried.add((name, key))
            else:
                losses.append(f"{name}, {_title(item)}: it needs {missing[0][0]} that could not be read.")


def _class_of(collection: str, record: Json) -> Any:
    if collection == "constraints":
        known = CONSTRAINT_KINDS.get(str(record.get("kind")))
        return known.value if known else None
    if collection == "grounds":
        return GROUND_KINDS.get(str(record.get("kind", Ground.kind)))
    return COLLECTION_CLASSES[collection]


def _with_unknown(record: dict[str, Json], unknown: dict[str, Json]) -> dict[str, Json]:
    """Record with the unknown fields of the file merged back, so that saving keeps them; list items are matched by
    position.
    """
    merged = dict(record)
    for key, item in unknown.items():
        inner = merged.get(key)
        if isinstance(inner, dict) and isinstance(item, dict):
            merged[key] = _with_unknown(inner, item)
        elif isinstance(inner, list) and isinstance(item, list) and len(inner) == len(item):
            merged[key] = [_with_unknown(*pair) for pair in zip(inner, item, strict=True)]
        else:
            merged.setdefault(key, item)
    return merged


def _title(record: dict[str, Json]) -> str:
    return f"'{record.get('name') or record.get('id')}'"


def _refuse_constant(name: str) -> None:
    raise ValueError(f"{name} is not a number")


def _finite(text: str) -> float:
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(f"{text} is out of range")
    return number


def _no_member(_argument: Any) -> Any:
    raise ValueError("an array is not expected here.")
