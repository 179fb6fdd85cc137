"""Live input: a body on another one with its constraints, senders, floods, recordings, and the way out."""

import resource
import signal
import socket
import threading
import time

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.activation import ActivationCurve
from studio.core.errors import StudioError
from studio.core.normalized.realize import realize_motion
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptRequest
from studio.io.project.character_file import bundled_characters
from studio.live import tracker
from studio.live.driving import ReceivedPose, driven_frame
from studio.live.live_grounding import LiveGrounding
from studio.live.osc import encode_message
from studio.live.recording import Recorder, Replay, read_recording, write_recording
from studio.live.streamer import Broadcast, StreamedPose, packets_of
from studio.live.tracker import LOOPBACK, Inbox, UdpInput
from studio.live.vmc import BONE_ADDRESS, TRACKER_ADDRESS
from tests.core.motions import walk
from tests.live.hostile_bones import play
from tests.patience import SECONDS, eventually

BODIES = {name: character.morphology for name, character in bundled_characters().items()}
CHILD, GIANT = BODIES["child"], BODIES["giant"]
WALK = walk(40)[0]
WRIST = BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True)


def child_inbox(frame=13):
    inbox, (positions, rotations) = Inbox(), realize_motion(WALK, CHILD)
    for packet in packets_of(positions[frame], rotations[frame], CHILD, 0.0):
        inbox.receive(packet)
    return inbox


def marker(x):
    return encode_message(TRACKER_ADDRESS, ["Cap", x, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])


def test_a_body_that_comes_in_plays_on_another_as_its_capture_would():
    pose = ReceivedPose(child_inbox())()
    shown = driven_frame(AdaptRequest(WALK, GIANT), 13, pose, LiveGrounding(), 0.0)
    ankle = GIANT.layout.ankle_point(0)
    there = adapt(AdaptRequest(WALK, GIANT)).positions[13]
    assert shown.first_frame == 13
    assert np.linalg.norm(shown.positions[0, ankle] - there[ankle]) < 0.01 * GIANT.leg_length
    assert np.linalg.norm(shown.positions[0, 0] - there[0]) < 0.01 * GIANT.leg_length


@pytest.mark.parametrize(("frame", "held"), [(20, True), (35, False)])
def test_what_is_asked_at_that_moment_is_asked_of_it(frame, held):
    place = realize_motion(WALK, GIANT)[0][20, GIANT.layout.wrist_point(1)] + [0.1, 0.0, 0.1]
    curve = ActivationCurve(*(each / WALK.frame_rate for each in (15, 18, 22, 25)))
    asked = PositionConstraint("walk", "Wrist", WRIST, Chain(trunk=1.0), 0, curve, target=tuple(place.tolist()))
    shown = driven_frame(
        AdaptRequest(WALK, GIANT, constraints=(asked,)), frame, ReceivedPose(child_inbox(20))(), LiveGrounding(), 0.0
    )
    missed = np.linalg.norm(shown.positions[0, GIANT.layout.wrist_point(1)] - place)
    assert (missed < 1e-3) == held


def test_a_body_whose_bones_are_missing_is_none():
    inbox = Inbox()
    inbox.receive(marker(1.0))
    assert ReceivedPose(inbox)() is None


def test_a_sender_is_noted_before_it_is_heard_and_heard_once_it_is_switched_on():
    inbox = Inbox()
    listener = UdpInput(inbox, 0, senders=[])
    try:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
            out.sendto(marker(1.0), ("127.0.0.1", listener.port))
            assert eventually(lambda: "127.0.0.1" in listener.senders)
            assert inbox.position_of(["Cap"]) is None
            listener.senders["127.0.0.1"].on = True
            out.sendto(marker(1.0), ("127.0.0.1", listener.port))
            assert eventually(lambda: inbox.position_of(["Cap"]) is not None)
        assert listener.senders["127.0.0.1"].packets == 2
    finally:
        listener.close()


def test_a_flood_is_taken_no_faster_than_a_window_can_bear():
    inbox = Inbox()
    listener = UdpInput(inbox, 0)
    try:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
            begun = time.monotonic()
            while time.monotonic() - begun < 0.5:
                out.sendto(b"x" * 64, ("127.0.0.1", listener.port))
            seconds = time.monotonic() - begun
        most = tracker.MAX_PACKETS_PER_SLICE * (seconds / tracker.SLICE_SECONDS + 2)
        assert 0 < inbox.counts.malformed <= most
    finally:
        listener.close()


def test_what_is_recorded_is_what_came_and_is_replayed(tmp_path):
    path, inbox = tmp_path / "session.osc", Inbox()
    recorder, listener = Recorder(path), UdpInput(inbox, 0)
    listener.kept = recorder.record_packet
    try:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
            for x in (1.0, 2.0):
                out.sendto(marker(x), ("127.0.0.1", listener.port))
                time.sleep(0.02)
            assert eventually(lambda: recorder.count == 2)
    finally:
        listener.close()
        recorder.close()
    assert [packet for _, packet in read_recording(path)] == [marker(1.0), marker(2.0)]
    again = Inbox()
    replay = Replay(path, again)
    try:
        assert eventually(lambda: again.counts.accepted >= 4)  # it begins anew at its end
    finally:
        replay.close()
    assert abs(again.position_of(["Cap"])[1]) in (1.0, 2.0)


