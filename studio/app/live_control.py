"""Live input and output: ports, recordings, the performers and props that they drive, and the outgoing stream.

Threads read and write sockets and files; the window takes the newest values at each tick of its own timer.
"""

import time
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QTimer

from studio.app.file_dialogs import ask_file, ask_new_file
from studio.app.workbench import Workbench
from studio.core.constraints.follow import FollowProp
from studio.core.constraints.target import follows_of
from studio.core.errors import StudioError
from studio.engine.posed_performer import displayed_stage
from studio.live.recording import Recorder, Replay
from studio.live.streamer import Broadcast, StreamedPose
from studio.live.tracker import LOOPBACK, PORT, Inbox, UdpInput
from studio.panels.live_panel import InputRow, LivePanel, SenderRow
from studio.viewport.eyes import CENTRE_EYE, EyePosition

if TYPE_CHECKING:
    from studio.engine.driven import PoseSource  # loads the solver

FloatArray = NDArray[np.float64]

OUT_PORT = PORT + 1
POLL_MILLISECONDS, REPORT_MILLISECONDS = 16, 500
"""Interval at which received values are taken, and interval at which the panel's counts are updated."""
HEAD_MOVE_METRES, HEAD_REST_SECONDS = 0.001, 0.3
"""Metres by which a tracked head must move to count as moving, and seconds without movement after which whole motions
are solved.
"""
RECORDING_FILTER = "OSC recordings (*.osc)"


@dataclass
class LiveSource:
    """Port or recording that receives packets, and the counts that are displayed for it."""

    name: str
    feeder: UdpInput | Replay
    pose: "PoseSource | None" = None
    """Body received from the source; None until it drives a performer."""
    shown_counts: dict[str, int] = field(default_factory=dict)
    """Packets counted at the last update of the panel, by sender; the empty name counts all packets."""

    @property
    def inbox(self) -> Inbox:
        """Newest received values."""
        return self.feeder.inbox

    def rate(self, sender: str, packets: int, seconds: float) -> float:
        """Packets per second of a sender since the last call."""
        before, self.shown_counts[sender] = self.shown_counts.get(sender, packets), packets
        return (packets - before) / max(seconds, 1e-3)


@dataclass(frozen=True)
class TrackedHead:
    """Tracked head that drives a prop: the names of bones or trackers of a source."""

    source: str
    names: tuple[str, ...]
    prop_id: str


