"""Small character files of every format, made here: a stick figure of boxes that stands 1.7 m tall."""

import base64
import json
import struct
from typing import Any

import numpy as np

JOINTS: tuple[tuple[str, str | None, tuple[float, float, float]], ...] = (
    ("hips", None, (0.0, 0.95, 0.0)),
    ("spine", "hips", (0.0, 1.1, 0.0)),
    ("chest", "spine", (0.0, 1.3, 0.0)),
    ("neck", "chest", (0.0, 1.48, 0.0)),
    ("head", "neck", (0.0, 1.55, 0.0)),
    ("leftUpperArm", "chest", (0.18, 1.42, 0.0)),
    ("leftLowerArm", "leftUpperArm", (0.45, 1.42, 0.0)),
    ("leftHand", "leftLowerArm", (0.7, 1.42, 0.0)),
    ("rightUpperArm", "chest", (-0.18, 1.42, 0.0)),
    ("rightLowerArm", "rightUpperArm", (-0.45, 1.42, 0.0)),
    ("rightHand", "rightLowerArm", (-0.7, 1.42, 0.0)),
    ("leftUpperLeg", "hips", (0.1, 0.9, 0.0)),
    ("leftLowerLeg", "leftUpperLeg", (0.1, 0.5, 0.0)),
    ("leftFoot", "leftLowerLeg", (0.1, 0.08, 0.0)),
    ("leftToes", "leftFoot", (0.1, 0.02, 0.13)),
    ("rightUpperLeg", "hips", (-0.1, 0.9, 0.0)),
    ("rightLowerLeg", "rightUpperLeg", (-0.1, 0.5, 0.0)),
    ("rightFoot", "rightLowerLeg", (-0.1, 0.08, 0.0)),
    ("rightToes", "rightFoot", (-0.1, 0.02, 0.13)),
)
"""Name, parent, place: Y up, facing Z, as VRM names them."""
NAMES = [name for name, _, _ in JOINTS]
PLACES = np.array([place for _, _, place in JOINTS])
_HANIM = (
    *("humanoid_root", "vl5", "vt6", "vc4", "skullbase", "l_shoulder", "l_elbow", "l_wrist", "r_shoulder", "r_elbow"),
    *("r_wrist", "l_hip", "l_knee", "l_ankle", "l_metatarsal", "r_hip", "r_knee", "r_ankle", "r_metatarsal"),
)
HANIM = dict(zip(NAMES, _HANIM, strict=True))
_CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
_FACES = np.array(
    [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4],
     [1, 5, 7], [1, 7, 3]]
)  # fmt: skip
PIXEL = base64.b64decode(
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8z8Dwn4EIwDiqkL4KAcT9GO0U4BxoAAAAAElFTkSuQmCC"
)
"""A PNG of one pixel."""


