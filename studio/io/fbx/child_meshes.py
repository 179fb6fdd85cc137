"""Meshes of an FBX file as plain arrays, read in the child process of ``child``."""

from typing import Any

import numpy as np

from studio.io.fbx.objects import FloatArray, all_of, keep, matrix_of, numbers_of

MOST_FBX_CORNERS = 4_000_000


def meshes_of(nodes: list[Any], joints: dict[int, int]) -> tuple[list[dict[str, Any]], dict[str, FloatArray]]:
    """Record of each mesh of the nodes, and arrays of the meshes by number and name.

    ``joints`` are by the ids of their nodes. Vertices are in the bind pose; ``carrier`` is the joint to which a whole
    mesh is attached, -1 for a skinned one. ``bind`` (J, 3, 4) are the joints in the bind pose, NaN if unknown.
    """
    told: list[dict[str, Any]] = []
    arrays: dict[str, FloatArray] = {"bind": np.full((len(joints), 3, 4), np.nan)}
    carriers: dict[int, int] = {}
    for node, above in nodes:
        carriers[node.typed_id] = joints.get(node.typed_id, carriers.get(above, -1))
        mesh = keep(node.mesh)
        if mesh is None or not mesh.num_faces or mesh.num_indices > MOST_FBX_CORNERS:
            continue
        number = len(told)
        weights, to_world = _weights(mesh, joints, arrays["bind"])
        if to_world is None:
            to_world = matrix_of(node.geometry_to_world)
        parts = {"to_world": to_world, "weights": weights, **_corners(mesh)}
        arrays |= {f"{number} {name}": array for name, array in parts.items()}
        materials = [_material(each, arrays, f"{number} {index}") for index, each in enumerate(all_of(mesh.materials))]
        carrier = -1 if len(weights) else carriers[node.typed_id]
        told.append({"name": node.name, "carrier": carrier, "materials": materials})
    return told, arrays


def clustered(nodes: list[Any]) -> set[int]:
    """Ids of the nodes to which any skin is bound."""
    meshes = [mesh for node in nodes if (mesh := keep(node.mesh)) is not None]
    skins = [skin for mesh in meshes for skin in all_of(mesh.skin_deformers)]
    bones = [keep(cluster.bone_node) for skin in skins for cluster in all_of(skin.clusters)]
    return {bone.typed_id for bone in bones if bone is not None}


def _weights(mesh: Any, joints: dict[int, int], bind: FloatArray) -> tuple[FloatArray, FloatArray | None]:
    """Table (W, 3) of vertex, joint and weight; and the mesh's transform in the bind pose, None without a skin."""
    rows, to_world = [np.empty((0, 3))], None
    for cluster in [each for skin in all_of(mesh.skin_deformers)[:1] for each in all_of(skin.clusters)]:
        bone = keep(cluster.bone_node)
        if bone is None or bone.typed_id not in joints:
            continue
        joint, bound = joints[bone.typed_id], matrix_of(cluster.bind_to_world)
        bind[joint] = bound
        if to_world is None:
            square = np.vstack([matrix_of(cluster.geometry_to_bone), [0.0, 0.0, 0.0, 1.0]])
            to_world = bound @ square
        vertices, weights = numbers_of(cluster.vertices), numbers_of(cluster.weights)
        if vertices:
            rows.append(np.column_stack([vertices, np.full(len(vertices), joint), weights]))
    return np.concatenate(rows), to_world


def _corners(mesh: Any) -> dict[str, FloatArray]:
    """Values of vertices, normals and texture coordinates, and the index of each for every corner of the faces."""
    normals, coordinates = keep(mesh.vertex_normal), keep(mesh.vertex_uv)
    found = {"vertices": np.array(numbers_of(mesh.vertices), dtype=np.float64).reshape(-1, 3)}
    corners = [numbers_of(mesh.vertex_indices)]
    for name, wide, attribute in (("normals", 3, normals), ("coordinates", 2, coordinates)):
        values = numbers_of(attribute.values) if attribute.exists else []
        found[name] = np.array(values, dtype=np.float64).reshape(-1, wide)
        corners.append(numbers_of(attribute.indices) if values else [0] * len(corners[0]))
    found["corners"] = np.array(corners, dtype=np.float64).T
    faces, materials = numbers_of(mesh.faces), numbers_of(mesh.face_material)
    sizes = [face.num_indices for face in faces]
    found["faces"] = np.array([[face.index_begin for face in faces], sizes, materials or [0] * len(faces)], float).T
    return found


def _material(material: Any, arrays: dict[str, FloatArray], key: str) -> dict[str, Any]:
    """Record of a material: name, colour and pictures, which are inside the file or named by it."""
    kinds = keep(material.fbx), keep(material.pbr)
    colour, base = keep(kinds[0].diffuse_color), keep(kinds[1].base_color)
    texture = keep(base.texture) or keep(colour.texture)
    shown = keep(colour.value_vec4)
    told: dict[str, Any] = {"name": material.name, "colour": [shown.x, shown.y, shown.z], "picture": ""}
    told["maps"] = {}
    slots = {
        "normal": keep(kinds[0].normal_map),
        "emissive": keep(kinds[0].emission_color),
        "metallic": keep(kinds[0].reflection_factor),
        "roughness": keep(kinds[0].specular_exponent),
    }
    for name, slot in {"picture": None, **slots}.items():
        found = texture if slot is None else keep(slot.texture)
        if found is None:
            continue
        content, file_name = keep(found.content), found.relative_filename or found.filename or ""
        if content:
            arrays[f"{key} {name}"] = np.frombuffer(bytes(content), np.uint8)
        if slot is None:
            told["picture"] = file_name
        else:
            told["maps"][name] = file_name
    light, strength = keep(kinds[0].emission_color), keep(kinds[0].emission_factor)
    if light.has_value or told["maps"].get("emissive"):
        scale = strength.value_real if strength.has_value else 1.0
        emitted = keep(light.value_vec4)
        told["emission"] = [scale * emitted.x, scale * emitted.y, scale * emitted.z]
    return told
