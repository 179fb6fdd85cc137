"""X3D in XML: elements parsed to nodes, without entities and without opening other files."""

from pathlib import Path
from typing import Any
from xml.parsers import expat

from studio.core.errors import StudioError
from studio.io.hanim.scene import DEEPEST_NODE, LARGEST_TEXT_BYTES, MOST_HANIM_NODES, SceneNode, too_many
from studio.io.referenced_files import read_bytes

_FIELDS = {
    "Appearance": "appearance",
    "Material": "material",
    "UnlitMaterial": "material",
    "PhysicalMaterial": "material",
    "ImageTexture": "texture",
    "PixelTexture": "texture",
    "TextureTransform": "textureTransform",
    "Coordinate": "coord",
    "CoordinateDouble": "coord",
    "TextureCoordinate": "texCoord",
    "Normal": "normal",
    "Color": "color",
    "ColorRGBA": "color",
    **dict.fromkeys(
        ("Box", "Sphere", "Cylinder", "Cone", "IndexedFaceSet", "IndexedTriangleSet", "TriangleSet", "IndexedLineSet"),
        "geometry",
    ),
}
"""The field of its parent in which a node stands unless it says otherwise; ``children`` for all others."""
_NO_NODES = frozenset({"X3D", "Scene", "head", "meta", "component", "unit", "ROUTE", "IS", "connect", "field"})


def read_x3d(path: Path) -> list[SceneNode]:
    """Top-level nodes of the scene of an .x3d file. Raises StudioError with file and line."""
    return _Reader(path).read(read_bytes(path, LARGEST_TEXT_BYTES))


class _Reader:
    """Reader of one file."""

    def __init__(self, path: Path) -> None:
        self._name = path.name
        self._parser = expat.ParserCreate()
        self._parser.buffer_text = True
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end
        self._parser.EntityDeclHandler = self._refuse_entity
        self._top: list[SceneNode] = []
        self._open: list[SceneNode | None] = []
        self._definitions: dict[str, SceneNode] = {}
        self._prototype, self._elements = 0, 0

    def read(self, content: bytes) -> list[SceneNode]:
        """Parse ``content``, a whole X3D file."""
        try:
            self._parser.Parse(content, True)
        except expat.ExpatError as error:
            reason = expat.ErrorString(error.code)
            raise StudioError(f"{self._name}, line {error.lineno}: {reason}. Export or copy the file again.") from error
        except (ValueError, LookupError) as error:  # an encoding that Python does not know
            raise StudioError(f"{self._name} is not readable as XML: {error}. Export it in UTF-8.") from error
        return self._top

    @property
    def _where(self) -> str:
        return f"{self._name}, line {self._parser.CurrentLineNumber}"

    def _refuse_entity(self, name: str, *_rest: Any) -> None:
        raise StudioError(
            f"{self._where}: it declares the entity '{name[:40]}'. The studio reads no entities; remove it."
        )

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        if len(self._open) >= 2 * DEEPEST_NODE:
            raise StudioError(f"{self._where}: its nodes are nested more than {DEEPEST_NODE} deep. Simplify the file.")
        self._elements += 1
        if self._elements > MOST_HANIM_NODES:
            raise too_many("nodes", MOST_HANIM_NODES, self._where)
        self._prototype += tag in ("ProtoDeclare", "ExternProtoDeclare")
        parent = next((node for node in reversed(self._open) if node is not None), None)
        if self._prototype or tag in _NO_NODES:
            self._open.append(None)
        elif tag == "fieldValue":
            self._open.append(self._field_value(parent, attributes))
        else:
            node = self._node(tag, attributes)
            self._open.append(node)
            if node is not None:
                self._put(parent, node, attributes.get("containerField", _FIELDS.get(node.kind, "children")))

    def _end(self, tag: str) -> None:
        self._prototype -= tag in ("ProtoDeclare", "ExternProtoDeclare")
        node = self._open.pop()
        if node is not None and node.definition and node.kind:
            self._definitions.setdefault(node.definition, node)

    def _node(self, tag: str, attributes: dict[str, str]) -> SceneNode | None:
        if "USE" in attributes:
            return self._definitions.get(attributes["USE"])
        kind = attributes.get("name", "") if tag == "ProtoInstance" else tag
        plain = {key: value for key, value in attributes.items() if key not in ("DEF", "containerField", "class")}
        if tag == "ProtoInstance":
            plain.pop("name", None)
        return SceneNode(kind, self._where, attributes.get("DEF", ""), dict(plain))

    def _field_value(self, parent: SceneNode | None, attributes: dict[str, str]) -> SceneNode | None:
        """Set a field of a PROTO instance to its value, or return a node that collects the nodes inside."""
        name = attributes.get("name", "")
        if parent is not None and "value" in attributes:
            parent.fields[name] = attributes["value"]
        if parent is None:
            return None
        inside = SceneNode("", self._where)
        parent.fields.setdefault(name, [])
        inside.fields["children"] = parent.fields[name]
        return inside

    def _put(self, parent: SceneNode | None, node: SceneNode, field: str) -> None:
        if parent is None:
            self._top.append(node)
            return
        if parent.kind == "":  # inside a fieldValue everything is its value
            field = "children"
        inner = parent.fields.setdefault(field, [])
        if isinstance(inner, list):
            inner.append(node)
