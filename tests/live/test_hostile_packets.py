"""Packets of any content are counted or taken, clamped and bounded; nothing is raised."""

import math
from random import Random

import numpy as np

from studio.live import vmc
from studio.live.osc import bundles, encode_message
from studio.live.tracker import MAX_NAMES, TRACKED_RANGE_METRES, Inbox

PACKETS = 20_000
NUMBERS = (0.0, 1.0, -1e30, 1e38, math.nan, math.inf, 0.7)


def packet(random: Random) -> bytes:
    """One that is nearly right, or no packet at all."""
    if random.random() < 0.2:
        return random.randbytes(random.randrange(200))
    name = random.choice(["Hips", "Head", "LeftHand", "../../etc/passwd", str(random.random())])
    address = random.choice(
        [vmc.BONE_ADDRESS, vmc.TRACKER_ADDRESS, vmc.ROOT_ADDRESS, vmc.HMD_ADDRESS, vmc.OK_ADDRESS, "/x"]
    )
    numbers = [random.choice(NUMBERS) for _ in range(random.choice([7, 7, 7, 3, 20]))]
    [made] = bundles([encode_message(address, [name, *numbers])], 60_000)
    changed = bytearray(made)
    for _ in range(random.choice([0, 0, 1, 4])):
        changed[random.randrange(len(changed))] = random.randrange(256)
    return bytes(changed[: random.randrange(len(changed))] if random.random() < 0.1 else changed)


def test_hostile_packets_are_counted_or_taken_and_nothing_else() -> None:
    random, inbox = Random(0), Inbox()
    for _ in range(PACKETS):
        inbox.receive(packet(random))
    counts = inbox.counts
    assert counts.accepted + counts.malformed == PACKETS
    assert min(counts.accepted, counts.malformed, counts.refused_values) > PACKETS // 100
    bones = inbox.bones()
    assert 0 < len(bones) <= MAX_NAMES
    for bone in bones.values():
        assert np.isfinite(bone.rotation).all()
        assert np.abs(bone.position).max() <= TRACKED_RANGE_METRES
