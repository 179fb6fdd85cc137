"""Interpretation of the animation of a glTF, GLB or VRM file as a capture."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.core.body.kinematics import joint_positions
from studio.core.body.pose import PoseSequence
from studio.core.body.rehanging import reparented_motion, reparented_order, with_body_over_feet
from studio.core.body.skeleton import Skeleton
from studio.core.captures.capture import Capture, Guess
from studio.core.captures.confidence import Confidence
from studio.core.errors import StudioError
from studio.core.rotations import from_matrix, to_matrix
from studio.io.capture_guesses import (
    ReadJoints,
    body_by_shape_in,
    body_guesses,
    loose_guesses,
    make_capture,
    with_sides_right,
)
from studio.io.figure.body_maps import find_body, loose_feet, loose_hands
from studio.io.gltf.accessors import Accessors
from studio.io.gltf.animation import AnimationTrack, read_tracks
from studio.io.gltf.container import GltfFile, read_gltf
from studio.io.gltf.nodes import Nodes, node_parts, orthogonal_axes, read_nodes
from studio.io.gltf.vrm import vrm_bones
from studio.io.guessing import Scale, choose_unit, guess_frame_rate, leg_and_trunk
from studio.io.importing import ImportOptions
from studio.io.registry import Progress, ReadCapture
from studio.io.scene.proper_rotations import proper_rotations
from studio.io.up_axis import BodyPoints, guess_up_axis, parse_axis, stated_axis_prior, turn_to_world

FloatArray = NDArray[np.float64]

_METRES = Scale("m", 1.0)
"""The unit of every glTF file by its rule."""
_SPARSE = 1.0 / 15.0
"""Seconds between keys from which they are an animator's and not a recording's."""
_USUAL_RATE = 30.0
_DIGIT = 1e-4
"""Seconds to which programs round the time of a key."""
_EVEN = 0.7
"""Parts of a step by which the distances of evenly spaced keys may differ: programs round their times."""
_SPARE_POSES = 2_500_000
_DRAWN = {"mesh", "camera"}
"""Fields of a node that is drawn and no joint."""
_PIECE = 1024
"""Frames whose matrices are made at a time."""
_LOOKED_AT = 128


@dataclass(frozen=True, eq=False)
class _Figure:
    """Nodes that are joints, parents first; ``parents`` are indices in ``nodes``.

    Several roots become children of an added root.
    """

    nodes: tuple[int, ...]
    """Index of each node in the file; -1 for the added root."""
    parents: tuple[int, ...]
    names: tuple[str, ...]


def load_gltf(path: Path, options: ImportOptions, progress: Progress) -> ReadCapture:
    """First animation in the file, on the joints of its skins; the zero pose is the rest pose of the file's nodes.

    Raises StudioError if the file is damaged or holds no animation.
    """
    progress(0.0, f"Reading {path.name}")
    return capture_in(read_gltf(path), options, progress)


def capture_in(file: GltfFile, options: ImportOptions, progress: Progress) -> ReadCapture:
    """Capture of ``file``, which can be interpreted again with other options."""

    def interpret(options: ImportOptions, progress: Progress) -> Capture:
        return _capture(file, options, progress)

    return ReadCapture(interpret(options, progress), interpret=interpret)


def _capture(file: GltfFile, options: ImportOptions, progress: Progress) -> Capture:
    path = file.path
    nodes, accessors = read_nodes(file.root), Accessors(file)
    bones = vrm_bones(file.root, len(nodes.parents))
    repairs: list[str] = []
    tracks, guesses = _first_animation(file, accessors, len(nodes.parents), repairs)
    figure = _figure(file, nodes, tracks, bones)
    rate = _frame_rate(tracks, options, guesses)
    times = _times(tracks, rate, len(nodes.parents), file)
    axis = parse_axis(options.up_axis or "Y")
    to_world = turn_to_world(axis)
    places, turns = _world(nodes, figure, tracks, times, to_world, progress)
    rest_places, rest_turns = _world(nodes, figure, [], times[:1], to_world, lambda share, text: None)
    progress(0.7, f"Finding the body in {path.name}")
    looked_at = np.unique(np.linspace(0, len(times) - 1, _LOOKED_AT).astype(int))
    relative, mirrored = proper_rotations(list(figure.names), turns @ np.swapaxes(rest_turns, -1, -2))
    repairs += mirrored
    skeleton, poses = _joint_motion(figure, rest_places[0], places, relative)
    rest = rest_places[0]
    feet, hands = loose_feet(skeleton), loose_hands(skeleton)
    if feet or hands:
        poses, behind = with_body_over_feet(skeleton, poses, feet) if feet else (poses, 0.0)
        places = joint_positions(skeleton, poses)
        hanging = reparented_order(skeleton.parents, feet | hands)
        skeleton, poses = reparented_motion(skeleton, poses, hanging)
        places, rest = places[:, hanging.order], rest[hanging.order]
        guesses += loose_guesses(feet, hands, behind)
    sample = places[looked_at]
    chosen = {part: figure.names[figure.nodes.index(node)] for part, node in bones.items()}
    found = find_body(skeleton, sample, {**chosen, **(options.body_map or {})} or None)
    if found.body_map is None:
        found = body_by_shape_in(skeleton, rest @ to_world, sample, options.up_axis) or found
    guesses += body_guesses(skeleton, found, options)
    if not (bones or options.body_map):
        found = with_sides_right(found, sample, guesses)
    if found.body_map is not None and options.up_axis is None:
        after = places[np.minimum(looked_at + 1, len(times) - 1)]
        body = BodyPoints.of_joints(np.stack([sample, after]) @ to_world, found.body_map)
        guess = guess_up_axis(body, stated_axis_prior(axis))
        if guess.value != axis:
            return _capture(file, replace(options, up_axis=guess.value), progress).with_guess(guess)
    leg, trunk = leg_and_trunk(sample, found.body_map)
    (unit, metres), unit_guess = choose_unit(leg, _METRES, options.unit, trunk)
    guesses += [unit_guess] if unit_guess else []
    skeleton = replace(skeleton, offsets=metres * skeleton.offsets)
    poses = replace(poses, local_translations=metres * poses.local_translations)
    read = ReadJoints(path, skeleton, poses, metres * places, rate, unit, axis, tuple(repairs))
    capture = make_capture(read, found, options, guesses)
    progress(1.0, f"Loaded {path.name}")
    return capture


def _first_animation(
    file: GltfFile, accessors: Accessors, node_count: int, repairs: list[str]
) -> tuple[list[AnimationTrack], list[Guess]]:
    animations = file.root.records("animations")
    for index, animation in enumerate(animations):
        tracks = read_tracks(animation, accessors, node_count, repairs)
        if tracks:
            name = animation.text("name") or f"animation {index}"
            others = [each.text("name") for each in animations[:9] if each is not animation]
            reason = f"The file holds {len(animations)}; others are {', '.join(others)}."
            return tracks, [Guess("animation", name, reason, Confidence.LIKELY)] if len(animations) > 1 else []
    raise StudioError(f"{file.path.name} holds no animation: there is no motion to read. Export it with one.")


def _figure(file: GltfFile, nodes: Nodes, tracks: list[AnimationTrack], bones: dict[str, int]) -> _Figure:
    """Joints of all skins, else the animated nodes and their descendants, and all ancestors of these."""
    wanted = {joint for skin in file.root.records("skins") for joint in skin.indices("joints", len(nodes.parents))}
    if not wanted:
        wanted = {track.node for track in tracks} | set(bones.values())
        hanging = [node for node in nodes.order if not _DRAWN & nodes.records[node].value.keys()]
        for node in hanging:
            if nodes.parents[node] in wanted:
                wanted.add(node)
    wanted |= set(bones.values())
    for node in list(wanted):
        while (node := nodes.parents[node]) >= 0 and node not in wanted:
            wanted.add(node)
    chosen = [node for node in nodes.order if node in wanted]
    several = sum(nodes.parents[node] < 0 for node in chosen) > 1
    if several:
        chosen = [-1, *chosen]
    place = {node: joint for joint, node in enumerate(chosen)}
    names = nodes.names()
    parents = [-1 if node < 0 else place.get(nodes.parents[node], -1) for node in chosen]
    own = "Root" if "Root" not in names else "Root of all"
    return _Figure(tuple(chosen), tuple(parents), tuple(own if node < 0 else names[node] for node in chosen))


def _frame_rate(tracks: list[AnimationTrack], options: ImportOptions, guesses: list[Guess]) -> float:
    if options.frame_rate is not None:
        return options.frame_rate
    densest = max(tracks, key=lambda track: len(track.times)).times
    steps = np.diff(densest)
    step, digit = float(np.median(steps)) if len(steps) else np.inf, _DIGIT
    if len(steps) and np.ptp(steps) < _EVEN * step:  # the mean of even steps is the surest
        step, digit = float((densest[-1] - densest[0]) / len(steps)), max(_DIGIT, float(np.ptp(steps))) / len(steps)
    if step > _SPARSE:
        guesses.append(
            Guess("frame rate", f"{_USUAL_RATE:g} fps", "The keys are too few to tell a rate.", Confidence.DOUBTFUL)
        )
        return _USUAL_RATE
    rate, guess = guess_frame_rate(step, digit)
    guesses += [guess] if guess else []
    return rate


def _times(tracks: list[AnimationTrack], rate: float, node_count: int, file: GltfFile) -> FloatArray:
    """Times (F,) in seconds of the frames. Raises StudioError for more frames than a file of its size can hold."""
    begin = min(float(track.times[0]) for track in tracks)
    end = max(float(track.times[-1]) for track in tracks)
    count = int((end - begin) * rate + 1e-3) + 1
    if count * node_count > _SPARE_POSES + file.size:
        raise StudioError(
            f"{file.path.name}: its animation lasts {end - begin:g} s, {count} frames of {node_count} nodes: more than"
            " a file of this size can hold. Export it again."
        )
    return begin + np.arange(count) / rate


def _world(
    nodes: Nodes, figure: _Figure, tracks: list[AnimationTrack], times: FloatArray, axes: FloatArray, progress: Progress
) -> tuple[FloatArray, FloatArray]:
    """Positions (F, J, 3) and rotations (F, J, 3, 3) of the joints in world axes, with all scales of their ancestors
    applied.
    """
    places = np.zeros((len(times), len(figure.nodes), 3))
    turns = np.tile(np.eye(3), (len(times), len(figure.nodes), 1, 1))
    for first in range(0, len(times), _PIECE):
        progress(0.1 + 0.6 * first / len(times), "Posing the joints")
        piece = slice(first, first + _PIECE)
        matrices: dict[int, FloatArray] = {}
        for joint, node in enumerate(figure.nodes):
            if node < 0:
                continue
            local = _local(nodes, node, [track for track in tracks if track.node == node], times[piece])
            above = matrices.get(nodes.parents[node])
            matrices[node] = local if above is None else above @ local
            places[piece, joint] = matrices[node][:, :3, 3]
            turns[piece, joint] = orthogonal_axes(matrices[node][:, :3, :3])
    return places @ axes.T, axes @ turns @ axes.T


def _local(nodes: Nodes, node: int, tracks: list[AnimationTrack], times: FloatArray) -> FloatArray:
    """Matrices (F, 4, 4) from a node to its parent; properties without a track are as in the file."""
    if not tracks:
        return np.tile(nodes.local[node], (len(times), 1, 1))
    move, turn, scales = (np.tile(part, (len(times), *[1] * part.ndim)) for part in node_parts(nodes.records[node]))
    for track in tracks:
        values = track.at(times)
        match track.path:
            case "rotation":
                turn = to_matrix(values)
            case "translation":
                move = values
            case "scale":
                scales = values
    local = np.tile(np.eye(4), (len(times), 1, 1))
    local[:, :3, :3] = turn * scales[:, None, :]
    local[:, :3, 3] = move
    return local


def _joint_motion(
    figure: _Figure, rest_places: FloatArray, positions: FloatArray, world: FloatArray
) -> tuple[Skeleton, PoseSequence]:
    """Joints whose zero pose is the rest pose, and their motion, from world positions and rotations (F, J, 3, 3)."""
    offsets, moves = rest_places.copy(), positions.copy()
    local = world.copy()
    for joint, parent in enumerate(figure.parents):
        if parent >= 0:
            carrier = np.swapaxes(world[:, parent], 1, 2)
            offsets[joint] -= rest_places[parent]
            local[:, joint] = carrier @ world[:, joint]
            moves[:, joint] = np.einsum("fij,fj->fi", carrier, positions[:, joint] - positions[:, parent])
    skeleton = Skeleton(figure.names, np.array(figure.parents), offsets, np.zeros(len(offsets), bool))
    return skeleton, PoseSequence(from_matrix(local), moves)
