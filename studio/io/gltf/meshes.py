"""Meshes of a glTF file as pieces of a figure, in a given pose of its nodes."""

from collections.abc import Mapping

import numpy as np

from studio.core.errors import StudioError
from studio.core.mesh.appearance import Material
from studio.core.names import counted_noun
from studio.io.figure.figure import MOST_VERTICES, MeshPiece
from studio.io.gltf.accessors import Accessors, FloatArray, IntArray
from studio.io.gltf.container import GltfFile
from studio.io.gltf.materials import Materials
from studio.io.gltf.nodes import Nodes
from studio.io.json_record import Record
from studio.io.meshes.shapes import smooth_normals

_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_Skins = list[tuple[list[int], FloatArray]]


class MeshReader:
    """Reader of the meshes of all nodes; ``repairs`` lists omissions."""

    def __init__(self, file: GltfFile, accessors: Accessors, nodes: Nodes, skins: _Skins) -> None:
        self.materials = Materials(file, accessors)
        self._file, self._accessors, self._nodes, self._skins = file, accessors, nodes, skins
        self._meshes = file.root.records("meshes")
        self._shown = _shown_nodes(file.root, nodes)
        self._vertices = 0
        self.repairs = self.materials.repairs

    def pieces(self, world: FloatArray, places: Mapping[int, int]) -> list[MeshPiece]:
        """Pieces of all meshes with the nodes at ``world`` (N, 4, 4); ``places`` gives the figure's joint
        of each node.
        """
        self._vertices = 0
        pieces = []
        for node in self._shown:
            record = self._nodes.records[node]
            mesh = record.index("mesh", len(self._meshes))
            skin = record.index("skin", len(self._skins))
            if mesh is None:
                continue
            for primitive in self._meshes[mesh].records("primitives"):
                piece = self._piece(primitive, node, skin, world, places)
                if piece is not None:
                    pieces.append(piece)
        return pieces

    def _piece(
        self, record: Record, node: int, skin: int | None, world: FloatArray, places: Mapping[int, int]
    ) -> MeshPiece | None:
        attributes = record.inner("attributes")
        index = attributes.index("POSITION", self._accessors.count)
        mode = record.whole("mode", _TRIANGLES)
        if index is None or mode not in (_TRIANGLES, _STRIP, _FAN):
            return None
        vertices = self._accessors.numbers(index, 3)
        self._vertices += len(vertices)
        if self._vertices > MOST_VERTICES:
            raise StudioError(
                f"{self._file.path.name} shows more than {MOST_VERTICES:,} vertices. Simplify its meshes."
            )
        triangles = self._triangles(record, mode, len(vertices))
        if not len(triangles):
            return None
        normals = self._attribute(attributes, "NORMAL", 3, len(vertices))
        if normals is None:
            normals = smooth_normals(vertices, triangles)
        rigid = skin is None or "JOINTS_0" not in attributes
        if skin is None or rigid:
            joints, weights = self._hung(node, places, len(vertices))
            forms = np.broadcast_to(world[node], (len(vertices), 4, 4))
        else:
            joints, weights, forms = self._bound(attributes, skin, world, places, len(vertices))
        material, coordinates = self._look(record, attributes, len(vertices))
        turned = np.einsum("vij,vj->vi", forms[:, :3, :3], normals)
        name = self._nodes.records[node].text("name")
        stood = np.einsum("vij,vj->vi", forms[:, :3, :3], vertices) + forms[:, :3, 3]
        if np.linalg.det(forms[0, :3, :3]) < 0.0:
            triangles = triangles[:, ::-1]
        return MeshPiece(stood, turned, coordinates, triangles, joints, weights, material, rigid, name)

    def _look(self, record: Record, attributes: Record, count: int) -> tuple[Material | None, FloatArray]:
        index = record.index("material", self.materials.count)
        if index is None:
            return None, np.zeros((count, 2))
        material, placing = self.materials[index]
        coordinates = self._attribute(attributes, f"TEXCOORD_{placing.set}", 2, count)
        return material, np.zeros((count, 2)) if coordinates is None else placing.applied_to(coordinates)

    def _attribute(self, attributes: Record, name: str, width: int, count: int) -> FloatArray | None:
        index = attributes.index(name, self._accessors.count)
        if index is None:
            return None
        array = self._accessors.numbers(index, width)
        if len(array) != count:
            raise StudioError(f"{attributes.where}: {name} has {len(array)} entries for {count} vertices.")
        return array

    def _hung(self, node: int, places: Mapping[int, int], count: int) -> tuple[IntArray, FloatArray]:
        """Joints and weights of a mesh that is attached as a whole to the nearest joint above."""
        joint = self._nodes.nearest(node, set(places))
        return np.full((count, 1), places[joint] if joint is not None else 0), np.ones((count, 1))

    def _bound(
        self, attributes: Record, skin: int, world: FloatArray, places: Mapping[int, int], count: int
    ) -> tuple[IntArray, FloatArray, FloatArray]:
        """Joints and weights of each vertex, and the blended matrix from its mesh to the world."""
        nodes, inverse_binds = self._skins[skin]
        joints, weights = [], []
        for place in range(4):
            index = attributes.index(f"JOINTS_{place}", self._accessors.count)
            shares = self._attribute(attributes, f"WEIGHTS_{place}", 4, count)
            if index is None or shares is None:
                break
            joints.append(self._accessors.indices(index, 4, len(nodes)))
            weights.append(np.maximum(shares, 0.0))
            if len(joints[-1]) != count:
                raise StudioError(f"{attributes.where}: JOINTS_{place} does not fit its {count} vertices.")
        if not joints:
            raise StudioError(f"{attributes.where}: it has joints without weights. Export the file again.")
        chosen, shares = np.concatenate(joints, axis=1), np.concatenate(weights, axis=1)
        lost = shares.sum(axis=1) < 1e-6
        if lost.any():
            vertices = counted_noun(int(np.count_nonzero(lost)), "vertex", "vertices")
            self.repairs.append(f"{vertices} had no weight; the first joint moves them.")
            shares[lost, 0] = 1.0
        shares /= shares.sum(axis=1, keepdims=True)
        motions = world[nodes] @ inverse_binds
        forms = np.zeros((count, 4, 4))
        for column in range(chosen.shape[1]):
            forms += shares[:, column, None, None] * motions[chosen[:, column]]
        return np.array([places[node] for node in nodes])[chosen], shares, forms

    def _triangles(self, record: Record, mode: int, count: int) -> IntArray:
        index = record.index("indices", self._accessors.count)
        row = np.arange(count) if index is None else self._accessors.indices(index, 1, max(count, 1))[:, 0]
        if len(row) > 12 * MOST_VERTICES:
            raise StudioError(
                f"{self._file.path.name} shows more triangles than the studio takes. Simplify its meshes."
            )
        if mode == _TRIANGLES:
            return row[: len(row) // 3 * 3].reshape(-1, 3)
        if len(row) < 3:
            return np.empty((0, 3), np.int64)
        if mode == _FAN:
            return np.column_stack([np.full(len(row) - 2, row[0]), row[1:-1], row[2:]])
        strip = np.column_stack([row[:-2], row[1:-1], row[2:]])
        strip[1::2] = strip[1::2, ::-1]
        return strip


def _shown_nodes(root: Record, nodes: Nodes) -> list[int]:
    """Nodes of the file's default scene, or all of them without one."""
    scenes = root.records("scenes")
    chosen = root.index("scene", len(scenes))
    if chosen is None and scenes:
        chosen = 0
    if chosen is None:
        return list(nodes.order)
    shown = set(scenes[chosen].indices("nodes", len(nodes.parents)))
    for node in nodes.order:
        if nodes.parents[node] in shown:
            shown.add(node)
    return [node for node in nodes.order if node in shown]
