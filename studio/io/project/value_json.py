"""Conversion of frozen dataclasses to plain JSON and back, by their type hints; large arrays become members."""

import types
from collections.abc import Callable, Mapping
from dataclasses import MISSING, Field, dataclass, fields, is_dataclass
from enum import Enum
from functools import cache
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError

Json = Any
Array = NDArray[Any]
MOST_INLINE_NUMBERS = 64
"""Maximum number of elements of an array that is written in the JSON itself."""


class UnknownKind(ValueError):  # noqa: N818 - it names what is the matter
    """Error: an inner record has a kind that this version does not know."""


@dataclass(frozen=True)
class MemberCodec:
    """Access to members with large arrays: ``store`` returns the name of an array's member, ``load`` the array of a
    member.
    """

    store: Callable[[Array], str]
    load: Callable[[str], Array]


def to_json(value: Any, members: MemberCodec) -> Json:
    """Plain JSON of a value made of dataclasses, enumerations, sequences, mappings, numbers and arrays.

    The record of a dataclass in a union has its name under ``kind``.
    """
    match value:
        case np.ndarray():
            inline = 0 < value.size <= MOST_INLINE_NUMBERS and bool(np.isfinite(value).all())
            return value.tolist() if inline else {"member": members.store(value)}
        case Enum():
            return value.value
        case np.generic():
            return value.item()
        case None | bool() | int() | str() | float():
            return value
        case Mapping():
            return {str(to_json(key, members)): to_json(item, members) for key, item in value.items()}
        case tuple() | list():
            return [to_json(item, members) for item in value]
    if not is_dataclass(value):
        raise TypeError(f"A {type(value).__name__} cannot be stored.")
    written = (field.name for field in fields(value) if _is_written(field, value))
    record = {name: to_json(getattr(value, name), members) for name in written}
    kind = getattr(type(value), "kind", None)
    return record if kind is None else {"kind": kind, **record}


def _is_written(field: Field[Any], value: Any) -> bool:
    """True unless a field that was added later has its default: such values are written as in earlier versions."""
    return not (field.metadata.get("sparse") and getattr(value, field.name) == field.default)


def from_json(record: Json, hint: Any, members: MemberCodec) -> Any:
    """Value of the type ``hint`` in a JSON ``record``.

    Raises ValueError, with the path of field names, if the record does not fit. Unknown fields are ignored;
    ``unknown_fields`` finds them.
    """
    origin = get_origin(hint)
    if origin is np.ndarray:
        return _array(record, hint, members)
    if origin in (Union, types.UnionType):
        return _union(record, get_args(hint), members)
    if origin is Literal:
        return _checked(record, record in get_args(hint), f"one of {get_args(hint)}")
    if origin is tuple:
        return _tuple(record, get_args(hint), members)
    if origin in (list, Mapping, dict):
        return _collection(record, origin, get_args(hint), members)
    if is_dataclass(hint):
        return _dataclass(record, hint, members)
    if isinstance(hint, type) and issubclass(hint, Enum):
        return hint(_checked(record, record in tuple(hint), f"one of {', '.join(str(item.value) for item in hint)}"))
    return _plain(record, hint)


def unknown_fields(record: Json, hint: Any) -> dict[str, Json]:
    """Entries of ``record`` and its inner records that are no fields of the dataclass ``hint``.

    For a list of records it is a list of equal length, if any of them has an unknown entry.
    """
    if not is_dataclass(hint) or not isinstance(record, dict):
        return {}
    hints: dict[str, Any] = field_hints(hint)  # type: ignore[arg-type]
    known = (*hints, "kind") if hasattr(hint, "kind") else hints
    unknown = {key: item for key, item in record.items() if key not in known}
    inner = {key: _unknown_within(record[key], hints[key]) for key in record if key in hints}
    return unknown | {key: item for key, item in inner.items() if item}


def _unknown_within(record: Json, hint: Any) -> dict[str, Json] | list[dict[str, Json]]:
    inner = get_args(hint)
    if get_origin(hint) in (Union, types.UnionType):
        fitting = _of_kind(record, inner)
        return unknown_fields(record, fitting[0]) if fitting else {}
    if get_origin(hint) is tuple and inner[1:] == (Ellipsis,) and isinstance(record, list):
        items = [unknown_fields(item, inner[0]) for item in record]
        return items if any(items) else []
    return unknown_fields(record, hint)


@cache
def field_hints(kind: type) -> dict[str, Any]:
    """Resolved type of each field of a dataclass."""
    hints = get_type_hints(kind)
    return {field.name: hints[field.name] for field in fields(kind) if field.init}


