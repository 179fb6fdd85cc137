"""The child process that reads an FBX file: ``python -m studio.io.fbx_child IN.fbx OUT.npz``.

ufbx is written in C and the file may be anybody's, so it runs where a crash or an endless loop costs nothing. It
imports nothing of the studio, and hands back plain arrays; what goes wrong is one line on standard error.

In ufbx 0.0.5 an object that Python lets go of takes memory with it that others still need: ``_kept`` holds all of them,
nothing is collected, and the process ends without taking leave of them.
"""

import gc
import json
import os
import sys
import traceback
from pathlib import Path
from typing import Any

import numpy as np

MOST_VALUES = 1 << 27
MOST_JOINTS = 4096
MEMORY = 3 << 30
"""Bytes of addresses beside twenty times the file: what Python and NumPy reserve, and half a gigabyte."""


_kept: list[Any] = []


def _keep(thing: Any) -> Any:
    _kept.append(thing)
    return thing


def main(source: str, target: str) -> None:
    """Read the first animation of ``source`` and write it to ``target``."""
    import ufbx

    _limit_memory(Path(source).stat().st_size)
    gc.disable()
    scene = _keep(
        ufbx.load_file(
            source,
            ignore_geometry=True,
            ignore_embedded=True,
            load_external_files=False,
            inherit_mode_handling=ufbx.InheritModeHandling.COMPENSATE,
        )
    )
    nodes, parents = _skeleton(scene)
    if not nodes:
        sys.exit("it holds no joints")
    if len(nodes) > MOST_JOINTS:
        sys.exit(f"it holds {len(nodes)} joints, more than a body has")
    stack = max(_all(scene.anim_stacks), key=lambda each: each.time_end - each.time_begin, default=None)
    animation = _keep(stack.anim) if stack else None
    settings = _keep(scene.settings)
    rate = settings.frames_per_second or 30.0
    count = round((stack.time_end - stack.time_begin) * rate) + 1 if stack else 1
    if not 0 < count * len(nodes) * 10 < MOST_VALUES:
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
        "up_axis": _keep(settings.axes).up.name[-1],
        "animation": stack.name if stack else "",
    }
    rest = np.array([_values(node.local_transform) for node in nodes])
    np.savez(target, frames=frames, rest=rest, about=np.frombuffer(json.dumps(about).encode(), dtype=np.uint8))


def _limit_memory(size: int) -> None:
    """So that a file that lies about its sizes takes only this process."""
    try:
        import resource
    except ImportError:  # Windows has no such limit; time is limited there as here
        return
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY + 20 * size,) * 2)


def _skeleton(scene: Any) -> tuple[list[Any], list[int]]:
    """Bones and all that they hang from, parents first, with the place of each one's parent; without the root."""
    nodes: list[Any] = []
    parents: list[int] = []
    waiting = [(node, -1) for node in _all(_keep(scene.root_node).children)]
    while waiting:
        node, parent = waiting.pop()
        waiting += [(child, len(nodes)) for child in _all(node.children)]
        nodes.append(node)
        parents.append(parent)
    wanted = [_keep(node.bone) is not None for node in nodes]
    for place in range(len(nodes) - 1, -1, -1):
        if wanted[place] and parents[place] >= 0:
            wanted[parents[place]] = True
    places = {old: new for new, old in enumerate(place for place, kept in enumerate(wanted) if kept)}
    return [nodes[place] for place in places], [places.get(parents[place], -1) for place in places]


def _all(things: Any) -> list[Any]:
    """What one of ufbx's lists holds."""
    _keep(things)
    return [_keep(things[place]) for place in range(len(things))]


def _values(transform: Any) -> tuple[float, ...]:
    """Place, turn (x, y, z, w) and scale, as ten numbers."""
    place, turn, scale = transform.translation, transform.rotation, transform.scale
    return (place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w, scale.x, scale.y, scale.z)


def _run() -> int:
    try:
        main(*sys.argv[1:])
    except SystemExit as refusal:
        print(refusal, file=sys.stderr)
        return 1
    except Exception:  # noqa: BLE001 - whatever it is, its last line is told
        traceback.print_exc()
        return 1
    return 0


if __name__ == "__main__":
    code = _run()
    sys.stderr.flush()
    os._exit(code)
