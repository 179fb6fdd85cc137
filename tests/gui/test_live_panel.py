"""The Live panel: a body and a head come in, drive a performer and a prop, are recorded; what is shown goes out."""

import socket
import time

import numpy as np
import pytest
from PySide6.QtCore import QCoreApplication, QEvent
from shiboken6 import isValid

from studio.app.application import make_window
from studio.app.settings import Settings
from studio.core.normalized.realize import realize_motion
from studio.core.stage.placement import Placement
from studio.core.stage.prop import Prop
from studio.document.document import Document
from studio.io.project.character_file import bundled_characters
from studio.live.osc import encode_message
from studio.live.recording import read_recording
from studio.live.streamer import packets_of
from studio.live.tracker import Inbox, UdpInput
from studio.live.vmc import TRACKER_ADDRESS, posed_body
from studio.viewport.eyes import ONE_EYE
from tests.builders import make_project
from tests.core.motions import walk
from tests.gui.window_use import PATIENCE, same

CHILD = bundled_characters()["child"].morphology


@pytest.fixture
def control(window, qtbot):
    assert window.bench.live.wait_until_solved(PATIENCE / 1000)
    window.actions_by_id.by_id["live_panel"].trigger()
    assert window.docks["Live"].isVisible()
    window.live_control.listen(0)
    return window.live_control


def send(control, *packets):
    port = control.sources["1"].feeder.port
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
        for packet in packets:
            out.sendto(packet, ("127.0.0.1", port))


def child_packets(frame=13):
    positions, rotations = realize_motion(walk(40)[0], CHILD)
    return packets_of(positions[frame], rotations[frame], CHILD, 0.0)


def cap(x):
    """Unity's z is forward."""
    return encode_message(TRACKER_ADDRESS, ["Cap", 0.0, 1.5, x, 0.0, 0.0, 0.0, 1.0])


def test_a_body_drives_a_performer_and_its_own_clips_play_again_after_it(control, window, qtbot):
    document, live = window.bench.document, window.bench.live
    key = document.active_performer_id
    before, project = live.shown_frame(key), document.project
    control.drive(key, "1")
    send(control, *child_packets())

    def is_driven():
        live.solve_frame(0.0)
        return live.shown_frame(key) is not before

    qtbot.waitUntil(is_driven, timeout=PATIENCE)
    height = live.shown_frame(key).positions[0, before.morphology.layout.head_end, 2]
    assert abs(height / before.morphology.stature - 1.0) < 0.2
    assert document.project is project  # what comes in is no edit
    control.close_source("1")
    live.solve_frame(0.0)
    assert live.shown_frame(key) is before
    assert not control.drivers


def test_a_tracked_head_moves_a_prop_and_all_of_it_is_one_undo_step(control, window, qtbot):
    document = window.bench.document
    prop_id = document.add("props", Prop("Target", (0.1, 0.1, 0.1), (0.5, 0.0, 1.0)), "Add Target")
    before, steps = document.project, document.undo_stack.count()
    control.track("1", "Cap", prop_id)
    for x in (1.0, 1.2, 1.4):
        send(control, cap(x))
        qtbot.waitUntil(lambda x=x: abs(document.project.props[prop_id].position[0] - x) < 1e-6, timeout=PATIENCE)
    assert document.project.props[prop_id].position == pytest.approx((1.4, 0.0, 1.5), abs=1e-6)
    assert document.undo_stack.count() == steps + 1
    document.undo_stack.undo()
    assert same(document.project, before)


def test_the_panel_tells_senders_and_counts_and_switches_them_off(control, window, qtbot):
    panel = control.panel
    send(control, cap(1.0), b"no packet at all")
    qtbot.waitUntil(lambda: control.sources["1"].inbox.counts.malformed == 1, timeout=PATIENCE)
    control.update_counts()
    assert "1 packets received, 1 invalid" in panel.told.text()
    [sender] = [panel.inputs.topLevelItem(0).child(0)]
    assert sender.text(0) == "127.0.0.1"
    sender.setCheckState(0, sender.checkState(0).Unchecked)
    send(control, cap(2.0))
    qtbot.waitUntil(lambda: control.sources["1"].inbox.counts.unknown_senders == 1, timeout=PATIENCE)