def _dataclass(record: Json, kind: Any, members: MemberCodec) -> Any:
    _checked(record, isinstance(record, dict), "a record")
    values = {}
    for name, hint in field_hints(kind).items():
        if name in record:
            try:
                values[name] = from_json(record[name], hint, members)
            except UnknownKind as error:
                raise UnknownKind(f"{name}: {error}") from error
            except (ValueError, StudioError) as error:
                raise ValueError(f"{name}: {error}") from error
    required = {f.name for f in fields(kind) if f.default is MISSING and f.default_factory is MISSING}
    if missing := sorted(required - values.keys()):
        raise ValueError(f"{', '.join(missing)} missing.")
    return _as_stored(kind(**values), values)


def _as_stored(value: Any, stored: dict[str, Any]) -> Any:
    """Keep stored arrays to the bit if the constructor only rounded them again, so that hashes last."""
    for name, array in stored.items():
        built = getattr(value, name)
        if not isinstance(array, np.ndarray) or (built.dtype, built.shape) != (array.dtype, array.shape):
            continue
        if array.dtype.kind == "f" and np.allclose(built, array, rtol=0.0, atol=1e-12, equal_nan=True):
            object.__setattr__(value, name, array)
    return value


def _array(record: Json, hint: Any, members: MemberCodec) -> Array:
    kind = np.dtype(get_args(get_args(hint)[1])[0])
    if isinstance(record, dict):
        return members.load(_plain(record.get("member"), str))
    _checked(record, isinstance(record, list | int | float), "numbers")
    try:
        with np.errstate(over="raise"):
            array = np.array(record, dtype=kind)
    except (TypeError, OverflowError, FloatingPointError) as error:
        raise ValueError("numbers expected, none of them out of range.") from error
    array.setflags(write=False)
    return array


def _union(record: Json, choices: tuple[Any, ...], members: MemberCodec) -> Any:
    if record is None and type(None) in choices:
        return None
    plain = tuple(choice for choice in choices if not is_dataclass(choice) and choice is not type(None))
    records = _of_kind(record, choices)
    if isinstance(record, dict) and "kind" in record and not records:
        kinds = [kind for choice in choices if (kind := getattr(choice, "kind", ""))]
        raise UnknownKind(f"kind: one of {', '.join(kinds)} expected, not {str(record['kind'])[:40]!r}.")
    failure = ValueError("no value.")
    for choice in records or plain or choices:
        try:
            return from_json(record, choice, members)
        except ValueError as error:
            failure = error
    raise failure


def _of_kind(record: Json, choices: tuple[Any, ...]) -> tuple[Any, ...]:
    """Dataclasses among ``choices`` that a record may be: those of its ``kind``, or those without a kind."""
    if not isinstance(record, dict):
        return ()
    return tuple(each for each in choices if is_dataclass(each) and getattr(each, "kind", None) == record.get("kind"))


def _tuple(record: Json, hints: tuple[Any, ...], members: MemberCodec) -> tuple[Any, ...]:
    _checked(record, isinstance(record, list), "a list")
    if len(hints) == 2 and hints[1] is Ellipsis:
        return tuple(from_json(item, hints[0], members) for item in record)
    _checked(record, len(record) == len(hints), f"a list of {len(hints)}")
    return tuple(from_json(item, hint, members) for item, hint in zip(record, hints, strict=True))


def _collection(record: Json, origin: Any, hints: tuple[Any, ...], members: MemberCodec) -> Any:
    if origin is list:
        _checked(record, isinstance(record, list), "a list")
        return [from_json(item, hints[0], members) for item in record]
    _checked(record, isinstance(record, dict), "a record")
    key_hint, value_hint = hints
    return {_key(key, key_hint): from_json(item, value_hint, members) for key, item in record.items()}


def _key(key: str, hint: Any) -> Any:
    if isinstance(hint, type) and issubclass(hint, Enum | int):
        return hint(key)
    return key


def _plain(record: Json, hint: Any) -> Any:
    if hint is Any:
        return record
    if hint is float:
        _checked(record, isinstance(record, int | float) and not isinstance(record, bool), "a number")
        try:
            return float(record)
        except OverflowError as error:
            raise ValueError("a number expected that is not out of range.") from error
    if hint is int:
        return _checked(record, isinstance(record, int) and not isinstance(record, bool), "a whole number")
    return _checked(record, isinstance(record, hint), f"of type {hint.__name__}")


def _checked(record: Json, right: bool, expected: str) -> Json:
    if not right:
        raise ValueError(f"{expected} expected, not {str(record)[:40]!r}.")
    return record
