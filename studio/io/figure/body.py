"""Conversion of a figure to a character: its body map, up and front directions, and unit."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studio.core.body.body_shape import body_by_shape
from studio.core.body.body_sides import feet_point_backwards
from studio.core.body.canonical import BodyLayout, BodyPart
from studio.core.body.humanoid import LIMB_PARTS, BodyMap
from studio.core.body.rehanging import JointOrder, reparented_order
from studio.core.body.skeleton import Skeleton
from studio.core.body.standing import standing_points
from studio.core.captures.capture import Guess
from studio.core.captures.confidence import Confidence
from studio.core.captures.reference_pose import stance_deviations
from studio.core.errors import StudioError
from studio.core.mesh.appearance import Appearance, Material
from studio.core.mesh.character import Character
from studio.core.mesh.rig import UNMOVED_JOINT, Rig, RigFile
from studio.core.rigs.embodiment import (
    bound_mesh,
    measured_body,
    measured_by_mesh,
    rolling_on_balls,
    segment_weights,
    segments_of_joints,
)
from studio.io.figure.body_maps import find_body, loose_feet, loose_hands, named_sides, similar_joints
from studio.io.figure.figure import NO_SKELETON_MESSAGE, Figure, MeshPiece
from studio.io.guessing import choose_unit, unit_of_metres
from studio.io.importing import ImportOptions
from studio.io.meshes.shapes import unit
from studio.io.registry import ReadCharacter
from studio.io.up_axis import turn_to_world

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

PLAIN_SKIN_COLOUR = "#B4BEC8"
MOST_RIG_INFLUENCES = 8
"""Maximum number of joints to which a vertex of a rig is bound."""
FBX_UNIT_METRES = 0.01
"""Unit of an FBX file in metres."""
NO_RIG_MESSAGE = "Its joints are mirrored, sheared or share a name, so exports have those of the studio."
"""Repair of a character that is not exported on its own joints."""
_LIMB_DEPTH = 3
"""Joints above an ankle at least: a root, a hip and a knee."""
_HANDS = (BodyPart.LEFT_HAND, BodyPart.RIGHT_HAND)


@dataclass(frozen=True, eq=False)
class _Body:
    """Figure with a body map: ``points`` (J, 3) in the world, and ``to_world`` (3, 3), a rotation with scale."""

    figure: Figure
    skeleton: Skeleton
    body_map: BodyMap
    points: FloatArray
    to_world: FloatArray
    guesses: tuple[Guess, ...]
    hung: Figure
    """Figure with the hierarchy of its own file, whatever parents its joints have in the body."""
    order: IntArray
    """Index (J,) in ``hung`` of each joint of ``figure``."""

    @property
    def fault(self) -> float:
        """Largest deviation from a human stance at ease, relative to the tolerance."""
        return float(stance_deviations(self.points[None], self.body_map).max())


def character_of(figures: Sequence[Figure], options: ImportOptions) -> ReadCharacter:
    """Character of a file whose bind pose is one of ``figures``: the one nearest to a human stance at ease.

    Of ``options``, body map, unit and up axis are used. Raises StudioError if there is no human body in it.
    """
    bodies = [_body(figure, options) for figure in figures]
    body = min(bodies, key=lambda body: body.fault)
    guesses = list(body.guesses)
    if len(bodies) > 1 and body is not bodies[0]:
        reason = "The pose in which the skin was bound is not human."
        guesses.append(Guess("reference pose", "as shown", reason, Confidence.LIKELY))
    try:
        return _embodied(body, guesses)
    except ValueError as error:
        raise StudioError(f"{body.figure.source}: invalid body or skin. {error}") from error


def remapped_character(character: Character, names: Mapping[str, str]) -> Character:
    """Character that is measured and bound again with ``names``, joints of its own rig by part, as in
    ``BodyMap.to_json``.

    Raises StudioError if it has no rig, or the joints make no body.
    """
    skin, rig = character.skin, character.skin.rig
    if rig is None:
        raise StudioError(
            f"{character.name} keeps no joints of its own, so its body map cannot change. Import it again."
        )
    if twice := [name for name, count in Counter(names.values()).items() if count > 1]:
        raise StudioError(f"{character.name}: {', '.join(twice)} cannot play several parts. Choose a joint for each.")
    piece = MeshPiece(
        skin.vertices.astype(np.float64),
        skin.normals.astype(np.float64),
        np.zeros((len(skin.vertices), 2)),
        skin.triangles.astype(np.int64),
        rig.joints.astype(np.int64),
        rig.weights.astype(np.float64),
    )
    figure = Figure(
        character.name, character.name, rig.names, tuple(rig.parents.tolist()), rig.positions, rig.rotations, (piece,),
        names, "Z", to_studio=np.eye(3),
    )  # fmt: skip
    read = character_of([figure], ImportOptions(unit="m")).character
    fitted = read.skin.rig
    if fitted is not None and fitted.file is not None and rig.file is not None:
        moved, turned = fitted.file.position, fitted.file.rotation
        placed = replace(rig.file, rotation=turned @ rig.file.rotation, position=turned @ rig.file.position + moved)
        fitted = replace(fitted, file=placed)
    return replace(character, build=read.build, skin=replace(read.skin, appearance=skin.appearance, rig=fitted))


def _body(figure: Figure, options: ImportOptions) -> _Body:
    figure = _rooted(figure)
    return _body_of(figure, options, figure, np.arange(len(figure.joint_names)))


def _body_of(figure: Figure, options: ImportOptions, hung: Figure, order: IntArray) -> _Body:
    parents = np.array(figure.parents)
    if not np.isfinite(figure.positions).all() or np.abs(figure.positions).max() > 1e9:
        raise StudioError(f"{figure.source}: its joints are too far apart. Export the file again.")
    offsets = figure.positions - figure.positions[np.maximum(parents, 0)]
    offsets[0] = figure.positions[0]
    skeleton = Skeleton(figure.joint_names, parents, offsets, np.zeros(len(parents), dtype=bool))
    loose = loose_feet(skeleton) | loose_hands(skeleton)
    if loose:
        new = reparented_order(parents, loose)
        return _body_of(_rehung(figure, new), options, hung, order[new.order])
    body_map, guess = _find(figure, skeleton, options)
    sides = _doubtful_sides(figure, body_map) if not options.body_map else None
    _check_limbs(figure, body_map)
    to_world = _upright(figure, body_map, options.up_axis)
    leg = _leg(figure.positions, body_map)
    scale, unit_guess = _scale(figure, leg, options.unit)
    guesses = [each for each in (guess, sides, unit_guess) if each is not None]
    points = scale * figure.positions @ to_world.T
    return _Body(figure, skeleton, body_map, points, scale * to_world, tuple(guesses), hung, order)


def _rehung(figure: Figure, new: JointOrder) -> Figure:
    """Figure whose joints have the parents of ``new``."""
    place = np.argsort(new.order)
    pieces = tuple(replace(piece, joints=place[piece.joints]) for piece in figure.pieces)
    return replace(
        figure,
        joint_names=tuple(figure.joint_names[old] for old in new.order),
        parents=tuple(new.parents.tolist()),
        positions=figure.positions[new.order],
        rotations=None if figure.rotations is None else figure.rotations[new.order],
        scales=None if figure.scales is None else figure.scales[new.order],
        bones=None if figure.bones is None else figure.bones[new.order],
        pieces=pieces,
    )


def _check_limbs(figure: Figure, body_map: BodyMap) -> None:
    """Raise StudioError for a bone of the limbs that is far too short beside the others."""
    for limb, parts in LIMB_PARTS.items():
        joints = [body_map[part] for part in parts]
        bones = np.linalg.norm(np.diff(figure.positions[joints], axis=0), axis=1)
        if bones.min() <= 1e-3 * bones.max():
            names = ", ".join(figure.joint_names[joint] for joint in joints)
            raise StudioError(
                f"{figure.source}: a bone of the {limb} ({names}) has no length. Choose other joints for it."
            )


def _rooted(figure: Figure) -> Figure:
    """Figure with one root above all joints."""
    if not figure.joint_names:
        raise StudioError(f"{figure.source} {NO_SKELETON_MESSAGE}")
    if figure.parents.count(-1) == 1 and figure.parents[0] == -1:
        return figure
    name = "scene" + "_" * sum(each.startswith("scene") for each in figure.joint_names)
    pieces = tuple(replace(piece, joints=piece.joints + 1) for piece in figure.pieces)
    return replace(
        figure,
        joint_names=(name, *figure.joint_names),
        parents=(-1, *(parent + 1 for parent in figure.parents)),
        positions=np.vstack([np.zeros(3), figure.positions]),
        rotations=None if figure.rotations is None else np.concatenate([np.eye(3)[None], figure.rotations]),
        scales=None if figure.scales is None else np.concatenate([[1.0], figure.scales]),
        bones=None if figure.bones is None else np.concatenate([[False], figure.bones]),
        pieces=pieces,
    )


def _find(figure: Figure, skeleton: Skeleton, options: ImportOptions) -> tuple[BodyMap, Guess | None]:
    if figure.parts and not options.body_map:
        return BodyMap.from_json(skeleton, figure.parts), None
    found = find_body(skeleton, figure.positions[None], options.body_map)
    if found.body_map is not None:
        parts = len(found.body_map.parts)
        reason = f"Names as in {found.family}; topology and symmetry agree."
        return found.body_map, Guess(
            "body map", f"{parts} parts, {len(found.body_map.spine)} spine joints", reason, Confidence.SURE
        )
    by_shape = body_by_shape(skeleton, figure.positions @ turn_to_world(figure.up).T, named_sides(skeleton))
    if by_shape is not None:
        reason = "The names of its joints are unknown; legs reach lowest, arms widest, the head highest."
        return by_shape, Guess("body map", f"{len(by_shape.parts)} parts by shape", reason, Confidence.LIKELY)
    if _deepest(skeleton) < _LIMB_DEPTH:
        raise StudioError(f"{figure.source} {NO_SKELETON_MESSAGE}")
    offers = {limb: similar_joints(skeleton, limb) for limb in found.missing}
    words = "; ".join(f"no {limb} (candidates: {', '.join(names) or 'none'})" for limb, names in offers.items())
    raise StudioError(
        f"{figure.source} shows no complete human body: {words}. Name its joints as H-Anim, Mixamo or VRM do, and"
        " export it again."
    )


def _doubtful_sides(figure: Figure, body_map: BodyMap) -> Guess | None:
    """Doubt about left and right of a body whose feet point backwards; None for any other."""
    if not feet_point_backwards(body_map, figure.positions[None]):
        return None
    reason = "The feet point backwards: left and right may be swapped. Change them in the body map if they are."
    return Guess("sides", "as the joints are named", reason, Confidence.DOUBTFUL)


def _deepest(skeleton: Skeleton) -> int:
    """Depth of the deepest joint."""
    depths: list[int] = []
    for parent in skeleton.parents.tolist():
        depths.append(depths[parent] + 1 if parent >= 0 else 0)
    return max(depths)


def _upright(figure: Figure, body_map: BodyMap, up_axis: str | None) -> FloatArray:
    """Rotation (3, 3) from the file's axes that aligns trunk and left side with +Z and +Y; tilts below 30 degrees are
    kept.
    """
    points = figure.positions

    def pair(part: str) -> tuple[FloatArray, FloatArray]:
        return points[body_map[BodyPart[f"LEFT_{part}"]]], points[body_map[BodyPart[f"RIGHT_{part}"]]]

    hips, shoulders = pair("THIGH"), pair("UPPER_ARM")
    trunk = shoulders[0] + shoulders[1] - hips[0] - hips[1]
    up = _snapped(trunk, 30.0)
    if up_axis is not None:
        up = turn_to_world(up_axis)[2]
    left = hips[0] - hips[1]
    left = _snapped(left - left @ up * up, 8.0)
    left = left - left @ up * up
    if np.linalg.norm(up) < 0.5 or np.linalg.norm(left) < 1e-6:
        raise StudioError(
            f"{figure.source}: its body has no width or no height, because hips or shoulders are at one place."
            " Export it with its skeleton standing."
        )
    left = left / np.linalg.norm(left)
    return np.stack([np.cross(left, up), left, up])


def _snapped(vector: FloatArray, degrees: float) -> FloatArray:
    """Direction ``vector``, or the axis of the file within ``degrees`` of it."""
    length = np.linalg.norm(vector)
    if length < 1e-9:
        return np.zeros(3)
    direction: FloatArray = vector / length
    largest = int(np.argmax(np.abs(direction)))
    if np.abs(direction[largest]) < np.cos(np.radians(degrees)):
        return direction
    axis = np.zeros(3)
    axis[largest] = np.sign(direction[largest])
    return axis


def _leg(points: FloatArray, body_map: BodyMap) -> float:
    total = 0.0
    for side in ("LEFT", "RIGHT"):
        hip, knee, ankle = (points[body_map[BodyPart[f"{side}_{part}"]]] for part in ("THIGH", "SHANK", "FOOT"))
        total += float(np.linalg.norm(knee - hip) + np.linalg.norm(ankle - knee))
    return total / 2


def _scale(figure: Figure, leg: float, unit_name: str | None) -> tuple[float, Guess | None]:
    if not np.isfinite(leg) or leg < 1e-9:
        raise StudioError(f"{figure.source}: its legs have no length. Export it with its skeleton standing.")
    scale, guess = choose_unit(leg, unit_of_metres(figure.metres), unit_name)
    return scale.metres, guess


def _embodied(body: _Body, guesses: list[Guess]) -> ReadCharacter:
    figure, repairs = body.figure, list(body.figure.repairs)
    segments = segments_of_joints(body.skeleton, body.body_map)
    pieces = _worn(figure, segments, len(body.body_map.spine), repairs)
    if not pieces:
        if figure.moves:
            raise StudioError(f"{figure.source} has a skeleton but no mesh: it is a motion, not a character.")
        raise StudioError(f"{figure.source} has a skeleton but no mesh. Export it with its mesh.")
    vertices = np.concatenate([piece.vertices for piece in pieces]) @ body.to_world.T
    width = max(piece.joints.shape[1] for piece in pieces)
    joints, weights = (np.concatenate([_padded(piece, width)[which] for piece in pieces]) for which in (0, 1))
    count = len(body.body_map.spine) + 18
    shares = segment_weights(joints, weights, segments, count)
    skeleton, points = _grounded(body, vertices, shares)
    vertices = vertices + (points[0] - body.points[0])
    measures, stance = measured_body(skeleton, body.body_map)
    root = points[body.body_map.spine[0]]
    marks = standing_points(measures, stance)
    marks = marks + (root - marks[0])
    measures = measured_by_mesh(measures, stance, marks, vertices, shares)
    rolling, shares = rolling_on_balls(measures, stance, marks, vertices, shares)
    rolled, measures = (rolling.foot != measures.foot).any(axis=1), rolling
    turn = body.to_world / np.cbrt(np.linalg.det(body.to_world))
    normals = unit(np.concatenate([piece.normals for piece in pieces]) @ turn.T)
    first = np.cumsum([0, *(len(piece.vertices) for piece in pieces)])
    triangles = np.concatenate([piece.triangles + start for piece, start in zip(pieces, first, strict=False)])
    appearance = _appearance(pieces)
    skin = bound_mesh(measures, stance, root, vertices, normals, triangles, shares, appearance)
    away = standing_points(measures, stance)[0] - root + (points[0] - body.points[0])
    rig = _rig(body, segments, rolled.tolist(), joints, weights, away)
    if rig is None:
        repairs.append(NO_RIG_MESSAGE)
    skin = replace(skin, rig=rig)
    character = Character(figure.name.replace("_", " "), _colour(appearance), measures, skin)
    names = body.body_map.to_json(body.skeleton)
    return ReadCharacter(character, tuple(guesses), tuple(repairs), names, figure.moves)


def _rig(
    body: _Body, segments: IntArray, rolled: Sequence[bool], joints: IntArray, weights: FloatArray, away: FloatArray
) -> Rig | None:
    """Rig of the file's own joints; None if they are mirrored, sheared or share a name.

    ``away`` (3,) is the displacement from the figure. A toe joint that is too near its ankle to roll over moves with
    its foot.
    """
    hung, order, spine = body.hung, body.order, body.body_map.spine
    turn = body.to_world / np.cbrt(np.linalg.det(body.to_world))
    if hung.rotations is None or np.linalg.det(turn) < 0.0 or len(set(hung.joint_names)) < len(order):
        return None
    own = np.array(segments[: len(order)])
    for side, is_rolled in enumerate(rolled):
        toe = len(spine) + 13 + 4 * side
        if is_rolled:
            own[own == toe] = toe - 1
    own[list(body.skeleton.path(0, spine[0]))[:-1]] = UNMOVED_JOINT
    place = np.argsort(order)
    strongest = np.argsort(-weights, axis=1, kind="stable")[:, :MOST_RIG_INFLUENCES]
    kept = np.take_along_axis(weights, strongest, axis=1)
    return Rig(
        hung.joint_names,
        np.array(hung.parents),
        body.points[place] + away,
        turn @ hung.rotations,
        own[place].astype(np.int32),
        order[np.take_along_axis(joints, strongest, axis=1)].astype(np.int32),
        (kept / kept.sum(axis=1, keepdims=True)).astype(np.float32),
        _rig_file(body, turn, away, order[joints[weights > 0.0]]),
    )


def _rig_file(body: _Body, turn: FloatArray, away: FloatArray, used: IntArray) -> RigFile | None:
    """Bind pose in the file's own hierarchy; ``turn`` (3, 3) and ``away`` (3,) lead from the figure's world.

    Joints to which the skin is bound (``used``) are bones.
    """
    hung, count = body.hung, len(body.hung.joint_names)
    if hung.to_studio is None:
        return None
    unit_length = FBX_UNIT_METRES if hung.kind == "FBX" else 1.0
    metres = np.cbrt(np.linalg.det(body.to_world))
    scales = np.full(count, unit_length) if hung.scales is None else metres * hung.scales
    bones = np.ones(count, bool) if hung.bones is None else np.array(hung.bones)
    bones[used] = True
    for joint, parent in enumerate(hung.parents):
        bones[joint] |= parent >= 0 and bones[parent]
    return RigFile(hung.kind, turn @ hung.to_studio.T, away, scales / unit_length, bones)


def _worn(figure: Figure, segments: IntArray, spine_count: int, repairs: list[str]) -> list[MeshPiece]:
    """Pieces that belong to the body, without those in the hands that are drawn already."""
    hands = {BodyLayout(spine_count).hand_segment(side) for side in (0, 1)}
    drawn = {
        int(segment)
        for piece in figure.pieces
        if not piece.rigid
        for segment in np.unique(segments[piece.joints[piece.weights > 0.5]])
    }
    held = [p for p in figure.pieces if p.rigid and int(segments[p.joints[0, 0]]) in hands & drawn]
    if held:
        names = ", ".join(dict.fromkeys(piece.name for piece in held))
        repairs.append(f"What it holds in its hands was left out: {names}.")
    left_out = {id(piece) for piece in held}
    return [piece for piece in figure.pieces if id(piece) not in left_out]


def _padded(piece: MeshPiece, width: int) -> tuple[IntArray, FloatArray]:
    gap = ((0, 0), (0, width - piece.joints.shape[1]))
    return np.pad(piece.joints, gap), np.pad(piece.weights, gap)


def _grounded(body: _Body, vertices: FloatArray, shares: FloatArray) -> tuple[Skeleton, FloatArray]:
    """Skeleton in the world with its soles on z = 0; end sites are added to hands and feet without children."""
    layout = BodyLayout(len(body.body_map.spine))
    feet = [segment(side) for side in (0, 1) for segment in (layout.foot_segment, layout.toe_segment)]
    soles = vertices[shares[:, feet].sum(axis=1) > 0.5]
    ankles = [body.points[body.body_map[BodyPart[f"{side}_FOOT"]]] for side in ("LEFT", "RIGHT")]
    leg = _leg(body.points, body.body_map)
    floor = float(soles[:, 2].min()) if len(soles) else min(ankle[2] for ankle in ankles) - 0.09 * leg
    points = body.points - [0.0, 0.0, floor]
    children = body.skeleton.children
    names, parents, places = list(body.skeleton.names), body.skeleton.parents.tolist(), list(points)
    for side in ("LEFT", "RIGHT"):
        foot = body.body_map[BodyPart[f"{side}_FOOT"]]
        toe = body.body_map.get(BodyPart[f"{side}_TOE"])
        below = np.array([np.linalg.norm(body.points[child] - body.points[foot]) for child in children[foot]])
        if toe is None and not (below > 0.05 * leg).any():
            own = soles[np.linalg.norm(soles - body.points[foot], axis=1) < leg] if len(soles) else soles
            reach = float(own[:, 0].max() - body.points[foot][0]) if len(own) else 0.25 * leg
            names.append(f"{side.lower()} toe base ({len(names)})")
            parents.append(foot)
            places.append(np.array([points[foot][0] + 0.7 * max(reach, 0.02), points[foot][1], 0.2 * points[foot][2]]))
    offsets = np.array(places) - np.array(places)[np.maximum(parents, 0)]
    offsets[0] = places[0]
    ends = np.arange(len(names)) >= len(points)
    return Skeleton(tuple(names), np.array(parents), offsets, ends), points


def _appearance(pieces: Sequence[MeshPiece]) -> Appearance | None:
    """Materials of the pieces, each once, although every mesh of a file may have its own copy; pictures too."""
    materials: dict[tuple[object, ...], Material] = {}
    pictures: dict[bytes, NDArray[np.uint8]] = {}
    indices = []
    if all(piece.material is None for piece in pieces):
        return None
    for piece in pieces:
        material = piece.material or Material("", PLAIN_SKIN_COLOUR)
        once = {name: pictures.setdefault(each.tobytes(), each) for name, each in material.maps.items()}
        picture = material.texture
        if picture is not None:
            picture = pictures.setdefault(picture.tobytes(), picture)
        material = replace(material, texture=picture, maps=once)
        key = (
            material.name, material.colour, material.two_sided, material.cut_out, id(picture),
            material.metallic, material.roughness, material.emission,
            *((name, id(each)) for name, each in once.items()),
        )  # fmt: skip
        materials.setdefault(key, material)
        indices.append(np.full(len(piece.triangles), list(materials).index(key)))
    coordinates = np.concatenate([piece.coordinates for piece in pieces])
    return Appearance(tuple(materials.values()), np.concatenate(indices), np.clip(coordinates, -1e6, 1e6))


def _colour(appearance: Appearance | None) -> str:
    """Colour of most triangles, which identifies the character on timeline and stage."""
    if appearance is None:
        return PLAIN_SKIN_COLOUR
    most = int(np.bincount(appearance.triangle_materials).argmax())
    material = appearance.materials[most]
    return (
        PLAIN_SKIN_COLOUR
        if material.texture is not None or material.colour in ("#FFFFFF", "#000000")
        else material.colour
    )
