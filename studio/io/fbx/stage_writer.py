"""Whole stage as binary FBX 7.4: a node for each performer with its joints and skin, a mesh for each prop."""

from pathlib import Path

import numpy as np

from studio.io.fbx.binary import element
from studio.io.fbx.document import WHOLE_SCENE, FbxDocument, animated
from studio.io.fbx.euler import euler_curves
from studio.io.fbx.take_writer import (
    CURVES_PROGRESS,
    WORLD_TO_FILE,
    geometry,
    node,
    positions_in_file,
    put_curves,
    put_material,
    put_take,
    write_document,
)
from studio.io.registry import Progress
from studio.io.takes.exported_stage import ExportedProp, ExportedStage


def write_stage(path: Path, stage: ExportedStage, progress: Progress) -> None:
    """Write all performers and props of a stage on one clock, at their positions.

    As ``take_writer.write_take``. Raises StudioError if the file cannot be written.
    """
    document = FbxDocument(stage.name, stage.frame_rate, stage.frame_count)
    for number, take in enumerate(stage.takes):

        def reported(share: float, number: int = number) -> None:
            progress(CURVES_PROGRESS * (number + share) / len(stage.takes), f"Writing {path.name}")

        performer = document.add("Model", take.name, "Null", node(), within=WHOLE_SCENE)
        document.add("NodeAttribute", take.name, "Null", [element("TypeFlags", "Null")], within=performer)
        put_take(document, take, performer, reported)
    for prop in stage.props:
        _put_prop(document, prop)
    write_document(path, document, progress)


def _put_prop(document: FbxDocument, prop: ExportedProp) -> None:
    places = positions_in_file(prop.places)
    order, angles = euler_curves(prop.rotations[:, [*WORLD_TO_FILE, 3]])
    begun = animated("Lcl Translation", places[0]), animated("Lcl Rotation", angles[0])
    key = document.add("Model", prop.name, "Mesh", node(*begun, order=order), within=WHOLE_SCENE)
    put_material(document, prop.material, key)
    surface = prop.surface
    kinds = np.zeros(len(surface.triangles), np.int32)
    shape = geometry(surface.vertices, surface.normals, surface.triangles.astype(np.int32), kinds)
    document.add("Geometry", prop.name, "Mesh", shape, within=key)
    if not prop.is_still:
        put_curves(document, key, "Lcl Translation", "T", places)
        put_curves(document, key, "Lcl Rotation", "R", angles)
