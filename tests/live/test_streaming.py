"""Bodies streamed out are read back, by an independent library and by ourselves; what is hostile is only counted."""

import socket
import tracemalloc

import numpy as np
import pytest
from pythonosc.osc_bundle import OscBundle
from scipy.spatial.transform import Rotation

from studio.core.errors import StudioError
from studio.core.normalized.encode import encode_motion
from studio.core.normalized.realize import realize_motion
from studio.io.project.character_file import bundled_characters
from studio.live import vmc
from studio.live.osc import encode_message
from studio.live.recording import read_recording, write_recording
from studio.live.streamer import LARGEST_BUNDLE, Streamer, packets_of
from studio.live.tracker import MAX_NAMES, TRACKED_RANGE_METRES, Inbox, UdpInput
from tests.builders import make_morphology
from tests.core.motions import walk
from tests.patience import eventually

BODIES = {name: character.morphology for name, character in bundled_characters().items()}
BODIES["of a long spine"] = make_morphology(spine_count=6)


def frame_of(body, frame=13):
    positions, rotations = realize_motion(walk(40)[0], body)
    return positions[frame], rotations[frame]


def received(body, frame=13):
    inbox = Inbox()
    for packet in packets_of(*frame_of(body, frame), body, 0.5):
        inbox.receive(packet)
    return inbox


@pytest.mark.parametrize("name", BODIES)
def test_our_own_stream_read_back_is_the_same_pose_within_a_tenth_of_a_degree(name):
    body = BODIES[name]
    positions, rotations = frame_of(body)
    found = vmc.posed_body(received(body).bones())
    assert found is not None
    back_positions, back_rotations, back = found
    ours = {each.name: each.segment for each in vmc.bone_segments(body.layout)}
    theirs = {each.name: each.segment for each in vmc.bone_segments(back.layout)}
    for bone, segment in theirs.items():
        turn = Rotation.from_matrix(back_rotations[segment].T @ rotations[ours[bone]])
        assert np.degrees(turn.magnitude()) < 0.1
    assert np.linalg.norm(back_positions[0] - positions[0]) < 1e-4
    for side in (0, 1):
        for ends in (vmc.BodyLayout.ankle_point, vmc.BodyLayout.wrist_point):
            assert np.linalg.norm(back_positions[ends(back.layout, side)] - positions[ends(body.layout, side)]) < 1e-3


def test_an_independent_reader_finds_every_bone_once_in_packets_of_the_size_allowed():
    body = BODIES["child"]
    names = []
    for packet in packets_of(*frame_of(body), body, 0.5):
        assert len(packet) <= LARGEST_BUNDLE
        for message in OscBundle(packet):
            if message.address == vmc.BONE_ADDRESS:
                names.append(message.params[0])
                assert len(message.params) == 8
                assert np.linalg.norm(message.params[4:]) == pytest.approx(1.0, abs=1e-6)
    assert names == [each.name for each in vmc.bone_segments(body.layout)]


def test_a_received_body_plays_on_another():
    found = vmc.posed_body(received(BODIES["child"]).bones())
    positions, rotations, body = found
    motion = encode_motion(positions[None], rotations[None], body, 60.0)
    put = realize_motion(motion, BODIES["giant"])[1][0]
    giant = frame_of(BODIES["giant"])[1]
    layout = BODIES["giant"].layout
    thigh = layout.segment_of_part(vmc.BodyPart.LEFT_THIGH)
    assert np.degrees(Rotation.from_matrix(put[thigh].T @ giant[thigh]).magnitude()) < 3.0


def test_unity_axes_are_ours_seen_in_a_mirror():
    bone = vmc.from_unity([1.0, 2.0, 3.0], [0.0, 0.0, 0.0, 1.0])
    assert bone.position.tolist() == [3.0, -1.0, 2.0]
    quarter = np.sqrt(0.5)
    turn = vmc.from_unity([0.0] * 3, [0.0, quarter, 0.0, quarter]).rotation  # about up, forward goes to the right
    assert Rotation.from_quat(turn).apply([1.0, 0.0, 0.0]) == pytest.approx([0.0, -1.0, 0.0], abs=1e-9)
    there = vmc.to_unity(vmc.from_unity([1.0, 2.0, 3.0], [0.1, 0.2, 0.3, 0.9]))
    assert there[0].tolist() == [1.0, 2.0, 3.0]
    assert there[1] == pytest.approx([0.1, 0.2, 0.3, 0.9])


def bone_message(name, *numbers):
    return encode_message(vmc.TRACKER_ADDRESS, [name, *numbers])


