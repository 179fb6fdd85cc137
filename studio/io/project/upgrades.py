"""Upgrades of project files of earlier schemas: one function for each step, with a frozen sample in the tests."""

from collections.abc import Callable, Mapping

from studio.core.errors import StudioError
from studio.io.project.entity_json import PROJECT_SCHEMA
from studio.io.project.value_json import Json


def _with_clips_that_have_ids(record: Json) -> Json:
    """Schema 2: clips have ids, and may be retimed, mirrored and placed; constraints and contacts have scopes.

    Constraints applied to all performers of the motion, which is the meaning of a missing scope.
    """
    performers = record.get("performers", [])
    for performer in performers if isinstance(performers, list) else []:
        clips = performer.get("clips") if isinstance(performer, dict) else None
        for index, clip in enumerate(clips if isinstance(clips, list) else []):
            if isinstance(clip, dict):
                clip.setdefault("id", f"{performer.get('id')} {index}")
    return record


UPGRADES: Mapping[int, Callable[[Json], Json]] = {1: _with_clips_that_have_ids}
"""Functions that convert ``project.json`` from the schema that is their key to the next one."""


def schema_of(record: Json, name: str) -> int:
    """Schema of a ``project.json``. Raises StudioError naming the member if it has none."""
    schema = record.get("schema") if isinstance(record, dict) else None
    if type(schema) is not int or schema < 1:
        raise StudioError(f"'{name}' in the project file does not say which version it has.")
    return schema


def upgraded_record(
    record: Json,
    name: str,
    steps: Mapping[int, Callable[[Json], Json]] = UPGRADES,
    newest: int = PROJECT_SCHEMA,
) -> Json:
    """Record of ``project.json``, upgraded to the newest schema; one of a later schema is unchanged."""
    for schema in range(schema_of(record, name), newest):
        record = {**steps[schema](record), "schema": schema + 1}
    return record
