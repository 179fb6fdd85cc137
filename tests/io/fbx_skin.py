"""The body of ``fbx_text`` with a skin round it: a box a bone, hanging from its joint."""

import numpy as np

from tests.io.fbx_text import MODEL, PLAIN, ROOT, WORLD_TO_FILE, _numbers, body, fbx_text

GEOMETRY, SKIN, CLOTH, DEFORMER, CLUSTER = 500, 501, 510, 600, 601
"""Numbers of the objects; a cluster more for each joint."""
FACES = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
"""Seen from outside, of a box whose corners count up along x, y and z."""
HALF = 4.0
"""Centimetres."""


def skinned_fbx(raised: float = 0.0, bare: bool = False) -> str:
    """In centimetres, bound ``raised`` higher than it stands; ``bare`` boxes of the hands hang from nothing."""
    skeleton, _ = body()
    places = np.zeros((len(skeleton.names), 3))
    for joint, parent in enumerate(skeleton.parents.tolist()):
        places[joint] = WORLD_TO_FILE @ skeleton.offsets[joint] * 100 + (places[parent] if parent >= 0 else 0.0)
    places[:, 1] += raised
    corners = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]) * HALF
    boxes, objects, links = [], [], []
    for joint, name in enumerate(skeleton.names):
        children = [child for child, parent in enumerate(skeleton.parents.tolist()) if parent == joint]
        end = places[children[0]] if children else places[joint]
        boxes.append(0.5 * (places[joint] + end) + corners)
        if bare and "Hand" in name:
            continue
        index = ",".join(str(8 * joint + corner) for corner in range(8))
        link = _numbers(np.block([[np.eye(3), np.zeros((3, 1))], [places[joint], 1.0]]).ravel())
        there = _numbers(np.block([[np.eye(3), np.zeros((3, 1))], [-places[joint], 1.0]]).ravel())
        objects.append(f"""Deformer: {CLUSTER + joint}, "SubDeformer::", "Cluster" {{ Version: 100
Indexes: *8 {{ a: {index} }}
Weights: *8 {{ a: 1,1,1,1,1,1,1,1 }}
Transform: *16 {{ a: {there} }}
TransformLink: *16 {{ a: {link} }} }}""")
        links += [f'C: "OO",{CLUSTER + joint},{DEFORMER}', f'C: "OO",{ROOT + joint},{CLUSTER + joint}']
    vertices = np.concatenate(boxes)
    loops = [[8 * box + corner for corner in face] for box in range(len(boxes)) for face in FACES]
    polygons = ",".join(str(place) for loop in loops for place in (*loop[:-1], ~loop[-1]))
    objects += [
        f"""Geometry: {GEOMETRY}, "Geometry::Skin", "Mesh" {{
Vertices: *{vertices.size} {{ a: {_numbers(vertices.ravel())} }}
PolygonVertexIndex: *{4 * len(loops)} {{ a: {polygons} }}
LayerElementMaterial: 0 {{ Version: 101
Name: ""
MappingInformationType: "AllSame"
ReferenceInformationType: "IndexToDirect"
Materials: *1 {{ a: 0 }} }}
Layer: 0 {{ Version: 100
LayerElement: {{ Type: "LayerElementMaterial"
TypedIndex: 0 }} }} }}""",
        MODEL.format(number=SKIN, name="Skin", kind="Mesh", place="0,0,0", scale=1, **PLAIN),
        f"""Material: {CLOTH}, "Material::Cloth", "" {{ Version: 102
ShadingModel: "lambert"
Properties70: {{ P: "DiffuseColor", "Color", "", "A",0.8,0.2,0.1
}} }}""",
        f'Deformer: {DEFORMER}, "Deformer::", "Skin" {{ Version: 101\nLink_DeformAcuracy: 50 }}',
    ]
    links += [f'C: "OO",{GEOMETRY},{SKIN}', f'C: "OO",{SKIN},0', f'C: "OO",{CLOTH},{SKIN}']
    links.append(f'C: "OO",{DEFORMER},{GEOMETRY}')
    objects_end, connections = "}\nConnections: {\n", "\n".join(links)
    return fbx_text().replace(objects_end, "\n".join(objects) + "\n" + objects_end + connections + "\n", 1)
