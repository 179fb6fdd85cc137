"""All that kernels serve, done once: every kind of constraint, on every ground, of still and growing bodies."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import AnimatedMorphology
from studio.core.captures.contacts import ContactInterval, ContactPoint
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.follow import FollowBody
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve, EaseShape
from studio.core.curves.keyed import KeyedNumber, KeyedPlace, KeyedTurn
from studio.core.grounds import Bumps, HeightMap, Slope, Steps, SurfaceMesh
from studio.core.grounds.ground import Ground
from studio.core.mesh.skin import Blending, skin_vertices
from studio.core.mesh.triangle_mesh import TriangleMesh
from studio.core.normalized.normalize import detected_contacts, normalize_capture
from studio.core.normalized.realize import realize_motion
from studio.core.normalized.round_trip import round_trip
from studio.core.quality.report import report_of
from studio.core.solver.adapt import adapt
from studio.core.solver.grounding.grounded_motion import grounded_motion_of
from studio.core.solver.request import AdaptRequest
from studio.io.importing import load_capture
from studio.io.project.character_file import bundled_characters
from studio.library.catalogue import Catalogue
from studio.library.indexing import index_folders
from studio.library.library import Library
from studio.library.searching import StrikeQuery, search_strikes
from studio.live.driving import ReceivedPose, driven_frame
from studio.live.live_grounding import LiveGrounding
from studio.live.streamer import packets_of
from studio.live.tracker import Inbox
from studio.resources_folder import example_captures_folder
from tests.builders import make_capture
from tests.core.motions import ALWAYS, walk
from tests.core.scenes import KINDS, Scene

CHARACTERS = tuple(bundled_characters().values())[:2]
WALK, FEET = walk(40)
STILL = CHARACTERS[0].morphology
GROWING = AnimatedMorphology.from_bodies(*(each.morphology for each in CHARACTERS), np.linspace(0.0, 1.0, 40))
CORNERS = np.array([[-9.0, -9.0, 0.0], [9.0, -9.0, 0.1], [0.0, 9.0, 0.2]])
HUMP = SurfaceMesh(vertices=CORNERS, triangles=np.array([[0, 1, 2]]))
MAP = HeightMap(heights=np.ones((3, 4)))
GROUNDS = Ground(0.1), Bumps(), MAP, Slope(), Steps(), HUMP, Slope().seen_from((1.0, 0.5), 0.3)
PYRAMID = TriangleMesh(
    [[0.3, 0.0, 0.0], [-0.2, 0.3, 0.0], [-0.2, -0.3, 0.0], [0.0, 0.0, 0.4]],
    [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
)
WRIST = BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True)


def do_everything() -> None:
    """Each of these ends; what becomes of it is others' to test."""
    read_files()
    search_library()
    play_live()
    for request in scenes():
        solve(request)
    moment = replace(WALK, channels=WALK.channels[:1])
    standing = tuple(replace(each, first=0, last=0) for each in FEET if each.first == 0)
    adapt(AdaptRequest(moment, STILL, standing))
    for blending in Blending:
        adapted, worn = adapt(AdaptRequest(WALK, STILL)), CHARACTERS[0]
        posed = adapted.positions[0], adapted.rotations[0]
        skin_vertices(worn.skin, worn.build, worn.morphology, *posed, blending=blending)


def search_library() -> None:
    """Index the examples and search them, as it is read from disk and as it stands in memory."""
    with TemporaryDirectory() as folder, Catalogue(Path(folder)) as catalogue:
        index_folders(catalogue, [example_captures_folder()])
        library = Library.of(catalogue)
        for each in (library, Library.of_clips(list(library.clips))):
            motion = each.clips[0].take.motion
            search_strikes(each, StrikeQuery(replace(motion, channels=motion.channels[:1]), STILL, (0.5, 0.0, 1.2)))


def play_live() -> None:
    """A body comes in by VMC, and plays on another one that is asked something."""
    inbox, (positions, rotations) = Inbox(), realize_motion(WALK, STILL)
    for packet in packets_of(positions[0], rotations[0], STILL, 0.0):
        inbox.receive(packet)
    pose = ReceivedPose(inbox)()
    assert pose is not None
    for request in asking(AdaptRequest(WALK, STILL, FEET), [("position",)]):
        driven_frame(request, 20, pose, LiveGrounding(), 0.0)


def read_files() -> None:
    """Captures are read, normalised and compared."""
    for path in (Path(__file__).parents[2] / "examples" / "captures").glob("*.bvh"):
        capture = load_capture(path)
        detected_contacts(capture, "motion")
        round_trip(capture, *normalize_capture(capture))
    normalize_capture(make_capture(frames=5))


def scenes() -> Iterator[AdaptRequest]:
    """Every kind of constraint by itself and three at once, on still and growing bodies and every ground."""
    kinds = [(kind,) for kind in KINDS] + [(kind, "position", "area") for kind in KINDS]
    for body, ground in product((STILL, GROWING), GROUNDS):
        yield from asking(AdaptRequest(WALK, body, FEET, ground=ground), [("position",)])
    for body, point in product((STILL, GROWING), ContactPoint):
        contacts = (*FEET, ContactInterval("walk", point, 5, 30))
        yield from asking(AdaptRequest(WALK, body, contacts), [("position", "balance")])
    for body in STILL, GROWING:
        yield from asking(AdaptRequest(WALK, body, FEET, actor=STILL), [*kinds, (*KINDS,)])
    apart = asking(AdaptRequest(WALK, STILL), [("position",), ("area", "orientation")])
    for request, shape in product(apart, EaseShape):
        curve = ActivationCurve(0.1, 0.2, 0.4, 0.5, shape)
        yield replace(request, constraints=tuple(replace(each, activation=curve) for each in request.constraints))
    fields = {"motion_id": "walk", "name": "", "point": WRIST, "chain": Chain(), "priority": 0, "activation": ALWAYS}
    for asked in (
        PositionConstraint(**fields, target=KeyedPlace((0.0, 0.5), ((0.4, 0.2, 1.0), (0.5, 0.3, 1.4)))),
        PositionConstraint(**fields, target=FollowBody(BodyPoint(BodyPart.HEAD))),
        AreaConstraint(**fields, shape=AreaShape.MESH, mesh=PYRAMID, heading=KeyedNumber((0.0,), (1.0,))),
        OrientationConstraint(**fields, target=KeyedTurn((0.0,), ((0.0, 0.0, 0.0, 1.0),))),
        OrientationConstraint(**fields, target=FollowBody(BodyPoint(BodyPart.HEAD))),
    ):
        yield AdaptRequest(WALK, STILL, FEET, (asked,))


def asking(request: AdaptRequest, sets: Sequence[Sequence[str]]) -> Iterator[AdaptRequest]:
    """``request``, and what it is with each of some ``sets`` of kinds of constraints."""
    before = adapt(request)
    yield request
    for kinds in sets:
        scene = Scene(before, 0, kinds)
        yield replace(request, constraints=scene.constraints, tracks=scene.tracks)


def solve(request: AdaptRequest) -> None:
    """As a whole and a window of it, with limits and easing and without, and report of it."""
    for kept in (True, False):
        asked = replace(request, limited=kept, eased=kept)
        report_of(grounded_motion_of(asked), asked, adapt(asked))
    adapt(request, 5, 8)