class LiveControl:
    """Controller that connects the Live panel, the network threads and the document."""

    def __init__(self, bench: Workbench) -> None:
        self.bench = bench
        self.panel = LivePanel(PORT, LOOPBACK, OUT_PORT)
        self.sources: dict[str, LiveSource] = {}
        self.drivers: dict[str, str] = {}
        """Sources by the performers that they drive."""
        self.tracked: TrackedHead | None = None
        self.head_from: FloatArray | None = None
        """Place of the head when the camera began to go with it; None while the camera does not."""
        self.recorder: Recorder | None = None
        self.broadcast: Broadcast | None = None
        self._out_port, self._seen, self._told_at = OUT_PORT, 0, time.monotonic()
        self._gesture, self._moved_at = 0, 0.0
        self._tick = QTimer(self.panel, interval=POLL_MILLISECONDS)
        self._tick.timeout.connect(self.poll_sources)
        self._telling = QTimer(self.panel, interval=REPORT_MILLISECONDS)
        self._telling.timeout.connect(self.update_counts)
        panel = self.panel
        panel.listen_requested.connect(self.listen)
        panel.replay_requested.connect(lambda: ask_file(bench, "Replay OSC recording", RECORDING_FILTER, self.replay))
        panel.record_requested.connect(self._ask_recording)
        panel.close_requested.connect(self.close_source)
        panel.sender_switched.connect(self.switch)
        panel.body_driven.connect(self.drive)
        panel.head_tracked.connect(self.track)
        panel.performer_shown.connect(lambda key: panel.show_driver(self.drivers.get(key)))
        panel.streaming_requested.connect(self.stream)
        for signal in (bench.document.entity_changed, bench.document.project_opened):
            signal.connect(lambda *_: self._offer())
        self._offer()

    # What the user asks for

    def listen(self, port: int, address: str = LOOPBACK) -> None:
        """Listen at a port; a failure is reported as a message."""
        try:
            feeder = UdpInput(Inbox(), port, address)
        except StudioError as error:
            self.bench.post_message(str(error))
            return
        feeder.kept = self.recorder.record_packet if self.recorder else None
        self._add(LiveSource(f"Port {feeder.port}", feeder))

    def replay(self, path: Path) -> None:
        """Play a recording of datagrams in a loop; a file that is not a recording is reported as a message."""
        try:
            replay = Replay(path, Inbox())
        except StudioError as error:
            self.bench.post_message(str(error))
            return
        self._add(LiveSource(path.name, replay))
        if replay.problem:
            self.bench.post_message(replay.problem)

    def record(self, path: Path) -> None:
        """Write all received datagrams to a file until recording is stopped; ends a recording that runs."""
        self.stop_recording()
        try:
            self.recorder = Recorder(path)
        except StudioError as error:
            self.bench.post_message(str(error))
            return
        self._keep_by(self.recorder)
        self.update_counts()

    def stop_recording(self) -> None:
        """Stop recording and close the file."""
        recorder, self.recorder = self.recorder, None
        if recorder is None:
            return
        self._keep_by(None)
        recorder.close()
        packets = "packet" if recorder.count == 1 else "packets"
        self.bench.post_message(recorder.problem or f"{recorder.path.name} holds {recorder.count} {packets}.")
        self.update_counts()

    def close_source(self, key: str) -> None:
        """Close a source; performers driven by it play their own clips again."""
        source = self.sources.pop(key, None)
        if source is None:
            return
        source.feeder.close()
        for performer_id in [each for each, by in self.drivers.items() if by == key]:
            self.drive(performer_id, "")
        if self.tracked is not None and self.tracked.source == key:
            self._rest()
            self.tracked = None
        self._run()
        self.update_counts()

    def switch(self, key: str, sender: str, on: bool) -> None:
        """Accept or ignore packets from a sender."""
        feeder = self.sources[key].feeder if key in self.sources else None
        if isinstance(feeder, UdpInput) and sender in feeder.senders:
            feeder.senders[sender].on = on

    def drive(self, performer_id: str, key: str) -> None:
        """Drive a performer by the body received from a source; an empty ``key`` lets it play its own clips."""
        from studio.live.driving import ReceivedPose  # loads the solver

        self.drivers.pop(performer_id, None)
        source = self.sources.get(key)
        if source is not None:
            self.drivers[performer_id] = key
            source.pose = source.pose or ReceivedPose(source.inbox)
        self.bench.live.driven.drive(performer_id, source.pose if source else None)
        self._repaint()
        self.update_counts()

    def track(self, key: str, names: str, prop_id: str) -> None:
        """Move a prop with the tracked head of a source; without a source or a prop, stop moving it."""
        wanted = names_in(names)
        self._rest()
        self.tracked = TrackedHead(key, wanted, prop_id) if key in self.sources and wanted and prop_id else None
        self._gesture = self.bench.document.new_gesture()
        self.update_counts()

    def stream(self, on: bool, address: str = LOOPBACK, port: int = OUT_PORT) -> None:
        """Start or stop sending the visible characters as VMC, the first one to ``port`` and each next one to the next
        port.
        """
        if self.broadcast is not None:
            self.broadcast.close()
        self.broadcast, self._out_port = Broadcast(address or LOOPBACK) if on else None, port
        self._run()
        self.update_counts()

    def close(self) -> None:
        """End all threads."""
        self._tick.stop()
        self._telling.stop()
        for source in self.sources.values():
            source.feeder.close()
        for part in (self.broadcast, self.recorder):
            if part is not None:
                part.close()

    # At every tick

    def poll_sources(self) -> None:
        """Take the values received since the last call, and send the visible bodies."""
        taken = sum(source.inbox.counts.accepted for source in self.sources.values())
        if taken != self._seen:
            self._seen = taken
            self._move_target()
            self._move_eye()
            if self.drivers:
                self._repaint()
        elif self._moved_at and time.monotonic() - self._moved_at > HEAD_REST_SECONDS:
            self._rest()
        if self.broadcast is not None:
            self.broadcast.show([body for _, body in self.bodies_to_stream()], time.monotonic())

    def bodies_to_stream(self) -> list[tuple[str, StreamedPose]]:
        """Name and pose on the stage of each visible character."""
        _, _, posed = displayed_stage(self.bench.document, self.bench.live)
        bodies = []
        for index, pose in enumerate(posed.values()):
            turned = pose.placement.rotation @ pose.motion.rotations[pose.row]
            body, fingers = pose.motion.morphology_at(pose.row), pose.streamed_fingers
            streamed = StreamedPose(self._out_port + index, pose.points, turned, body, fingers)
            bodies.append((pose.performer.name, streamed))
        return bodies

    def _move_target(self) -> None:
        tracked, document = self.tracked, self.bench.document
        prop = document.project.props.get(tracked.prop_id) if tracked else None
        if tracked is None or prop is None or tracked.source not in self.sources:
            return
        place = self.sources[tracked.source].inbox.position_of(tracked.names)
        if place is None:
            return
        x, y, z = place.tolist()
        before = prop.position if isinstance(prop.position, tuple) else (0.0, 0.0, -1e9)
        if max(abs(new - old) for new, old in zip((x, y, z), before, strict=True)) < HEAD_MOVE_METRES:
            return
        followed = any(
            follow.prop_id == tracked.prop_id
            for constraint in document.project.constraints.values()
            for follow in follows_of(constraint)
            if isinstance(follow, FollowProp)
        )
        self.bench.live.interactive = followed
        self._moved_at = time.monotonic()
        moved = replace(prop, position=(x, y, z), held=None, later=())
        document.replace("props", tracked.prop_id, moved, f"Track {prop.name}", self._gesture)

    def track_camera(self, on: bool) -> None:
        """Start or stop moving the camera with the tracked head, as if the screen were a window to the stage."""
        place = self._head()
        if on and place is None:
            self.bench.post_message(
                "No head is being tracked. In the Live panel, listen to a port and choose the head to follow."
            )
            return
        self.head_from = place if on else None
        if not on:
            self._look_from(CENTRE_EYE)

    def _head(self) -> FloatArray | None:
        """(3,) position of the tracked head, by the source and the names chosen in the panel; None if it is not
        tracked.
        """
        source = self.sources.get(self.tracked.source if self.tracked else str(self.panel.head.value))
        names = self.tracked.names if self.tracked else names_in(self.panel.names.text())
        return None if source is None else source.inbox.position_of(names)

    def _move_eye(self) -> None:
        place = None if self.head_from is None else self._head()
        if place is not None and self.head_from is not None:
            ahead, left, up = (place - self.head_from).tolist()
            self._look_from(EyePosition(-left, up, -ahead))

    def _look_from(self, head: EyePosition) -> None:
        if self.bench.has_viewport:
            viewport = self.bench.viewport
            viewport.set_stereo_view(replace(viewport.stereo_view, head=head))

    def _rest(self) -> None:
        if self._moved_at:
            self._moved_at = 0.0
            self.bench.live.interactive = False

    # What is told

    def update_counts(self) -> None:
        """Update the packet counts in the panel."""
        now = time.monotonic()
        seconds, self._told_at = now - self._told_at, now
        rows, counts = [], [0, 0, 0]
        for key, source in self.sources.items():
            number = source.inbox.counts
            counts = [
                old + new
                for old, new in zip(counts, (number.accepted, number.malformed, number.unknown_senders), strict=True)
            ]
            drives = self._drives(key)
            name = f"{source.name}, drives {drives}" if drives else source.name
            rate = source.rate("", number.accepted, seconds)
            rows.append(InputRow(key, source.name, name, rate, _senders(source, now, seconds)))
        words = f"{counts[0]:,} packets received, {counts[1]:,} invalid, {counts[2]:,} from disabled senders."
        problems = list(self.bench.live.driven.problems.values())
        self.panel.show_inputs(rows, " ".join([words, *problems]))
        self.panel.show_driver(self.drivers.get(str(self.panel.performer.value)) if self.drivers else None)
        self.panel.show_recording(f"{self.recorder.count:,} packets so far" if self.recorder else "")
        self._tell_streaming()

    def _tell_streaming(self) -> None:
        words = ""
        if self.broadcast is not None:
            ports = [f"{name} to {body.port}" for name, body in self.bodies_to_stream()]
            words = self.broadcast.problem or (", ".join(ports) + "." if ports else "No character is visible.")
        self.panel.show_streaming(self.broadcast is not None, words)

    def _drives(self, key: str) -> str:
        performers = self.bench.document.project.performers
        driven = [performers[each].name for each, by in self.drivers.items() if by == key and each in performers]
        prop = self.bench.document.project.props.get(self.tracked.prop_id) if self.tracked else None
        if prop is not None and self.tracked is not None and self.tracked.source == key:
            driven.append(prop.name)
        return ", ".join(driven)

    # Parts

    def _add(self, source: LiveSource) -> None:
        number = 1 + max((int(key) for key in self.sources), default=0)
        self.sources[str(number)] = source
        self._run()
        self.update_counts()

    def _run(self) -> None:
        if self.sources or self.broadcast is not None:
            self._tick.start()
            self._telling.start()
        else:
            self._tick.stop()
            self._telling.stop()

    def _keep_by(self, recorder: Recorder | None) -> None:
        for source in self.sources.values():
            if isinstance(source.feeder, UdpInput):
                source.feeder.kept = recorder.record_packet if recorder else None

    def _ask_recording(self) -> None:
        if self.recorder is not None:
            self.stop_recording()
        else:
            ask_new_file(self.bench, "Record OSC input", RECORDING_FILTER, "session.osc", self.record, "osc")

    def _offer(self) -> None:
        project = self.bench.document.project
        performers = [(key, each.name) for key, each in project.performers.items()]
        self.panel.offer(performers, [(key, each.name) for key, each in project.props.items()])

    def _repaint(self) -> None:
        if self.bench.has_viewport:
            self.bench.viewport.schedule_redraw()


