"""Nodes of a glTF file: a forest, and the transform of each node in it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError
from studio.core.rotations import from_matrix, to_matrix
from studio.io.json_record import Record
from studio.io.scene.proper_rotations import FLAT_DETERMINANT

FloatArray = NDArray[np.float64]

MOST_GLTF_NODES = 50_000


@dataclass(frozen=True, eq=False)
class Nodes:
    """Forest of N nodes: ``order`` has every parent before its children; ``parents`` is -1 for roots."""

    records: tuple[Record, ...]
    parents: tuple[int, ...]
    order: tuple[int, ...]
    local: FloatArray
    """Matrices (N, 4, 4) from node to parent."""
    world: FloatArray
    """Matrices (N, 4, 4) from node to the file's world."""

    def names(self) -> tuple[str, ...]:
        """Unique name for each node."""
        names: list[str] = []
        taken: dict[str, int] = {}
        for index, record in enumerate(self.records):
            name = record.text("name") or f"Node_{index}"
            taken[name] = taken.get(name, 0) + 1
            if taken[name] > 1:
                name = f"{name} ({index})"
            names.append(name)
        return tuple(names)

    def nearest(self, node: int, among: set[int]) -> int | None:
        """The node itself, or its nearest ancestor, that is one of ``among``; None without any."""
        while node >= 0:
            if node in among:
                return node
            node = self.parents[node]
        return None


def read_nodes(root: Record) -> Nodes:
    """All nodes. Raises StudioError if they are no forest or a transform has values that are no numbers."""
    records = root.records("nodes")
    if len(records) > MOST_GLTF_NODES:
        raise StudioError(
            f"{root.where} has {len(records):,} nodes; the studio takes {MOST_GLTF_NODES:,}. Simplify the file."
        )
    parents = [-1] * len(records)
    children = [record.indices("children", len(records)) for record in records]
    for node, below in enumerate(children):
        for child in below:
            if parents[child] >= 0 or child == node:
                raise StudioError(f"{records[child].where}: it has two parents or is its own. Export the file again.")
            parents[child] = node
    order = [node for node, parent in enumerate(parents) if parent < 0]
    for node in order:
        order += children[node]
    if len(order) < len(records):
        lost = min(set(range(len(records))) - set(order))
        raise StudioError(f"{records[lost].where}: its parents form a ring. Export the file again.")
    local = np.array([_local(record) for record in records]).reshape(-1, 4, 4)
    world = local.copy()
    for node in order:
        if parents[node] >= 0:
            world[node] = world[parents[node]] @ local[node]
    if not np.isfinite(world).all():
        raise StudioError(f"{root.where}: the transforms of its nodes are out of range.")
    return Nodes(tuple(records), tuple(parents), tuple(order), local, world)


def _local(record: Record) -> FloatArray:
    if "matrix" in record:
        return _matrix(record)
    move, turn, scale = node_parts(record)
    matrix = np.eye(4)
    matrix[:3, :3] = turn * scale
    matrix[:3, 3] = move
    return matrix


def node_parts(record: Record) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Translation (3,), rotation (3, 3) and scale (3,) from a node to its parent; a mirroring matrix has a
    scale of -1.
    """
    if "matrix" in record:
        matrix = _matrix(record)
        turn = orthogonal_axes(matrix[None, :3, :3])[0]
        side = -1.0 if np.linalg.det(turn) < 0.0 else 1.0
        return matrix[:3, 3], side * turn, side * np.linalg.norm(matrix[:3, :3], axis=0)
    turn = np.array(record.numbers("rotation", (0.0, 0.0, 0.0, 1.0)))
    length = float(np.linalg.norm(turn))
    if length < 1e-6:
        raise record.value_error("rotation", "a rotation, and not zero")
    move, scale = record.numbers("translation", (0.0, 0.0, 0.0)), record.numbers("scale", (1.0, 1.0, 1.0))
    return np.array(move), to_matrix(turn / length), np.array(scale)


def orthogonal_axes(matrices: FloatArray) -> FloatArray:
    """Rotations (N, 3, 3) of matrices with scale, mirrored where these mirror; zero for singular ones."""
    lengths = np.linalg.norm(matrices, axis=1, keepdims=True)
    axes = matrices / np.where(lengths > 1e-9, lengths, 1.0)
    determinants = np.linalg.det(axes)
    flat = np.abs(determinants) < FLAT_DETERMINANT
    sides = np.where(flat, 0.0, np.sign(determinants))[:, None, None]
    return sides * to_matrix(from_matrix(np.where(flat[:, None, None], np.eye(3), sides * axes)))


def _matrix(record: Record) -> FloatArray:
    return np.array(record.numbers("matrix", tuple(np.eye(4).ravel().tolist()))).reshape(4, 4).T
