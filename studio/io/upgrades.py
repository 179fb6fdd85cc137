"""Project files of earlier schemas: one function a step, each with a frozen sample in the tests."""

from collections.abc import Callable, Mapping

from studio.core.errors import StudioError
from studio.io.entity_json import PROJECT_SCHEMA
from studio.io.value_json import Json

UPGRADES: Mapping[int, Callable[[Json], Json]] = {}
"""By the schema a step starts from: a function from ``project.json`` of that schema to that of the next."""


def schema_of(record: Json, name: str) -> int:
    """The schema of a ``project.json``. Raises StudioError naming the member when it states none."""
    schema = record.get("schema") if isinstance(record, dict) else None
    if type(schema) is not int or schema < 1:
        raise StudioError(f"'{name}' in the project file does not say which version it has.")
    return schema


def upgraded(
    record: Json,
    name: str,
    steps: Mapping[int, Callable[[Json], Json]] = UPGRADES,
    newest: int = PROJECT_SCHEMA,
) -> Json:
    """``project.json`` of any schema up to the newest, brought to the newest; later ones stay as they are."""
    for schema in range(schema_of(record, name), newest):
        record = {**steps[schema](record), "schema": schema + 1}
    return record