def names_in(words: str) -> tuple[str, ...]:
    """Names of bones or trackers in a text, separated by commas."""
    return tuple(name.strip() for name in words.split(",") if name.strip())


def _senders(source: LiveSource, now: float, seconds: float) -> tuple[SenderRow, ...]:
    feeder = source.feeder
    if not isinstance(feeder, UdpInput):
        return ()
    return tuple(
        SenderRow(name, each.on, source.rate(name, each.packets, seconds), now - each.heard if each.packets else None)
        for name, each in list(feeder.senders.items())
    )


def show_live(bench: Workbench) -> None:
    """Show the Live panel."""
    bench.window.show_dock("Live")


def toggle_head_tracking(bench: Workbench) -> None:
    """Toggle the view from the position of the tracked head."""
    bench.window.live_control.track_camera(not is_head_tracked(bench))


def is_head_tracked(bench: Workbench) -> bool:
    """True if the camera follows a tracked head."""
    return bench.window.live_control.head_from is not None


def toggle_streaming(bench: Workbench) -> None:
    """Toggle streaming to the address in the panel."""
    bench.window.live_control.panel.ask_to_stream(not is_streaming(bench))


def is_streaming(bench: Workbench) -> bool:
    """True while bodies are streamed."""
    return bench.window.live_control.broadcast is not None
