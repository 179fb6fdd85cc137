"""A Blender add-on: armatures follow the bodies that a running Morpho Studio streams, while one edits there.

Install it in *Edit > Preferences > Add-ons > Install from Disk*. In the studio, *Play > Stream characters as VMC* sends
the first body to port 39539 of this computer, the second to 39540, and so on. In Blender, select an armature, enter
its port in the sidebar of the 3D view (N, *Morpho*), and press *Follow*. Bones are found by the names of Mixamo,
Unreal, VRM, HumanIK and Blender's own rigs; the rest pose may be a T-pose, an A-pose, or one with hanging arms.

VMC sends for each bone its rotation in its parent against a T-pose, in Unity's axes (x right, y up, z forward,
left-handed); Blender's characters face -Y with their left on +X.
"""

import re
import socket
import struct
from collections.abc import Iterator, Mapping
from contextlib import suppress

import bpy
from mathutils import Quaternion, Vector

bl_info = {
    "name": "Morpho Studio live",
    "author": "Morpho Studio authors",
    "version": (1, 0, 0),
    "blender": (4, 2, 0),
    "location": "3D View > Sidebar > Morpho",
    "description": "Armatures follow the bodies that Morpho Studio streams by VMC",
    "category": "Animation",
}

PORT, EVERY, LARGEST = 39539, 1.0 / 60.0, 65536
BONE_ADDRESS = "/VMC/Ext/Bone/Pos"
ARMS = {"Shoulder": ("shoulder", "clavicle"), "UpperArm": ("upperarm", "arm"), "LowerArm": ("lowerarm", "forearm"),
        "Hand": ("hand",)}  # fmt: skip
LEGS = {"UpperLeg": ("upperleg", "upleg", "thigh"), "LowerLeg": ("lowerleg", "leg", "calf", "shin"), "Foot": ("foot",),
        "Toes": ("toes", "toebase", "toe", "ball")}  # fmt: skip
TRUNK = {"Hips": ("hips", "pelvis"), "Spine": ("spine", "spine01"), "Chest": ("chest", "spine1", "spine02"),
         "UpperChest": ("upperchest", "spine2", "spine03"), "Neck": ("neck", "neck01"), "Head": ("head",)}  # fmt: skip
FINGERS = {}
for _digit, _words in {"Thumb": ("thumb",), "Index": ("index",), "Middle": ("middle", "mid"), "Ring": ("ring",),
                       "Little": ("little", "pinky")}.items():  # fmt: skip
    for _number, _bone in enumerate(("Proximal", "Intermediate", "Distal"), 1):
        FINGERS[f"{_digit}{_bone}"] = tuple(
            pattern.format(word=_word, n=_number)
            for _word in _words
            for pattern in ("hand{word}{n}", "{word}0{n}", "{word}{n}", "f{word}0{n}", "{word}" + _bone.lower())
        )
PARENTS = {"Spine": "Hips", "Chest": "Spine", "UpperChest": "Chest", "Neck": "UpperChest", "Head": "Neck"}
for _side in ("Left", "Right"):
    for _chain, _top in ((tuple(ARMS), "UpperChest"), (tuple(LEGS), "Hips")):
        for _above, _name in zip((None, *_chain), _chain, strict=False):
            PARENTS[f"{_side}{_name}"] = f"{_side}{_above}" if _above else _top
    for _place, _name in enumerate(FINGERS):
        PARENTS[f"{_side}{_name}"] = f"{_side}{tuple(FINGERS)[_place - 1] if _place % 3 else 'Hand'}"


def messages(packet: bytes) -> Iterator[tuple[str, list[object]]]:
    """Address and arguments of every OSC message in a packet; raises ValueError or struct.error for a damaged one."""
    if packet.startswith(b"#bundle\0"):
        place = 16
        while place + 4 <= len(packet):
            (size,) = struct.unpack_from(">i", packet, place)
            yield from messages(packet[place + 4 : place + 4 + size])
            place += 4 + size
        return
    address, place = _text(packet, 0)
    kinds, place = _text(packet, place)
    values: list[object] = []
    for kind in kinds[1:]:
        if kind == "s":
            word, place = _text(packet, place)
            values.append(word)
        else:
            values += struct.unpack_from(f">{kind}", packet, place)
            place += 4
    yield address, values


