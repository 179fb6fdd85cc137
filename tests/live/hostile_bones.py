"""Bodies as nobody sends them, one a seed: bones in one place, far off, turned anyhow, or missing."""

from random import Random

import numpy as np

from studio.core.normalized.realize import realize_motion
from studio.core.solver.request import AdaptRequest
from studio.io.project.character_file import bundled_characters
from studio.live import vmc
from studio.live.driving import ReceivedPose, driven_frame
from studio.live.live_grounding import LiveGrounding
from studio.live.osc import encode_message
from studio.live.tracker import TRACKED_RANGE_METRES, Inbox
from tests.core.motions import walk

BODIES = {name: character.morphology for name, character in bundled_characters().items()}
WALK = walk(20)[0]
PLACES = (0.0, 1e-30, 1e-6, 1e-3, 0.3, TRACKED_RANGE_METRES, -TRACKED_RANGE_METRES, 1e30)


def hostile_inbox(random: Random) -> Inbox:
    """The bones of a child, some of which are changed."""
    positions, rotations = realize_motion(WALK, BODIES["child"])
    bones = vmc.bones_of(positions[5], rotations[5], BODIES["child"])
    count = random.choice([1, 1, 2, 5, len(bones)])
    places, spread = PLACES if random.random() < 0.7 else (0.0,), random.choice([0.0, 0.0, 1.0])
    inbox = Inbox()
    changed = random.sample(sorted(bones), count)
    for name, bone in bones.items():
        place, turn = vmc.to_unity(bone)
        if name in changed:
            place = np.array([random.choice(places) for _ in range(3)]) + spread * place
            if random.random() < 0.3:
                turn = np.array([random.choice((0.0, 1.0, -1.0, 0.3)) for _ in range(4)])
            if random.random() < 0.1:
                continue
        inbox.receive(encode_message(vmc.BONE_ADDRESS, [name, *place.tolist(), *turn.tolist()]))
    return inbox


def play(seed: int) -> bool:
    """Let a hostile body drive a performer; returns whether it was one. Raises AssertionError for NaN."""
    random = Random(seed)
    inbox = hostile_inbox(random)
    inbox.position_of(["Head"])
    pose = ReceivedPose(inbox)()
    if pose is None:
        return False
    shown = driven_frame(AdaptRequest(WALK, BODIES[random.choice(["child", "giant"])]), 13, pose, LiveGrounding(), 0.0)
    assert np.isfinite(shown.positions).all(), "positions that are not finite"
    return True