def test_what_comes_is_recorded_and_replayed_as_a_source_of_its_own(control, window, qtbot, tmp_path):
    said = []
    window.bench.message_posted.connect(lambda message: said.append(message.sentence))
    path = tmp_path / "take.osc"
    control.record(path)
    send(control, cap(1.0))
    qtbot.waitUntil(lambda: control.recorder.count == 1, timeout=PATIENCE)
    control.stop_recording()
    assert said == ["take.osc holds 1 packet."]
    assert len(list(read_recording(path))) == 1
    control.replay(path)
    qtbot.waitUntil(lambda: control.sources["2"].inbox.position_of(["Cap"]) is not None, timeout=PATIENCE)
    control.replay(tmp_path / "none.osc")
    assert len(said) == 2
    assert control.panel.inputs.topLevelItemCount() == 2


def test_another_recording_ends_the_one_before_it_whole(control, window, qtbot, tmp_path):
    first, second = tmp_path / "first.osc", tmp_path / "second.osc"
    control.record(first)
    send(control, cap(1.0))
    qtbot.waitUntil(lambda: control.recorder.count == 1, timeout=PATIENCE)
    control.record(second)
    assert len(list(read_recording(first))) == 1
    control.stop_recording()
    assert len(list(read_recording(second))) == 0


def test_a_port_that_is_taken_is_a_sentence_and_nothing_else(control, window):
    said = []
    window.bench.message_posted.connect(lambda message: said.append(message.sentence))
    control.listen(control.sources["1"].feeder.port)
    assert "Choose another port" in said[-1]
    assert list(control.sources) == ["1"]


def test_what_is_shown_goes_out_where_it_stands_on_the_stage(control, window, qtbot):
    inbox = Inbox()
    listener = UdpInput(inbox, 0)
    try:
        control.panel.out_port.show_value(listener.port)
        window.actions_by_id.by_id["stream"].trigger()
        qtbot.waitUntil(lambda: posed_body(inbox.bones()) is not None, timeout=PATIENCE)
        key, performer = next(iter(window.bench.document.project.performers.items()))
        shown = window.bench.live.shown_frame(key)
        there = Placement.of(performer).to_stage(shown.positions[0, 0])
        assert np.linalg.norm(inbox.bones()["Hips"].position - there) < 1e-3
        assert str(listener.port) in control.panel.out_told.text()
        window.actions_by_id.by_id["stream"].trigger()
        assert control.broadcast is None
    finally:
        listener.close()


class SeenViewport:
    """A 3D view that tells from where it is to look."""

    stereo_view = ONE_EYE

    def set_stereo_view(self, stereo_view):
        self.stereo_view = stereo_view

    def schedule_redraw(self):
        """Nothing is drawn."""


def test_the_camera_goes_with_a_head_from_where_it_was_and_back(control, window, qtbot):
    said = []
    window.bench.message_posted.connect(lambda message: said.append(message.sentence))
    control.track_camera(True)
    assert "No head is being tracked" in said[-1]
    window.bench.set_viewport(SeenViewport())
    control.panel.names.setText("Cap")
    control.panel.head.show_value("1")
    send(control, cap(1.0))
    qtbot.waitUntil(lambda: control.sources["1"].inbox.position_of(["Cap"]) is not None, timeout=PATIENCE)
    control.track_camera(True)
    send(control, cap(1.1))
    qtbot.waitUntil(lambda: window.bench.viewport.stereo_view != ONE_EYE, timeout=PATIENCE)
    assert window.bench.viewport.stereo_view.head.back == pytest.approx(-0.1, abs=1e-6)  # nearer to the screen
    control.track_camera(False)
    assert window.bench.viewport.stereo_view == ONE_EYE
    window.bench.set_viewport(None)


def test_a_flood_leaves_the_window_alive(control, window, qtbot):
    packets, ticks, last = [*child_packets(), b"\xff" * 200], [], time.thread_time()
    control.drive(window.bench.document.active_performer_id, "1")
    begun = time.perf_counter()
    while time.perf_counter() - begun < 1.0:
        send(control, *packets)
        qtbot.wait(1)
        ticks.append(time.thread_time() - last)
        last = time.thread_time()
    assert np.median(ticks) < 0.033  # seconds of its own thread at work


def test_what_is_still_asked_of_a_window_that_closes_keeps_no_clock_going(qapp, tmp_path):
    window = make_window(Settings(tmp_path / "studio.ini"), Document(make_project()))
    control = window.live_control
    window.close_without_saving()
    control.listen(0)
    window.deleteLater()
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
    assert not isValid(control.panel)
    assert not any(map(isValid, (control._tick, control._telling)))
    for source in control.sources.values():
        source.feeder.close()
