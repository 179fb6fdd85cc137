"""Writer of a whole stage as binary FBX 7.4: a node for each performer with joints and skin, meshes of
props, cameras.
"""

from pathlib import Path

import numpy as np

from studio.core.rotations import from_matrix
from studio.core.stage.saved_camera import CAMERA_ASPECT, CAMERA_FAR_METRES, CAMERA_NEAR_METRES, VIEW_ANGLE, SavedCamera
from studio.io.fbx.binary import element
from studio.io.fbx.document import SCENE_ROOT_ID, FbxDocument, animated, choice, number, properties, row
from studio.io.fbx.euler import euler_curves
from studio.io.fbx.take_writer import (
    CENTIMETRES_PER_METRE,
    CURVES_DONE_FRACTION,
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

CAMERA_FOCAL_LENGTH, MILLIMETRES_PER_INCH = 50.0, 25.4
"""Focal length of every camera in millimetres, and millimetres in the inches in which film sizes are written."""
FILM_HEIGHT_INCHES = 2.0 * CAMERA_FOCAL_LENGTH * np.tan(VIEW_ANGLE / 2) / MILLIMETRES_PER_INCH
ORTHOGRAPHIC_WIDTH_CENTIMETRES = 30.0
"""Width in centimetres that a parallel camera of zoom 1 sees in FBX."""
_FIXED_RATIO, _VERTICAL_APERTURE = 1, 2
"""Numbers of FBX's ways to state the shape of the picture and the angle of view."""


def write_stage(path: Path, stage: ExportedStage, progress: Progress) -> None:
    """Write all performers, props and cameras of a stage with common frames, at their positions.

    Units, axes and accuracy are those of ``take_writer.write_take``. Raises StudioError if the file cannot be written.
    """
    document = FbxDocument(stage.name, stage.frame_rate, stage.frame_count)
    for index, take in enumerate(stage.takes):

        def reported(share: float, index: int = index) -> None:
            progress(CURVES_DONE_FRACTION * (index + share) / len(stage.takes), f"Writing {path.name}")

        performer = document.add("Model", take.name, "Null", node(), within=SCENE_ROOT_ID)
        document.add("NodeAttribute", take.name, "Null", [element("TypeFlags", "Null")], within=performer)
        put_take(document, take, performer, reported)
    for prop in stage.props:
        _put_prop(document, prop)
    for camera in stage.cameras:
        _put_camera(document, camera)
    write_document(path, document, progress)


def _put_prop(document: FbxDocument, prop: ExportedProp) -> None:
    places = positions_in_file(prop.places)
    order, angles = euler_curves(prop.rotations[:, [*WORLD_TO_FILE, 3]])
    begun = animated("Lcl Translation", places[0]), animated("Lcl Rotation", angles[0])
    key = document.add("Model", prop.name, "Mesh", node(*begun, order=order), within=SCENE_ROOT_ID)
    put_material(document, prop.material, key)
    surface = prop.surface
    kinds = np.zeros(len(surface.triangles), np.int32)
    shape = geometry(surface.vertices, surface.normals, surface.triangles.astype(np.int32), kinds)
    document.add("Geometry", prop.name, "Mesh", shape, within=key)
    if not prop.is_still:
        put_curves(document, key, "Lcl Translation", "T", places)
        put_curves(document, key, "Lcl Rotation", "R", angles)


def _put_camera(document: FbxDocument, camera: SavedCamera) -> None:
    """Add a camera, which looks along its own X axis with Y up."""
    placement = camera.placement
    right, up, backward = placement.axes
    looking = np.stack([-backward, up, right], axis=1)
    order, angles = euler_curves(from_matrix(looking[WORLD_TO_FILE])[None])
    eye, target, upward = positions_in_file(np.stack([placement.eye, placement.target, up]))
    begun = animated("Lcl Translation", eye), animated("Lcl Rotation", angles[0])
    key = document.add("Model", camera.name, "Camera", node(*begun, order=order), within=SCENE_ROOT_ID)
    width = 2.0 * CENTIMETRES_PER_METRE * CAMERA_ASPECT * placement.half_height
    rows = [
        choice("CameraProjectionType", int(placement.parallel)),
        choice("AspectRatioMode", _FIXED_RATIO),
        number("AspectWidth", CAMERA_ASPECT),
        number("AspectHeight", 1.0),
        choice("ApertureMode", _VERTICAL_APERTURE),
        row("FieldOfView", "FieldOfView", "", "A", float(np.degrees(VIEW_ANGLE))),
        row("FocalLength", "Number", "", "A", CAMERA_FOCAL_LENGTH),
        number("FilmWidth", CAMERA_ASPECT * FILM_HEIGHT_INCHES),
        number("FilmHeight", FILM_HEIGHT_INCHES),
        number("FilmAspectRatio", CAMERA_ASPECT),
        number("OrthoZoom", width / ORTHOGRAPHIC_WIDTH_CENTIMETRES),
        number("NearPlane", CENTIMETRES_PER_METRE * CAMERA_NEAR_METRES),
        number("FarPlane", CENTIMETRES_PER_METRE * CAMERA_FAR_METRES),
        number("FocusDistance", CENTIMETRES_PER_METRE * placement.distance),
    ]
    about = [
        element("TypeFlags", "Camera"),
        element("GeometryVersion", 124),
        element("Position", *eye.tolist()),
        element("Up", *(upward / CENTIMETRES_PER_METRE).tolist()),
        element("LookAt", *target.tolist()),
        properties(*rows),
    ]
    document.add("NodeAttribute", camera.name, "Camera", about, within=key)
