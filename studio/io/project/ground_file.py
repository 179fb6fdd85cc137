"""Ground in a JSON file written by hand or by a program, which ``adapt --ground`` reads.

It is the record of the ground in a project: ``{"kind": "slope", "angle": 0.1}``, ``{"kind": "steps", "rise": 0.15}``.
Heights of a ``height_map`` are lists of metres; ``mesh`` of a ground of triangles names a file beside this one.
"""

from pathlib import Path

from studio.core.errors import StudioError
from studio.core.grounds import GROUND_KINDS
from studio.core.grounds.ground import Ground
from studio.io.json_text import read_json
from studio.io.meshes.mesh_file import read_mesh_beside
from studio.io.project.constraint_file import too_large
from studio.io.project.entity_json import entity_of
from studio.io.project.value_json import Json, unknown_fields

_HEADER = {"kind", "id", "schema"}


def read_ground(path: Path) -> Ground:
    """Ground that the file describes. Raises StudioError, which names file and member."""
    record = read_json(path)
    if not isinstance(record, dict):
        raise StudioError(f"{path}: expected a record of a ground, with its 'kind'.")
    record = {"kind": Ground.kind, **record}
    kind = GROUND_KINDS.get(str(record["kind"]))
    if kind is None:
        raise StudioError(f"{path}, kind: expected one of {', '.join(GROUND_KINDS)}, not '{str(record['kind'])[:40]}'.")
    if isinstance(record.get("mesh"), str):
        mesh = read_mesh_beside(record.pop("mesh"), path, f"{path}, mesh").mesh
        record |= {"vertices": mesh.vertices.tolist(), "triangles": mesh.triangles.tolist()}
    if strange := sorted(unknown_fields(record, kind).keys() - _HEADER):
        raise StudioError(f"{path}: '{strange[0]}' is not known here. Correct its name.")
    if large := too_large(record):
        raise StudioError(f"{path}, {large} is out of range. Lengths are metres, angles radians.")
    try:
        ground = entity_of("grounds", record, _no_member)
    except (ValueError, TypeError) as error:
        raise StudioError(f"{path}, {error}") from error
    assert isinstance(ground, Ground)
    return ground


def _no_member(_name: str) -> Json:
    raise ValueError("an array is written as lists of numbers here.")
