"""Copies of frozen records with other values of some fields."""

from dataclasses import Field, replace
from typing import Any, ClassVar, Protocol, TypeVar, cast


class DataclassRecord(Protocol):
    """Any instance of a dataclass."""

    __dataclass_fields__: ClassVar[dict[str, Field[Any]]]


RecordT = TypeVar("RecordT", bound=DataclassRecord)


def with_fields(record: RecordT, **values: object) -> RecordT:
    """Copy of a dataclass instance with other values of some fields, named by a dictionary that no type checker can
    follow.

    Raises TypeError for an unknown field, and the errors of the record's own validation.
    """
    return replace(record, **cast(dict[str, Any], values))