def _text(packet: bytes, index: int) -> tuple[str, int]:
    end = packet.index(b"\0", index)
    return packet[index:end].decode("ascii"), index + 4 * ((end - index) // 4 + 1)  # padded to a multiple of four


def bones_in(packet: bytes) -> dict[str, tuple[Vector, Quaternion]]:
    """Location and rotation of every bone of a packet in its parent, in axes of a character that faces -Y."""
    found = {}
    for address, values in messages(packet):
        if address == BONE_ADDRESS and len(values) == 8:
            name, x, y, z, a, b, c, w = values
            found[name] = Vector((-x, -z, y)), Quaternion((w, a, c, -b))
    return found


def matched(armature: bpy.types.Object) -> dict[str, str]:
    """The armature's bone for each of VMC's, by names."""
    plain = {_plain(bone.name): bone.name for bone in reversed(armature.data.bones)}
    found = {}
    for name, words in TRUNK.items():
        found[name] = next((plain["", word] for word in words if ("", word) in plain), None)
    for side in ("Left", "Right"):
        for name, words in {**ARMS, **LEGS, **FINGERS}.items():
            keys = ((side[0].lower(), word) for word in words)
            found[f"{side}{name}"] = next((plain[key] for key in keys if key in plain), None)
    return {name: bone for name, bone in found.items() if bone}


def _plain(name: str) -> tuple[str, str]:
    """Side, ``l``, ``r`` or nothing, and the rest in lower case: ``mixamorig:LeftArm`` is ``l``, ``arm``."""
    rest = name.rpartition(":")[2]
    rest = re.sub(r"^(DEF-|J_Bip_C_|J_Bip_(?=[LR]_))", "", rest)
    for pattern in (r"^(left|right)[_. ]?(.+)$", r"^(l|r)[_. ](.+)$"):
        if ahead := re.match(pattern, rest, re.IGNORECASE):
            return ahead[1][0].lower(), re.sub(r"[_. ]", "", ahead[2]).lower()
    if behind := re.match(r"^(.+?)[_.](l|r|left|right)$", rest, re.IGNORECASE):
        return behind[2][0].lower(), re.sub(r"[_. ]", "", behind[1]).lower()
    return "", re.sub(r"[_. ]", "", rest).lower()


def to_t_pose(armature: bpy.types.Object, bones: Mapping[str, str]) -> dict[str, Quaternion]:
    """For each of VMC's bones the turn, in world axes, from the armature's rest pose to a T-pose."""
    world = armature.matrix_world.to_quaternion()
    turns = {name: Quaternion() for name in bones}
    for side, outward in (("Left", 1.0), ("Right", -1.0)):
        aims = dict.fromkeys(("UpperArm", "LowerArm", "Hand"), Vector((outward, 0.0, 0.0)))
        aims |= dict.fromkeys(("UpperLeg", "LowerLeg"), Vector((0.0, 0.0, -1.0)))
        ends = {"UpperArm": "LowerArm", "LowerArm": "Hand", "UpperLeg": "LowerLeg", "LowerLeg": "Foot"}
        for name, aim in aims.items():
            if (own := bones.get(f"{side}{name}")) is None:
                continue
            bone, end = armature.data.bones[own], bones.get(f"{side}{ends.get(name)}")
            tip = armature.data.bones[end].head_local if end else bone.tail_local
            turns[f"{side}{name}"] = (world @ (tip - bone.head_local)).rotation_difference(aim)
        hand = turns.get(f"{side}Hand", Quaternion())
        for index, name in enumerate(FINGERS):
            if (own := bones.get(f"{side}{name}")) is None:
                continue
            bone, end = (
                armature.data.bones[own],
                None if index % 3 == 2 else bones.get(f"{side}{[*FINGERS][index + 1]}"),
            )
            tip = armature.data.bones[end].head_local if end else bone.tail_local
            along = hand @ (world @ (tip - bone.head_local))
            straight = Vector((along.x, along.y, 0.0))  # in the plane of the palm; thumbs are as at rest
            turns[f"{side}{name}"] = (Quaternion() if index < 3 else along.rotation_difference(straight)) @ hand
    return turns


def follow(armature: bpy.types.Object, received: Mapping[str, tuple[Vector, Quaternion]]) -> None:
    """Pose an armature as the bones that were received, and put its hips where they are."""
    bones = matched(armature)
    rest = to_t_pose(armature, bones)
    world = armature.matrix_world.to_quaternion()
    turned: dict[str, Quaternion] = {}
    for name, parent in {"Hips": "", **PARENTS}.items():
        own = received[name][1] if name in received else Quaternion()
        turned[name] = turned[parent] @ own if parent else own
    for name, bone_name in bones.items():
        if name not in received and name.removeprefix("Left").removeprefix("Right") in FINGERS:
            continue  # nobody captured them
        bone, above = armature.pose.bones[bone_name], PARENTS.get(name, "")
        while above and above not in bones:
            above = PARENTS.get(above, "")
        # Both turns from the rest pose, in the armature's axes; what lies between the two bones stays as at rest.
        whole, carried = (
            world.inverted() @ turned[each] @ rest[each] @ world if each else Quaternion() for each in (name, above)
        )
        axes = bone.bone.matrix_local.to_quaternion()
        bone.rotation_mode = "QUATERNION"
        bone.rotation_quaternion = axes.inverted() @ carried.inverted() @ whole @ axes
    if "Hips" in received and "Hips" in bones:
        hips = armature.pose.bones[bones["Hips"]]
        moved = armature.matrix_world.inverted() @ received["Hips"][0] - hips.bone.head_local
        hips.location = hips.bone.matrix_local.to_3x3().inverted() @ moved


class MorphoLink:
    """The sockets of all armatures that follow, read by one timer."""

    def __init__(self) -> None:
        self.sockets: dict[str, socket.socket] = {}

    def start(self, armature: bpy.types.Object) -> None:
        """Listen on the armature's port; raises OSError where another program does."""
        self.stop(armature.name)
        listening = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        listening.setblocking(False)
        listening.bind(("127.0.0.1", armature.morpho_port))
        self.sockets[armature.name] = listening
        if not bpy.app.timers.is_registered(read_packets):
            bpy.app.timers.register(read_packets, persistent=True)

    def stop(self, name: str) -> None:
        """Listen no more for an armature."""
        if name in self.sockets:
            self.sockets.pop(name).close()

    def read(self) -> float | None:
        """Pose every armature as the newest packets say; seconds until the next time."""
        for name, listening in list(self.sockets.items()):
            armature, received = bpy.data.objects.get(name), {}
            if armature is None:
                self.stop(name)
                continue
            while packet := self._next(listening):
                with suppress(ValueError, struct.error):  # a packet of another program
                    received |= bones_in(packet)
            if received:
                follow(armature, received)
        return EVERY if self.sockets else None

    def _next(self, listening: socket.socket) -> bytes:
        """The next packet; empty when there is none."""
        try:
            return listening.recv(LARGEST)
        except BlockingIOError:
            return b""


LINK = MorphoLink()


def read_packets() -> float | None:
    """Blender's timer, which it knows by this one function: a method would be another object at each use."""
    return LINK.read()


class MorphoFollow(bpy.types.Operator):
    """Let the active armature follow the body that is streamed to its port, or stop it."""

    bl_idname = "object.morpho_follow"
    bl_label = "Follow"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.object is not None and context.object.type == "ARMATURE"

    def execute(self, context: bpy.types.Context) -> set[str]:
        armature = context.object
        if armature.name in LINK.sockets:
            LINK.stop(armature.name)
            return {"FINISHED"}
        if "Hips" not in matched(armature):
            self.report({"ERROR"}, "No bone of this armature is called hips or pelvis: rename its bones.")
            return {"CANCELLED"}
        try:
            LINK.start(armature)
        except OSError as error:
            self.report({"ERROR"}, f"Port {armature.morpho_port} cannot be heard: {error.strerror}. Choose another.")
            return {"CANCELLED"}
        return {"FINISHED"}


class MorphoPanel(bpy.types.Panel):
    """Port and switch of the active armature."""

    bl_label = "Morpho Studio"
    bl_idname = "VIEW3D_PT_morpho"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Morpho"

    def draw(self, context: bpy.types.Context) -> None:
        armature = context.object
        if armature is None or armature.type != "ARMATURE":
            self.layout.label(text="Select an armature")
            return
        self.layout.prop(armature, "morpho_port")
        follows = armature.name in LINK.sockets
        self.layout.operator("object.morpho_follow", text="Stop" if follows else "Follow", depress=follows)


def register() -> None:
    """Called by Blender."""
    bpy.types.Object.morpho_port = bpy.props.IntProperty(name="Port", default=PORT, min=1024, max=65535)
    bpy.utils.register_class(MorphoFollow)
    bpy.utils.register_class(MorphoPanel)


def unregister() -> None:
    """Called by Blender."""
    for name in list(LINK.sockets):
        LINK.stop(name)
    if bpy.app.timers.is_registered(read_packets):
        bpy.app.timers.unregister(read_packets)
    bpy.utils.unregister_class(MorphoPanel)
    bpy.utils.unregister_class(MorphoFollow)
    del bpy.types.Object.morpho_port
