"""Run by Blender's Python: an armature of given joints follows packets; the places of its bones are written.

``in_blender_live.py ADD_ON INPUT.npz OUTPUT.npz``
"""

import importlib.util
import socket
import sys
import time

import bpy
import numpy as np


def main(add_on: str, source: str, target: str) -> None:
    """Make the armature, let it follow, write heads (B, 3) in metres in the order of the names."""
    spec = importlib.util.spec_from_file_location("morpho_studio_live", add_on)
    live = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(live)
    live.register()
    given = np.load(source)
    names, heads, tails, parents = given["names"], given["heads"], given["tails"], given["parents"]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    data = bpy.data.armatures.new("rig")
    rig = bpy.data.objects.new("rig", data)
    bpy.context.collection.objects.link(rig)
    rig.rotation_euler = given["turned"].tolist()
    bpy.context.view_layer.update()
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    inside = rig.matrix_world.inverted()
    made = []
    for name, head, tail, parent in zip(names.tolist(), heads.tolist(), tails.tolist(), parents.tolist(), strict=True):
        bone = data.edit_bones.new(name)
        bone.head, bone.tail = inside @ live.Vector(head), inside @ live.Vector(tail)
        bone.roll = 0.3 * len(made)  # rigs of other programs have any
        bone.parent = made[parent] if parent >= 0 else None
        made.append(bone)
    bpy.ops.object.mode_set(mode="OBJECT")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        sender.bind(("127.0.0.1", 0))
        rig.morpho_port = sender.getsockname()[1]  # a port that is free once this socket is closed
    assert bpy.ops.object.morpho_follow() == {"FINISHED"}
    assert bpy.app.timers.is_registered(live.read_packets)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        for packet in (b"of another program", *map(bytes.fromhex, given["packets"].tolist())):
            sender.sendto(packet, ("127.0.0.1", rig.morpho_port))
    for _ in range(100):
        live.LINK.read()
        time.sleep(0.005)
    bpy.context.view_layer.update()
    found = [rig.matrix_world @ rig.pose.bones[name].head for name in names.tolist()]
    np.savez(target, heads=np.array(found))
    live.unregister()
    assert not bpy.app.timers.is_registered(live.read_packets)


if __name__ == "__main__":
    main(*sys.argv[1:])
