"""Copies of frozen records with other values in some fields."""

from dataclasses import Field, replace
from typing import Any, ClassVar, Protocol, TypeVar, cast


class DataclassRecord(Protocol):
    """Any instance of a dataclass."""

    __dataclass_fields__: ClassVar[dict[str, Field[Any]]]


RecordT = TypeVar("RecordT", bound=DataclassRecord)


def with_fields(record: RecordT, **values: object) -> RecordT:
    """``dataclasses.replace`` for fields that are chosen by name, which no type checker can follow.

    Raises TypeError for a field that the record does not have, and what its own check raises for a value.
    """
    return replace(record, **cast(dict[str, Any], values))
