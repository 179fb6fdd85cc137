"""Records from foreign JSON: every value is read by its type, and errors name its place."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from studio.core.errors import StudioError

_AGAIN = "Export the file again."
_ABSURD = 1e12


@dataclass(frozen=True)
class Record:
    """JSON object of a foreign file; ``where`` (``hero.glb, nodes[3]``) begins the message of every error."""

    value: dict[str, Any]
    where: str

    def __contains__(self, key: str) -> bool:
        return key in self.value

    def value_error(self, key: str, expected: str) -> StudioError:
        """Error for a value that is not of the expected kind."""
        return StudioError(f"{self.where}: '{key}' should be {expected}. {_AGAIN}")

    def inner(self, key: str) -> "Record":
        """Record under ``key``; an empty one if there is none."""
        value = self.value.get(key, {})
        if not isinstance(value, dict):
            raise self.value_error(key, "a record")
        return Record(value, f"{self.where}, {key}")

    def records(self, key: str) -> list["Record"]:
        """Records in the list under ``key``; empty if there is none."""
        return [self._record_in(key, index, item) for index, item in enumerate(self._list(key))]

    def text(self, key: str, default: str = "") -> str:
        """Text under ``key``; ``default`` if there is none."""
        value = self.value.get(key, default)
        if not isinstance(value, str):
            raise self.value_error(key, "a text")
        return value

    def whole(self, key: str, default: int | None = None, least: int = 0) -> int:
        """Integer under ``key``, ``least`` or more."""
        value = self.value.get(key, default)
        if type(value) is not int or not least <= value < 2**53:
            raise self.value_error(key, f"a whole number of {least} or more")
        return value

    def index(self, key: str, count: int) -> int | None:
        """Index under ``key``, below ``count``; None if there is none."""
        if key not in self.value:
            return None
        value = self.whole(key)
        if value >= count:
            raise StudioError(f"{self.where}: '{key}' names number {value}, and there are only {count}. {_AGAIN}")
        return value

    def indices(self, key: str, count: int) -> list[int]:
        """Indices in the list under ``key``, each below ``count``."""
        values = self._list(key)
        if any(type(value) is not int or not 0 <= value < count for value in values):
            raise self.value_error(key, f"a list of numbers below {count}")
        return values

    def numbers(self, key: str, default: tuple[float, ...]) -> tuple[float, ...]:
        """Finite numbers under ``key``, as many as ``default`` has."""
        values = self.value.get(key, default)
        right = isinstance(values, list | tuple) and len(values) == len(default)
        if not right or not all(_is_number(value) for value in values):
            raise self.value_error(key, f"{len(default)} believable numbers")
        return tuple(map(float, values))

    def number(self, key: str, default: float) -> float:
        """Finite number under ``key``; ``default`` if there is none."""
        value = self.value.get(key, default)
        if not _is_number(value):
            raise self.value_error(key, "a believable number")
        return float(value)

    def flag(self, key: str) -> bool:
        """True if the value under ``key`` is true."""
        return self.value.get(key) is True

    def items(self) -> Iterator[tuple[str, "Record"]]:
        """Records that are values of this one, by key."""
        for key in self.value:
            yield key, self.inner(key)

    def _list(self, key: str) -> list[Any]:
        value = self.value.get(key, [])
        if not isinstance(value, list):
            raise self.value_error(key, "a list")
        return value

    def _record_in(self, key: str, index: int, item: Any) -> "Record":
        if not isinstance(item, dict):
            raise self.value_error(f"{key}[{index}]", "a record")
        name = self.where.split(", ")[0]
        return Record(item, f"{name}, {key}[{index}]")


def _is_number(value: Any) -> bool:
    return type(value) in (int, float) and math.isfinite(value) and abs(value) <= _ABSURD
