"""Child process that reads an FBX file: ``python -m studio.io.fbx.child IN.fbx OUT.npz motion|figure|either``.

The library ufbx is written in C and files come from anywhere, so it runs in a process of its own, in which a crash or
an endless loop does no harm. The process imports only its own modules, and returns plain arrays; an error is one line
on standard error. Objects of ufbx are kept alive (``objects``), nothing is collected, and the process exits without
clean-up.
"""

import gc
import json
import sys
from typing import Any

import numpy as np

from studio.io.fbx.child_meshes import clustered, meshes_of
from studio.io.fbx.objects import all_of, keep, matrix_of
from studio.io.scene.child_run import MOST_FRAME_VALUES, run_child

MOST_FBX_JOINTS = 4096
_SHOWS_NOTHING = ("UNKNOWN", "EMPTY")
"""Kinds of nodes without mesh, camera or light."""


def main(source: str, target: str, what: str) -> None:
    """Read the longest animation of ``source``, or its figure, and write it to ``target``.

    ``what`` is ``motion``, ``figure``, or ``either``: the figure if a skin is bound to joints, else the motion.
    """
    import ufbx

    gc.disable()
    drawn = what != "motion"
    scene = keep(
        ufbx.load_file(
            source,
            ignore_geometry=not drawn,
            ignore_embedded=not drawn,
            load_external_files=False,
            inherit_mode_handling=ufbx.InheritModeHandling.COMPENSATE,
        )
    )
    everything = _nodes(scene)
    bound = clustered([node for node, _ in everything]) if drawn else set()
    nodes, parents = _skeleton(everything, bound)
    if not nodes and len(keep(scene.anim_curves)):
        nodes, parents = _skeleton(everything, _linked_empties(everything))
    if not nodes:
        sys.exit("it has no skeleton (bones). Rig its mesh first")
    if len(nodes) > MOST_FBX_JOINTS:
        sys.exit(f"it holds {len(nodes)} joints, more than a body has")
    if what == "figure" or bound:
        _write_figure(target, scene, everything, nodes, parents)
    else:
        _write_motion(target, scene, nodes, parents)


def _write_motion(target: str, scene: Any, nodes: list[Any], parents: list[int]) -> None:
    import ufbx

    stack = max(all_of(scene.anim_stacks), key=lambda each: each.time_end - each.time_begin, default=None)
    animation = keep(stack.anim) if stack else None
    settings = keep(scene.settings)
    rate = settings.frames_per_second or 30.0
    count = round((stack.time_end - stack.time_begin) * rate) + 1 if stack else 1
    if not 0 < count * len(nodes) * 10 < MOST_FRAME_VALUES:
        sys.exit(f"it says that it has {count} frames")
    frames = np.empty((count, len(nodes), 10))
    for frame in range(count):
        for joint, node in enumerate(nodes):
            moment = stack.time_begin + frame / rate if stack else 0.0
            # The function, for the method of the same name crashes in ufbx 0.0.5, as does ``Node.parent``.
            local = ufbx.evaluate_transform(animation, node, moment) if stack else node.local_transform
            frames[frame, joint] = _values(local)
    about = {
        "names": [node.name for node in nodes],
        "parents": parents,
        "frame_rate": rate,
        "unit_metres": settings.unit_meters,
        "up_axis": _axis(keep(settings.axes).up.name),
        "animation": stack.name if stack else "",
    }
    rest = np.array([_values(node.local_transform) for node in nodes])
    np.savez(target, frames=frames, rest=rest, about=np.frombuffer(json.dumps(about).encode(), dtype=np.uint8))


def _axis(name: str) -> str:
    """Name of an axis: ``Y`` for ``POSITIVE_Y``, ``-Z`` for ``NEGATIVE_Z``; Y if the file does not state it."""
    sign, _, axis = name.partition("_")
    return ("-" if sign == "NEGATIVE" else "") + (axis or "Y")


def _write_figure(target: str, scene: Any, everything: list[Any], nodes: list[Any], parents: list[int]) -> None:
    meshes, arrays = meshes_of(everything, {node.typed_id: index for index, node in enumerate(nodes)})
    settings = keep(scene.settings)
    about = {
        "names": [node.name for node in nodes],
        "parents": parents,
        "unit_metres": settings.unit_meters,
        "up_axis": _axis(keep(settings.axes).up.name),
        "moves": bool(len(keep(scene.anim_curves))),
        "meshes": meshes,
        "kind": "FBX",
        "bones": [keep(node.bone) is not None for node in nodes],
    }
    arrays["world"] = np.array([matrix_of(node.node_to_world) for node in nodes])
    np.savez(target, about=np.frombuffer(json.dumps(about).encode(), dtype=np.uint8), **arrays)  # type: ignore[arg-type]


def _nodes(scene: Any) -> list[tuple[Any, int]]:
    """All nodes except the root, parents first, each with the id of its parent, -1 for the root."""
    found: list[tuple[Any, int]] = []
    waiting = [(node, -1) for node in all_of(keep(scene.root_node).children)]
    while waiting:
        node, above = waiting.pop()
        waiting += [(child, node.typed_id) for child in all_of(node.children)]
        found.append((node, above))
    return found


def _skeleton(everything: list[tuple[Any, int]], also: set[int]) -> tuple[list[Any], list[int]]:
    """Bones, the nodes ``also``, and all their ancestors, with the index of each parent."""
    above = {node.typed_id: parent for node, parent in everything}
    wanted: set[int] = set()
    for node, _ in everything:
        place = node.typed_id if keep(node.bone) is not None or node.typed_id in also else -1
        while place >= 0 and place not in wanted:
            wanted.add(place)
            place = above[place]
    nodes = [node for node, _ in everything if node.typed_id in wanted]
    places = {node.typed_id: place for place, node in enumerate(nodes)}
    return nodes, [places.get(above[node.typed_id], -1) for node in nodes]


def _linked_empties(everything: list[tuple[Any, int]]) -> set[int]:
    """Ids of empty nodes with three empty ancestors: joints of programs that write no bones."""
    above = {node.typed_id: parent for node, parent in everything if keep(node.attrib_type).name in _SHOWS_NOTHING}
    return {place for place in above if above.get(above.get(above[place], -1), -1) in above}


def _values(transform: Any) -> tuple[float, ...]:
    """Position, rotation (x, y, z, w) and scale of a transform, as ten numbers."""
    place, turn, scale = transform.translation, transform.rotation, transform.scale
    return (place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w, scale.x, scale.y, scale.z)


if __name__ == "__main__":
    run_child(main)
