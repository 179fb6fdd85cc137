"""Run by Blender's Python, see ``blender``: import a file and write where everything is in every frame.

Blender has Z up and faces -Y where the studio faces X: what is written is turned into the studio's axes. USD keeps
its own.
"""

import json
import sys
from pathlib import Path

import bpy
import numpy as np

FROM_BLENDER = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


def opened(source: str) -> None:
    match Path(source).suffix.lower():
        case ".fbx":
            bpy.ops.import_scene.fbx(filepath=source, use_anim=True, ignore_leaf_bones=False, anim_offset=0.0)
        case ".glb" | ".gltf":
            bpy.ops.import_scene.gltf(filepath=source, guess_original_bind_pose=True)
        case _:
            bpy.ops.wm.usd_import(filepath=source)


def move_as(other: str) -> None:
    """Let the one armature move as that of another file."""
    [own] = [item for item in bpy.data.objects if item.type == "ARMATURE"]
    before = set(bpy.data.objects)
    opened(other)
    added = [item for item in bpy.data.objects if item not in before]
    [moving] = [item for item in added if item.type == "ARMATURE"]
    own.animation_data_create()
    own.animation_data.action = moving.animation_data.action
    own.animation_data.action_slot = moving.animation_data.action_slot
    for item in added:
        bpy.data.objects.remove(item)


def main(source: str, target: str, frames: int, rate: float, other: str) -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.fps = round(rate)  # a glTF file says seconds
    to_studio = np.eye(3) if ".usd" in Path(source).suffix else FROM_BLENDER
    opened(source)
    if other:
        move_as(other)
    found: dict[str, dict[str, dict[str, list[np.ndarray]]]] = {"armatures": {}, "meshes": {}, "objects": {}}
    names = {}
    scene = bpy.context.scene
    for frame in range(frames):
        scene.frame_set(frame)
        graph = bpy.context.evaluated_depsgraph_get()
        for item in bpy.data.objects:
            world = np.array(item.matrix_world)
            if item.type == "ARMATURE":
                record = found["armatures"].setdefault(item.name, {"heads": [], "rotations": []})
                names[item.name] = [bone.name for bone in item.pose.bones]
                posed = [world @ np.array(bone.matrix) for bone in item.pose.bones]
                bound = [world @ np.array(bone.bone.matrix_local) for bone in item.pose.bones]
                record["heads"].append(np.array([to_studio @ each[:3, 3] for each in posed]))
                record["rotations"].append(
                    np.array(
                        [
                            to_studio @ turn(now) @ turn(then).T @ to_studio.T
                            for now, then in zip(posed, bound, strict=True)
                        ]
                    )
                )
            elif item.type == "MESH":
                mesh = item.evaluated_get(graph).to_mesh()
                points = np.empty(3 * len(mesh.vertices), np.float32)
                mesh.vertices.foreach_get("co", points)
                record = found["meshes"].setdefault(item.name, {"vertices": []})
                placed = points.reshape(-1, 3) @ world[:3, :3].T + world[:3, 3]
                record["vertices"].append(placed @ to_studio.T)
            record = found["objects"].setdefault(item.name, {"places": []})
            record["places"].append(to_studio @ world[:3, 3])
    about = {
        kind: {name: {"arrays": list(record), "bones": names.get(name, [])} for name, record in records.items()}
        for kind, records in found.items()
    }
    about["rate"] = scene.render.fps / scene.render.fps_base
    about["cameras"] = {
        item.name: {
            "angle": item.data.angle_y,
            "parallel": item.data.type == "ORTHO",
            "axes": (to_studio @ turn(np.array(item.matrix_world))).T.tolist(),
        }
        for item in bpy.data.objects
        if item.type == "CAMERA"
    }
    arrays = {
        f"{kind} {name} {key}": np.array(values)
        for kind, records in found.items()
        for name, record in records.items()
        for key, values in record.items()
    }
    np.savez(target, about=json.dumps(about), **arrays)


def turn(matrix: np.ndarray) -> np.ndarray:
    """The rotation of a transform with one scale."""
    return matrix[:3, :3] / np.cbrt(np.linalg.det(matrix[:3, :3]))


main(sys.argv[1], sys.argv[2], int(sys.argv[3]), float(sys.argv[4]), sys.argv[5])
