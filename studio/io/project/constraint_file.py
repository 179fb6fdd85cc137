"""Constraints and contacts in a JSON file written by hand or by a program: what ``adapt --constraints`` reads.

Each constraint is the record that a project holds for it (``entity_json``), without the ids::

    {"constraints": [{"kind": "position", "name": "Right wrist", "priority": 0,
                      "point": {"part": "right_forearm", "offset": [0, 0, 0], "at_end": true},
                      "target": [0.4, -0.2, 1.3],
                      "chain": {"limb": 1, "end_segment": 0, "clavicle": 1, "trunk": 0.5, "root": 0},
                      "activation": {"start": 0.5, "full": 0.8, "full_end": 1.2, "end": 1.5, "shape": "quintic"}}],
     "contacts": {"left_heel": [[0, 41]], "left_toe": [], "right_heel": [[12, 60]], "right_toe": []}}

``priority``, ``weight`` and ``chain`` may be left out, and so may ``contacts``, which are then detected. A target may
follow one of the file's ``props``, ``{"box": {"position": [0.4, 0, 0.8]}}``, by its id. A constraint with a ``scope``,
``{"performer_id": "child"}``, is asked of that character alone.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from studio.core.captures.contacts import CONTACT_POINTS, ContactInterval, contact_point
from studio.core.constraints.base import Constraint
from studio.core.constraints.follow import FollowProp
from studio.core.constraints.kinds import CONSTRAINT_KINDS
from studio.core.constraints.objections import objection
from studio.core.constraints.target import follows_of
from studio.core.errors import StudioError
from studio.core.stage.prop import Prop
from studio.io.json_text import read_json
from studio.io.meshes.mesh_file import read_mesh_beside
from studio.io.project.entity_json import Members, entity_of, entity_record
from studio.io.project.value_json import Json, unknown_fields

_MEMBERS = ("constraints", "contacts", "props")
_LARGEST = 1e6
_IDS = {"id", "schema", "kind", "motion_id"}
_RECORDS = (
    "scope",
    "point",
    "chain",
    "activation",
    "target",
    "other",
    "distance",
    "place",
    "centre",
    "heading",
    "weight",
)
_USUAL: Mapping[str, Json] = {"priority": 0, "chain": {}}


@dataclass(frozen=True)
class ConstraintFile:
    """Content of a constraint file; ``contacts`` is None if it has none, ``props`` are by id."""

    constraints: tuple[Constraint, ...]
    contacts: tuple[ContactInterval, ...] | None
    props: Mapping[str, Prop] = field(default_factory=dict)


def read_constraints(path: Path, motion_id: str) -> ConstraintFile:
    """Constraints of a file, in its order, and its contacts, for the motion ``motion_id``.

    Raises StudioError, which names file and member.
    """
    record = read_json(path)  # NaN passes here, and each member refuses it under its name
    if not isinstance(record, dict) or not isinstance(record.get("constraints", []), list):
        raise StudioError(f"{path}: expected a record with a list called 'constraints'.")
    if strange := sorted(record.keys() - set(_MEMBERS)):
        raise StudioError(f"{path}: '{strange[0]}' is not known here. Members are {', '.join(_MEMBERS)}.")
    constraints = [
        constraint_of(
            _with_mesh(item, path, f"{path}, constraints[{index}]"), motion_id, f"{path}, constraints[{index}]"
        )
        for index, item in enumerate(record.get("constraints", []))
    ]
    for index, constraint in enumerate(constraints):
        if sentence := objection(constraint, constraints[:index]):
            raise StudioError(f"{path}, constraints[{index}]: {sentence}")
    contacts = contacts_of(record["contacts"], motion_id, str(path)) if "contacts" in record else None
    props = _props(record.get("props", {}), str(path))
    for constraint in constraints:
        for follow in follows_of(constraint):
            if isinstance(follow, FollowProp) and follow.prop_id not in props:
                raise StudioError(f"{path}: '{constraint.name}' follows prop '{follow.prop_id}', which is not there.")
    return ConstraintFile(tuple(constraints), contacts, props)


def constraint_record(constraint: Constraint) -> Json:
    """JSON record of a constraint for a constraint file, which ``constraint_of`` reads."""
    members: Members = {}
    record = entity_record("constraints", "", constraint, members)
    if not constraint.scope.is_narrow:
        del record["scope"]
    return {key: _inline(item, members) for key, item in record.items() if key == "kind" or key not in _IDS}


def _inline(item: Json, members: Members) -> Json:
    """JSON with the numbers of large arrays inside, where a project names a member."""
    if not isinstance(item, dict):
        return item
    if "member" in item:
        return members[item["member"]].tolist()
    return {key: _inline(inner, members) for key, inner in item.items()}


def _with_mesh(record: Json, path: Path, where: str) -> Json:
    """Record with the mesh itself in place of the name of a file beside ``path``."""
    if not isinstance(record, dict) or not isinstance(record.get("mesh"), str):
        return record
    mesh = read_mesh_beside(record["mesh"], path, f"{where}, mesh").mesh
    return {**record, "mesh": {"vertices": mesh.vertices.tolist(), "triangles": mesh.triangles.tolist()}}


def constraint_of(record: Json, motion_id: str, where: str) -> Constraint:
    """Constraint in a JSON record. Raises StudioError, which begins with ``where``."""
    if not isinstance(record, dict):
        raise StudioError(f"{where}: expected a record, not {str(record)[:40]!r}.")
    name = record.get("name")
    if isinstance(name, str):
        where += f" ('{name[:40]}')"
    kind = CONSTRAINT_KINDS.get(str(record.get("kind")))
    if kind is None:
        asked = f"not '{str(record['kind'])[:40]}'" if "kind" in record else "but it says none"
        raise StudioError(f"{where}, kind: expected one of {', '.join(CONSTRAINT_KINDS)}, {asked}.")
    if strange := _paths({k: v for k, v in unknown_fields(record, kind.value).items() if k not in _IDS}):
        raise StudioError(f"{where}: '{strange[0]}' is not known here. Correct its name.")
    if large := too_large(record):
        raise StudioError(f"{where}, {large} is out of range. Lengths are metres, times seconds.")
    try:
        found = entity_of("constraints", {**_USUAL, **record, "motion_id": motion_id}, _no_member)
    except (ValueError, TypeError) as error:
        reason = str(error).removeprefix(f"'{name}': ")
        raise StudioError(f"{where}, {reason}") from error
    assert isinstance(found, Constraint)
    return found


def _paths(unknown: Mapping[str, Any]) -> list[str]:
    """Paths of unknown fields: ``{"chain": {"arm": 1}}`` as ``["chain.arm"]``."""
    paths = []
    for key, item in unknown.items():
        paths += [f"{key}.{inner}" for inner in _paths(item)] if key in _RECORDS else [key]
    return paths


def too_large(record: Json) -> str:
    """Member and number of the first value that no body and no clip can have; empty if there is none."""
    items = record.items() if isinstance(record, dict) else enumerate(record) if isinstance(record, list) else ()
    for key, item in items:
        if isinstance(item, int | float):
            if _LARGEST < abs(item) < math.inf:
                return f"{key}: {str(item)[:20]}"
        elif inner := too_large(item):
            return f"{key}, {inner}"
    return ""


def contacts_of(record: Json, motion_id: str, where: str) -> tuple[ContactInterval, ...]:
    """Contacts that ``record`` lists by contact point. Raises StudioError, which begins with ``where``."""
    if not isinstance(record, dict):
        raise StudioError(f"{where}, contacts: expected a record of lists by foot.")
    contacts = []
    for foot, spans in record.items():
        if foot not in CONTACT_POINTS or not isinstance(spans, list):
            raise StudioError(
                f"{where}, contacts, {foot}: expected lists of [first, last] by {', '.join(CONTACT_POINTS)}."
            )
        for index, span in enumerate(spans):
            if not (isinstance(span, list) and len(span) == 2 and all(type(frame) is int for frame in span)):
                raise StudioError(f"{where}, contacts, {foot}[{index}]: expected two frames [first, last].")
            try:
                contacts.append(ContactInterval(motion_id, contact_point(foot), *span))
            except ValueError as error:
                raise StudioError(f"{where}, contacts, {foot}[{index}]: {error}") from error
    return tuple(contacts)


def _props(record: Json, where: str) -> dict[str, Prop]:
    if not isinstance(record, dict):
        raise StudioError(f"{where}, props: expected a record of props by id.")
    props = {}
    for key, item in record.items():
        if not isinstance(item, dict):
            raise StudioError(f"{where}, props, {key}: expected a record, not {str(item)[:40]!r}.")
        if strange := sorted(item.keys() - {"name", "size", "position", "heading"}):
            raise StudioError(f"{where}, props, {key}: '{strange[0]}' is not known here. Correct its name.")
        try:
            found = entity_of("props", {"name": key, **item}, _no_member)
        except (ValueError, TypeError) as error:
            raise StudioError(f"{where}, props, {key}, {error}") from error
        assert isinstance(found, Prop)
        props[key] = found
    return props


def _no_member(_name: str) -> Any:
    raise ValueError("an array is not expected here.")
