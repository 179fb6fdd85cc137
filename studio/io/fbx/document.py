"""FBX document under construction: objects, and connections between them.

Every object has an id, a name, a class and a kind; a connection links an object to its parent, or to one property of
it. ``Properties70`` are rows of name, type, label, flags and values.
"""

from collections import Counter
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from studio import __version__
from studio.io.fbx.binary import CREATION_TIME, FBX_VERSION, FILE_ID, FbxElement, Int64, Value, block, element

FloatArray = NDArray[np.float64]

FBX_TICKS_PER_SECOND = 46_186_158_000
"""Units of FBX's time in a second."""
_TIME_MODES = {120: 1, 100: 2, 60: 3, 50: 4, 48: 5, 30: 6, 25: 10, 24: 11, 1000: 12, 96: 15, 72: 16}
"""The format's numbers of frame rates in Hz."""
_CUSTOM_TIME_MODE = 14
_CREATOR = f"Morpho Studio {__version__}"
_SCENE = Int64(1)
SCENE_ROOT_ID = Int64(0)
"""Id of the root of the scene."""
_FIRST_OBJECT = 1000
_CLASSES = {
    "NodeAttribute": "NodeAttribute",
    "Model": "Model",
    "Geometry": "Geometry",
    "Deformer": "Deformer",
    "Pose": "Pose",
    "Material": "Material",
    "Texture": "Texture",
    "Video": "Video",
    "AnimationStack": "AnimStack",
    "AnimationLayer": "AnimLayer",
    "AnimationCurveNode": "AnimCurveNode",
    "AnimationCurve": "AnimCurve",
}
"""Class that is written after the name of an object, by its element; clusters of a skin state their own."""


def row(name: str, kind: str, label: str, flags: str, *values: Value) -> FbxElement:
    """Row of ``Properties70`` with one property."""
    return element("P", name, kind, label, flags, *values)


def whole(name: str, value: int) -> FbxElement:
    """Property with an integer."""
    return row(name, "int", "Integer", "", value)


def choice(name: str, value: int) -> FbxElement:
    """Property with an enumeration value, given by its number."""
    return row(name, "enum", "", "", value)


def number(name: str, value: float) -> FbxElement:
    """Property with a number."""
    return row(name, "double", "Number", "", value)


def animated(name: str, values: Sequence[float]) -> FbxElement:
    """Property with a vector of the local transform, which curves may move."""
    return row(name, name, "", "A", *map(float, values))


def moment(name: str, seconds: float) -> FbxElement:
    """Property with a time, given in seconds."""
    return row(name, "KTime", "Time", "", ticks(seconds))


def colour(name: str, values: Sequence[float]) -> FbxElement:
    """Property with red, green and blue, 0 to 1."""
    return row(name, "Color", "", "A", *map(float, values))


def properties(*rows: FbxElement) -> FbxElement:
    """Block of an object's properties."""
    return block("Properties70", children=rows)


def ticks(seconds: float) -> Int64:
    """Time in units of FBX."""
    return Int64(round(seconds * FBX_TICKS_PER_SECOND))


def matrix(transform: FloatArray) -> FloatArray:
    """Matrix (4, 4) that acts on columns, as the 16 numbers that the format stores."""
    return np.ascontiguousarray(transform.T).ravel()


class FbxDocument:
    """FBX document of one scene with one animation of ``frame_count`` frames at ``frame_rate`` Hz."""

    def __init__(self, name: str, frame_rate: float, frame_count: int) -> None:
        self._frame_rate, self._last = frame_rate, (frame_count - 1) / frame_rate
        self.key_times = np.round(np.arange(frame_count) * (FBX_TICKS_PER_SECOND / frame_rate)).astype(np.int64)
        self._objects: list[FbxElement] = []
        self._connections: list[FbxElement] = []
        self.pictures: dict[str, Int64] = {}
        """Textures by the names of their files."""
        span = [moment(f"{which}{end}", time) for which in ("Local", "Reference")
                for end, time in (("Start", 0.0), ("Stop", self._last))]  # fmt: skip
        self._animation = name
        stack = self.add("AnimationStack", name, "", [properties(*span)])
        self.layer = self.add("AnimationLayer", "BaseLayer", "", [], within=stack)

    def add(
        self, kind: str, name: str, subkind: str, children: Sequence[FbxElement], *, within: Int64 | None = None,
        own_class: str = "",
      ) -> Int64:  # fmt: skip
        """Add an object, connected to the object ``within`` if given, and return its id."""
        key = Int64(_FIRST_OBJECT + len(self._objects))
        full_name = f"{name}\0\1{own_class or _CLASSES[kind]}"
        self._objects.append(block(kind, key, full_name, subkind, children=children))
        if within is not None:
            self.connect(key, within)
        return key

    def connect(self, child: Int64, parent: Int64, to_property: str = "") -> None:
        """Connect an object to another one, or to a property of it."""
        kind = ("OP", child, parent, to_property) if to_property else ("OO", child, parent)
        self._connections.append(element("C", *kind))

    def elements(self) -> list[FbxElement]:
        """All elements of the file."""
        counts = Counter(each.name for each in self._objects) + Counter({"GlobalSettings": 1})
        types = [block("ObjectType", kind, children=[element("Count", count)]) for kind, count in counts.items()]
        return [
            _header(),
            element("FileId", FILE_ID),
            element("CreationTime", CREATION_TIME),
            element("Creator", _CREATOR),
            self._settings(),
            self._description(),
            block("References"),
            block("Definitions", children=[element("Version", 100), element("Count", counts.total()), *types]),
            block("Objects", children=self._objects),
            block("Connections", children=self._connections),
            block("Takes", children=[element("Current", self._animation)]),
        ]

    def _settings(self) -> FbxElement:
        """Global settings: Y up, Z towards the viewer, X to the right; centimetres."""
        axes = [
            whole(f"{axis}Axis{sign}", value)
            for axis, index in (("Up", 1), ("Front", 2), ("Coord", 0))
            for sign, value in (("", index), ("Sign", 1))
        ]
        mode = _TIME_MODES.get(round(self._frame_rate), _CUSTOM_TIME_MODE)
        if abs(self._frame_rate - round(self._frame_rate)) > 1e-6:
            mode = _CUSTOM_TIME_MODE
        rows = [
            *axes,
            whole("OriginalUpAxis", 1),
            whole("OriginalUpAxisSign", 1),
            number("UnitScaleFactor", 1.0),
            number("OriginalUnitScaleFactor", 1.0),
            choice("TimeMode", mode),
            moment("TimeSpanStart", 0.0),
            moment("TimeSpanStop", self._last),
            number("CustomFrameRate", float(self._frame_rate)),
        ]
        return block("GlobalSettings", children=[element("Version", 1000), properties(*rows)])

    def _description(self) -> FbxElement:
        active = row("ActiveAnimStackName", "KString", "", "", self._animation)
        scene = block(
            "Document", _SCENE, "", "Scene", children=[properties(active), element("RootNode", SCENE_ROOT_ID)]
        )
        return block("Documents", children=[element("Count", 1), scene])


def _header() -> FbxElement:
    dates = {"Version": 1000, "Year": 1970, "Month": 1, "Day": 1, "Hour": 10, "Minute": 0, "Second": 0}
    created = block(
        "CreationTimeStamp", children=[*(element(*each) for each in dates.items()), element("Millisecond", 0)]
    )
    return block(
        "FBXHeaderExtension",
        children=[
            element("FBXHeaderVersion", 1003),
            element("FBXVersion", FBX_VERSION),
            element("EncryptionType", 0),
            created,
            element("Creator", _CREATOR),
        ],
    )