def test_an_empty_or_damaged_recording_is_refused_before_anything_is_fed(tmp_path):
    path, inbox = tmp_path / "session.osc", Inbox()
    Recorder(path).close()
    with pytest.raises(StudioError, match="no datagrams"):
        Replay(path, inbox)
    path.write_bytes(b"nothing of that kind")
    with pytest.raises(StudioError, match="not a recording"):
        Replay(path, inbox)
    with pytest.raises(StudioError, match="Choose another place"):
        Recorder(tmp_path / "no such folder" / "session.osc")


@pytest.mark.parametrize("cut", [1, 11, 12, 40, 60])
def test_of_a_recording_that_is_cut_off_what_is_whole_is_replayed_and_the_rest_is_told(tmp_path, cut):
    path = tmp_path / "session.osc"
    write_recording(path, [(0.01 * k, marker(float(k))) for k in range(5)])
    path.write_bytes(path.read_bytes()[:-cut])
    recording = read_recording(path)
    assert [packet for _, packet in recording] == [marker(float(k)) for k in range(len(recording.packets))]
    assert len(recording.packets) == 4
    assert "4 packets before it" in recording.problem
    replay = Replay(path, inbox := Inbox())
    try:
        assert replay.problem == recording.problem
        assert eventually(lambda: inbox.counts.accepted >= 4)
    finally:
        replay.close()


@pytest.mark.parametrize("room", [8, 20, 61, 63, 100, 150])
def test_a_full_disk_ends_a_recording_after_the_last_whole_packet_and_is_told(tmp_path, room):
    path, packets = tmp_path / "session.osc", [marker(float(k)) for k in range(5)]
    recorder = Recorder(path)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (room, before[1]))
    try:
        for k, packet in enumerate(packets):
            recorder.record_packet(0.1 * k, packet)  # as the thread that receives does: nothing may be raised
        recorder.close()
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, handler)
    recording = read_recording(path)
    assert recording.problem == ""
    assert [packet for _, packet in recording] == packets[: recorder.count]
    assert f"ends after {recorder.count} packets" in recorder.problem
    assert recorder.count == (room - 8) // (12 + len(packets[0]))


def test_a_replay_of_many_packets_of_one_time_closes_at_once_and_feeds_no_flood(tmp_path):
    path, inbox = tmp_path / "session.osc", Inbox()
    write_recording(path, [(0.0, marker(float(k % 7))) for k in range(200_000)])
    replay = Replay(path, inbox)
    try:
        assert eventually(lambda: inbox.counts.accepted >= 2)
    finally:
        begun = time.process_time()
        replay.close()
    assert time.process_time() - begun < 1.0
    assert inbox.counts.accepted < 100_000


def test_hostile_bodies_drive_a_performer_or_are_none():
    assert {play(seed) for seed in range(60)} == {True, False}


def test_a_body_whose_shoulders_have_no_breadth_is_a_body():
    inbox = child_inbox()
    for side in ("Left", "Right"):
        inbox.receive(encode_message(BONE_ADDRESS, [f"{side}UpperArm", 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]))
    pose = ReceivedPose(inbox)()
    shown = driven_frame(AdaptRequest(WALK, GIANT), 13, pose, LiveGrounding(), 0.0)
    assert np.isfinite(shown.positions).all()


def test_several_bodies_go_out_each_to_its_own_port_and_who_cannot_be_reached_is_told():
    inboxes = Inbox(), Inbox()
    listeners = [UdpInput(inbox, 0) for inbox in inboxes]
    out = Broadcast()
    bodies = [
        StreamedPose(listener.port, *(part[13] for part in realize_motion(WALK, body)), body)
        for listener, body in zip(listeners, (CHILD, GIANT), strict=True)
    ]
    try:
        out.show(bodies, 0.0)
        assert eventually(lambda: all(ReceivedPose(inbox)() is not None for inbox in inboxes))
        heights = [inbox.position_of(["Head"])[2] for inbox in inboxes]
        assert heights[0] < heights[1]
    finally:
        out.close()
        for listener in listeners:
            listener.close()
    nowhere = Broadcast("not an address")
    nowhere.show(bodies, 0.0)
    assert eventually(lambda: "Nothing can be sent to not an address" in nowhere.problem)
    assert "Errno" not in nowhere.problem
    assert nowhere.problem.endswith("Choose another address.")
    nowhere.close()


def test_the_window_does_not_wait_for_a_host_that_is_looked_for(monkeypatch):
    found, answered = threading.Event(), []

    def look_for(_: str) -> str:
        found.wait(SECONDS)
        answered.append(LOOPBACK)
        return LOOPBACK

    monkeypatch.setattr(socket, "gethostbyname", look_for)
    out = Broadcast("far.example")
    out.show([], 0.0)
    time.sleep(0.05)
    out.close()
    assert not answered
    found.set()