def boxes(size: float = 0.04) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Vertices (V, 3), triangles (T, 3) and the joint of each vertex (V,): a box at every joint."""
    vertices = np.concatenate([place + size * _CORNERS for place in PLACES])
    vertices[:, 1] = np.maximum(vertices[:, 1], 0.0)
    triangles = np.concatenate([_FACES + 8 * place for place in range(len(PLACES))])
    return vertices, triangles, np.repeat(np.arange(len(PLACES)), 8)


class Gltf:
    """A skinned figure as glTF; change ``root`` and ``binary``, then ask for the file."""

    def __init__(self, vrm: int | None = None) -> None:
        self.binary = b""
        vertices, triangles, joints = boxes()
        shares = np.tile([255, 0, 0, 0], (len(joints), 1)).astype(np.uint8)
        inverse = np.tile(np.eye(4), (len(PLACES), 1, 1))
        inverse[:, :3, 3] = -PLACES
        self.root: dict[str, Any] = {"asset": {"version": "2.0"}, "bufferViews": [], "accessors": []}
        places = [
            self.add(vertices.astype("<f4"), "VEC3"),
            self.add(np.pad(joints[:, None], ((0, 0), (0, 3))).astype("<u2"), "VEC4"),
            self.add(shares, "VEC4", normalized=True),
            self.add(np.zeros((len(vertices), 2), "<f4"), "VEC2"),
            self.add(triangles.reshape(-1, 1).astype("<u2"), "SCALAR"),
            self.add(np.swapaxes(inverse, 1, 2).reshape(-1, 16).astype("<f4"), "MAT4"),
        ]
        attributes = dict(zip(("POSITION", "JOINTS_0", "WEIGHTS_0", "TEXCOORD_0"), places, strict=False))
        self.root |= {
            "nodes": [*self._nodes(), {"name": "body", "mesh": 0, "skin": 0}],
            "meshes": [{"primitives": [{"attributes": attributes, "indices": places[4], "material": 0}]}],
            "skins": [{"joints": list(range(len(JOINTS))), "inverseBindMatrices": places[5]}],
            "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
            "textures": [{"source": 0}],
            "images": [{"uri": "data:image/png;base64," + base64.b64encode(PIXEL).decode()}],
        }
        bones = [{"bone": name, "node": index} for index, name in enumerate(NAMES)]
        if vrm == 0:
            self.root["extensions"] = {"VRM": {"humanoid": {"humanBones": bones}}}
        if vrm == 1:
            by_name = {bone["bone"]: {"node": bone["node"]} for bone in bones}
            self.root["extensions"] = {"VRMC_vrm": {"humanoid": {"humanBones": by_name}}}

    def add(self, array: np.ndarray, kind: str, **more: Any) -> int:
        """An accessor over bytes of its own; its index."""
        codes = {"f4": 5126, "u1": 5121, "u2": 5123, "u4": 5125}
        self.root["bufferViews"].append({"buffer": 0, "byteOffset": len(self.binary), "byteLength": array.nbytes})
        accessor = {"bufferView": len(self.root["bufferViews"]) - 1, "count": len(array), "type": kind}
        self.root["accessors"].append({**accessor, "componentType": codes[array.dtype.str[1:]], **more})
        self.binary += array.tobytes() + b"\0" * (-array.nbytes % 4)
        return len(self.root["accessors"]) - 1

    def _nodes(self) -> list[dict[str, Any]]:
        nodes: list[dict[str, Any]] = []
        for index, (name, parent, at) in enumerate(JOINTS):
            above = NAMES.index(parent) if parent else None
            offset = np.array(at) - (PLACES[above] if above is not None else 0.0)
            nodes.append({"name": name, "translation": offset.tolist()})
            if above is not None:
                nodes[above].setdefault("children", []).append(index)
        return nodes

    def moving(self) -> "Gltf":
        """The same with an animation: the first joint travels, the last one turns."""
        times = self.add(np.arange(4, dtype="<f4").reshape(-1, 1) / 30.0, "SCALAR")
        path = self.add(np.linspace([0, 0, 0], [0.3, 0, 0.1], 4).astype("<f4"), "VEC3")
        turn = self.add(np.tile([0.0, 0.6, 0.0, 0.8], (4, 1)).astype("<f4"), "VEC4")
        targets = ({"node": 0, "path": "translation"}, {"node": len(JOINTS) - 1, "path": "rotation"})
        self.root["animations"] = [
            {
                "samplers": [{"input": times, "output": path}, {"input": times, "output": turn}],
                "channels": [{"sampler": index, "target": target} for index, target in enumerate(targets)],
            }
        ]
        return self

    def gltf(self) -> bytes:
        """JSON with its buffer in a data URI."""
        uri = "data:application/octet-stream;base64," + base64.b64encode(self.binary).decode()
        self.root.setdefault("buffers", [{"byteLength": len(self.binary), "uri": uri}])
        return json.dumps(self.root).encode()

    def glb(self) -> bytes:
        """One binary file."""
        self.root.setdefault("buffers", [{"byteLength": len(self.binary)}])
        text = json.dumps(self.root).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
        chunks += struct.pack("<II", len(self.binary), 0x004E4942) + self.binary
        return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def vrml(skinned: bool = True, header: str = "#VRML V2.0 utf8", more: str = "") -> str:
    """An H-Anim humanoid in the classic encoding: native nodes with a skin, or PROTO instances with segments."""
    joint, segment = ("HAnimJoint", "HAnimSegment") if skinned else ("Joint", "Segment")
    body = "\n".join(_vrml_joint(name, joint, segment, skinned) for name, parent, _ in JOINTS if parent is None)
    if not skinned:
        protos = "PROTO Joint [ exposedField SFVec3f center 0 0 0 exposedField MFNode children [] field SFString name"
        protos += ' "" ] { Transform { children IS children } }\nPROTO Segment [ exposedField MFNode children [] field'
        protos += ' SFString name "" ] { Group { children IS children } }\nPROTO Humanoid [ exposedField MFNode'
        protos += ' humanoidBody [] field SFString name "" ] { Group { children IS humanoidBody } }\n'
        return f'{header}\n{protos}{more}\nDEF Hero Humanoid {{ name "hero" humanoidBody [\n{body}\n] }}\n'
    vertices, triangles, _ = boxes()
    points = ", ".join(" ".join(f"{number:g}" for number in vertex) for vertex in vertices)
    index = " ".join(f"{a} {b} {c} -1" for a, b, c in triangles)
    return (
        f'{header}\n{more}\nDEF Hero HAnimHumanoid {{ name "hero" skeleton [\n{body}\n]\n'
        f"skinCoord DEF Points Coordinate {{ point [ {points} ] }}\n"
        "skin [ Shape { appearance Appearance { material Material { diffuseColor 0.2 0.4 0.6 } }\n"
        f"geometry IndexedFaceSet {{ coord USE Points coordIndex [ {index} ] }} }} ] }}\n"
    )


def _vrml_joint(name: str, joint: str, segment: str, skinned: bool) -> str:
    place = NAMES.index(name)
    x, y, z = PLACES[place]
    children = "\n".join(_vrml_joint(below, joint, segment, skinned) for below, parent, _ in JOINTS if parent == name)
    weights = ""
    if skinned:
        index = " ".join(str(8 * place + corner) for corner in range(8))
        weights = f"skinCoordIndex [ {index} ] skinCoordWeight [ {'1 ' * 8}]"
    else:
        shape = "Shape { geometry Box { size 0.08 0.08 0.08 } }"
        children = (
            f"{segment} {{ children Transform {{ translation {x} {max(y, 0.04)} {z} children {shape} }} }}\n{children}"
        )
    return f'{joint} {{ name "{HANIM[name]}" center {x} {y} {z} {weights} children [ {children} ] }}'


def x3d(before: str = "", inside: str = "", root: str = "HAnimHumanoid") -> str:
    """The same humanoid with its skin in XML."""
    vertices, triangles, _ = boxes()
    points = ", ".join(" ".join(f"{number:g}" for number in vertex) for vertex in vertices)
    index = " ".join(f"{a} {b} {c} -1" for a, b, c in triangles)
    body = "".join(_x3d_joint(name) for name, parent, _ in JOINTS if parent is None)
    again = "".join(f"<HAnimJoint USE='{HANIM[name]}' containerField='joints'/>" for name in NAMES)
    return (
        f"<?xml version='1.0' encoding='UTF-8'?>\n{before}\n<X3D version='4.0'><Scene>{inside}\n"
        f"<{root} DEF='Hero' name='hero'>\n{body}{again}\n"
        f"<Coordinate DEF='Points' containerField='skinCoord' point='{points}'/>\n"
        "<Shape containerField='skin'><Appearance><Material diffuseColor='0.2 0.4 0.6'/></Appearance>\n"
        f"<IndexedFaceSet coordIndex='{index}'><Coordinate USE='Points'/></IndexedFaceSet></Shape>\n"
        f"</{root}></Scene></X3D>\n"
    )


def _x3d_joint(name: str) -> str:
    place = NAMES.index(name)
    centre = " ".join(f"{number:g}" for number in PLACES[place])
    index = " ".join(str(8 * place + corner) for corner in range(8))
    container = " containerField='skeleton'" if place == 0 else ""
    children = "".join(_x3d_joint(below) for below, parent, _ in JOINTS if parent == name)
    return (
        f"<HAnimJoint DEF='{HANIM[name]}' name='{HANIM[name]}' center='{centre}'{container} skinCoordIndex='{index}'"
        f" skinCoordWeight='{'1 ' * 8}'>{children}</HAnimJoint>\n"
    )
