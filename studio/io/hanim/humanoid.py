"""Humanoid of a scene: joints by their centres, segments with their shapes, the skin with its weights."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree
from scipy.spatial.transform import Rotation

from studio.core.errors import StudioError
from studio.core.names import readable_name
from studio.io.figure.figure import MOST_FIGURE_JOINTS, MOST_VERTICES, Y_UP_AXES, Figure, MeshPiece
from studio.io.hanim.geometry import ShapeSurface, surface_of
from studio.io.hanim.looks import ShapeMaterials
from studio.io.hanim.scene import MOST_VISITS, SceneNode, walk

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

HUMANOID_NODES, JOINT_NODES = ("HAnimHumanoid", "Humanoid"), ("HAnimJoint", "Joint")
_BODY = ("skeleton", "humanoidBody")
_PLACED = ("Transform", "HAnimSite", "Site")
_MOST_INFLUENCES = 8
_SAME = 1e-9


def figure_of(scene: list[SceneNode], path: Path) -> Figure:
    """Humanoid with most joints, posed by its centres; StudioError if there is none."""
    humanoids = [node for node in walk(scene) if node.kind in HUMANOID_NODES]
    if not humanoids:
        raise StudioError(f"{path.name} shows no humanoid: no HAnimHumanoid or Humanoid is in it. Export one.")
    humanoid = max(humanoids, key=lambda node: sum(inner.kind in JOINT_NODES for inner in walk(_body_nodes(node))))
    return _Reader(humanoid, ShapeMaterials(path)).figure(path)


def _body_nodes(humanoid: SceneNode) -> list[SceneNode]:
    """Nodes of the body; XML without ``containerField`` has them among the children."""
    return humanoid.nodes(*_BODY) or humanoid.nodes("children")


@dataclass
class _Reader:
    """Reader of one humanoid, which collects its joints and mesh pieces."""

    humanoid: SceneNode
    looks: ShapeMaterials
    names: list[str] = field(default_factory=list)
    parents: list[int] = field(default_factory=list)
    positions: list[FloatArray] = field(default_factory=list)
    joints: list[SceneNode] = field(default_factory=list)
    pieces: list[MeshPiece] = field(default_factory=list)
    visits: int = 0
    vertices: int = 0

    def figure(self, path: Path) -> Figure:
        """Figure of the humanoid: its body is read first, then its skin."""
        whole = _matrix(self.humanoid)
        joints = [node for node in walk(_body_nodes(self.humanoid)) if node.kind in JOINT_NODES]
        if not joints:
            raise StudioError(
                f"{path.name}: its humanoid has no joints in 'skeleton' or 'humanoidBody'. Export it again."
            )
        centred = any(np.abs(node.vector("center", (0.0, 0.0, 0.0))).max() > _SAME for node in joints)
        self._walk(whole, centred)
        self._skin(whole)
        return Figure(
            name=readable_name(path.stem),
            source=path.name,
            joint_names=tuple(self.names),
            parents=tuple(self.parents),
            positions=np.array(self.positions).reshape(-1, 3),
            rotations=np.tile(np.eye(3), (len(self.names), 1, 1)),
            kind="X3D",
            to_studio=Y_UP_AXES,
            pieces=tuple(self.pieces),
            repairs=tuple(dict.fromkeys(self.looks.repairs)),
        )

    def _walk(self, whole: FloatArray, centred: bool) -> None:
        """Read the joints at their centres; translations move them only in files that store offsets there."""
        waiting = [(node, whole, -1) for node in reversed(_body_nodes(self.humanoid))]
        while waiting:
            node, matrix, joint = waiting.pop()
            self.visits += 1
            if self.visits > MOST_VISITS:
                raise StudioError(f"{node.where}: USE shows more than {MOST_VISITS:,} nodes. Simplify the file.")
            if node.kind in JOINT_NODES:
                matrix = matrix if centred else matrix @ _matrix(node)
                joint = self._add(node, matrix, joint)
            elif node.kind == "Shape":
                self._shape(node, matrix, max(joint, 0))
                continue
            elif node.kind in _PLACED or node.kind not in ("HAnimSegment", "Segment", "Group"):
                matrix = matrix @ _matrix(node)
            waiting += [(inner, matrix, joint) for inner in reversed(node.nodes("children"))]

    def _add(self, node: SceneNode, matrix: FloatArray, parent: int) -> int:
        if len(self.names) >= MOST_FIGURE_JOINTS:
            raise StudioError(
                f"{node.where}: it has more than {MOST_FIGURE_JOINTS:,} joints. Export only the figure's own."
            )
        name = node.text("name") or node.definition or f"joint {len(self.names)}"
        if name in self.names:
            name = f"{name} ({len(self.names)})"
        centre = node.vector("center", (0.0, 0.0, 0.0))
        self.names.append(name)
        self.parents.append(parent)
        self.positions.append(matrix[:3, :3] @ centre + matrix[:3, 3])
        self.joints.append(node)
        return len(self.names) - 1

    def _shape(self, node: SceneNode, matrix: FloatArray, joint: int) -> None:
        geometry = node.node("geometry")
        surface = surface_of(geometry) if geometry is not None else None
        if surface is not None:
            count = len(surface.vertices)
            self._put(node, surface, matrix, np.full((count, 1), joint), np.ones((count, 1)), True)

    def _put(
        self,
        node: SceneNode,
        surface: ShapeSurface,
        matrix: FloatArray,
        joints: IntArray,
        weights: FloatArray,
        rigid: bool,
    ) -> None:
        self.vertices += len(surface.vertices)
        if self.vertices > MOST_VERTICES:
            raise StudioError(f"{node.where}: there are more than {MOST_VERTICES:,} vertices. Simplify its meshes.")
        material = self.looks.material(node, surface.two_sided)
        determinant = np.linalg.det(matrix[:3, :3])
        if not np.isfinite(determinant) or abs(determinant) < 1e-18:
            return  # flattened to nothing
        triangles = surface.triangles if determinant > 0.0 else surface.triangles[:, ::-1]
        normals = surface.normals @ np.linalg.inv(matrix[:3, :3])
        vertices = surface.vertices @ matrix[:3, :3].T + matrix[:3, 3]
        self.pieces.append(
            MeshPiece(
                vertices, normals, surface.coordinates, triangles, joints, weights, material, rigid, node.definition
            )
        )

    def _skin(self, whole: FloatArray) -> None:
        """Read the shapes of ``skin``, whose points are weighted by the joints' skinCoordIndex."""
        shapes = [node for node in walk(self.humanoid.nodes("skin")) if node.kind == "Shape"]
        coord = self.humanoid.node("skinCoord")
        for shape in shapes:
            geometry = shape.node("geometry")
            surface = surface_of(geometry, smooth=True) if geometry is not None else None
            if geometry is None or surface is None:
                continue
            own = coord if coord is not None else geometry.node("coord")
            points = own.numbers("point", 3) if own is not None else np.empty((0, 3))
            if surface.points.max() >= len(points):
                raise StudioError(
                    f"{shape.where}: its skin has points that 'skinCoord' does not have. Export the file again."
                )
            joints, weights = self._weights(points, whole)
            self._put(shape, surface, whole, joints[surface.points], weights[surface.points], False)

    def _weights(self, points: FloatArray, whole: FloatArray) -> tuple[IntArray, FloatArray]:
        """Joints and weights (P, n) of each point of the skin; the nearest joint for a point that no joint names."""
        if len(points) > MOST_VERTICES:
            raise StudioError(f"{self.humanoid.where}: its skin has more than {MOST_VERTICES:,} points. Simplify it.")
        found: list[list[tuple[float, int]]] = [[] for _ in points]
        total = 0
        for joint, node in enumerate(self.joints):
            index = node.numbers("skinCoordIndex")[:, 0].astype(np.int64)
            shares = node.numbers("skinCoordWeight")[:, 0]
            total += len(index)
            if total > _MOST_INFLUENCES * MOST_VERTICES:
                raise StudioError(
                    f"{node.where}: the skin has more weights than the studio takes. Simplify its meshes."
                )
            if len(index) and (index.min() < 0 or index.max() >= len(points)):
                raise StudioError(
                    f"{node.where}: joint '{self.names[joint]}' moves point {index.max()} of a skin of {len(points)}."
                    " Export the file again."
                )
            for place, point in enumerate(index.tolist()):
                share = float(shares[place]) if place < len(shares) else 1.0
                if share > 0.0:
                    found[point].append((share, joint))
        free = [point for point, many in enumerate(found) if not many]
        if free:
            self.looks.repairs.append(f"{len(free)} points of the skin had no joint; they go with the nearest one.")
            _, nearest = KDTree(np.array(self.positions)).query(points[free] @ whole[:3, :3].T + whole[:3, 3])
            for point, joint in zip(free, np.asarray(nearest).tolist(), strict=True):
                found[point] = [(1.0, joint)]
        joints, weights = np.zeros((len(points), _MOST_INFLUENCES), np.int64), np.zeros((len(points), _MOST_INFLUENCES))
        for point, many in enumerate(found):
            for place, (share, joint) in enumerate(sorted(many, reverse=True)[:_MOST_INFLUENCES]):
                joints[point, place], weights[point, place] = joint, share
        return joints, weights / weights.sum(axis=1, keepdims=True)


def _matrix(node: SceneNode) -> FloatArray:
    """(4, 4) T C R SR S -SR -C of a transformation (X3D 10.4.4)."""
    centre, move = node.vector("center", (0.0, 0.0, 0.0)), node.vector("translation", (0.0, 0.0, 0.0))
    scale = node.vector("scale", (1.0, 1.0, 1.0))
    turn, across = _rotation(node, "rotation"), _rotation(node, "scaleOrientation")
    form = turn @ across @ np.diag(scale) @ across.T
    matrix = np.eye(4)
    matrix[:3, :3] = form
    matrix[:3, 3] = move + centre - form @ centre
    return matrix


def _rotation(node: SceneNode, name: str) -> FloatArray:
    x, y, z, angle = node.vector(name, (0.0, 0.0, 1.0, 0.0))
    axis = np.array([x, y, z])
    length = np.linalg.norm(axis)
    if length < _SAME:
        return np.eye(3)
    return np.asarray(Rotation.from_rotvec(axis / length * np.remainder(angle, 2 * np.pi)).as_matrix())