def test_the_newest_value_wins_and_a_head_is_the_mean_of_its_markers():
    inbox = Inbox()
    assert inbox.position_of(["a"]) is None
    for name, x in (("a", 9.0), ("a", 1.0), ("b", 3.0)):
        inbox.receive(bone_message(name, x, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0))
    assert inbox.position_of(["a", "b"]).tolist() == [0.0, -2.0, 0.0]
    assert inbox.position_of(["a", "c"]) is None


def test_a_bone_gives_its_place_in_the_world():
    body = BODIES["child"]
    head = frame_of(body)[0][body.layout.head_joint]
    assert received(body).position_of(["Head"]) == pytest.approx(head, abs=1e-3)
    assert received(body).position_of(["No such bone"]) is None


def test_what_is_no_number_is_refused_and_what_is_absurd_is_clamped():
    inbox = Inbox()
    still = [0.0, 0.0, 0.0, 1.0]
    for numbers in ([float("nan"), 0.0, 0.0, *still], [0.0, float("inf"), 0.0, *still], [0.0] * 7, [1.0, 2.0]):
        inbox.receive(bone_message("a", *numbers))
    inbox.receive(encode_message(vmc.BONE_ADDRESS, [b"a", *([0.0] * 7)]))
    assert inbox.counts.refused_values == 5
    assert inbox.position_of(["a"]) is None
    inbox.receive(bone_message("a", 1e30, 0.0, 0.0, *still))
    assert abs(inbox.position_of(["a"])).max() == TRACKED_RANGE_METRES


def test_hostile_packets_are_counted_and_leave_the_memory_as_it_is():
    inbox = Inbox()
    random = np.random.default_rng(1)
    noise = [random.integers(0, 256, 64).astype(np.uint8).tobytes() for _ in range(50)]
    names = [bone_message(f"name {k}", *([0.0] * 6), 1.0) for k in range(2 * MAX_NAMES)]
    for packet in names:
        inbox.receive(packet)
    assert inbox.counts.refused_values == MAX_NAMES
    tracemalloc.start()
    before = tracemalloc.get_traced_memory()[0]
    for _ in range(40):
        for packet in noise:
            inbox.receive(packet)
    grown = tracemalloc.get_traced_memory()[0] - before
    tracemalloc.stop()
    assert inbox.counts.malformed == 40 * len(noise)
    assert grown < 20_000


def test_only_listed_senders_are_heard_over_udp():
    inbox, deaf = Inbox(), Inbox()
    listener, other = UdpInput(inbox, 0), UdpInput(deaf, 0, senders=["10.1.2.3"])
    body = BODIES["child"]
    try:
        with Streamer(listener.port) as streamer, Streamer(other.port) as stranger:
            streamer.send(*frame_of(body), body, 0.0)
            stranger.send(*frame_of(body), body, 0.0)
            assert eventually(lambda: vmc.posed_body(inbox.bones()) is not None and deaf.counts.unknown_senders)
    finally:
        listener.close()
        other.close()
    assert vmc.posed_body(inbox.bones()) is not None
    assert deaf.counts.unknown_senders > 0
    assert deaf.counts.accepted == 0


def test_a_port_that_is_taken_is_told():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        with pytest.raises(StudioError, match="Choose another port"):
            UdpInput(Inbox(), taken.getsockname()[1])


@pytest.mark.parametrize("address", ["no-such-host.invalid", "a..b", "x" * 80])
def test_an_address_that_cannot_be_found_is_told_before_anything_is_sent(address):
    with pytest.raises(StudioError, match=r"Nothing can be sent to .*Choose another address"):
        Streamer(39_540, address)
    with pytest.raises(StudioError, match=r"Nothing can listen at .*Choose another port or address"):
        UdpInput(Inbox(), 0, address)


def test_a_recording_is_replayed_as_it_came_and_a_damaged_one_is_told(tmp_path):
    body, path = BODIES["child"], tmp_path / "session.osc"
    packets = [(0.1 * k, packet) for k, packet in enumerate(packets_of(*frame_of(body), body, 0.0))]
    write_recording(path, packets)
    assert list(read_recording(path)) == packets
    path.write_bytes(path.read_bytes()[:-3])
    cut_off = read_recording(path)
    assert list(cut_off) == packets[:-1]
    assert f"the {len(packets) - 1} packets before it are played" in cut_off.problem
    path.write_bytes(b"something else")
    with pytest.raises(StudioError, match="not a recording"):
        list(read_recording(path))
