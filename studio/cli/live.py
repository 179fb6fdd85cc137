"""``live``: play a fighter that keeps striking distance to a tracked head and strikes, or a whole stage."""

import select
import sys
from argparse import Namespace
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.cli.library_options import library_with_clips
from studio.cli.live_stage import run_live_stage
from studio.cli.printing import INTERRUPTED_EXIT_CODE
from studio.core.errors import StudioError
from studio.core.normalized.pieces import MotionPiece
from studio.io.importing import GUESS_ALL
from studio.jobs.adaptation import chosen_characters, ready_capture
from studio.library.mirroring import with_mirrored
from studio.live.fight import ANY_STRIKE, FIGHT_ORDERS, Order, fight, orders_every
from studio.live.fighter import Fighter
from studio.live.recording import read_recording
from studio.live.streamer import Streamer
from studio.live.tracker import LOOPBACK, Inbox, UdpInput
from studio.resources_folder import example_captures_folder

FloatArray = NDArray[np.float64]

GUARD_EXAMPLE, GUARD_SECONDS = "front_kick.bvh", 1.3
"""Example that begins on guard, and the seconds for which its feet stay in place."""
SWAY_METRES, SWAY_RATE = 0.5, 0.35
"""Amplitude (metres) and angular frequency (rad/s) of the head's motion when no head is tracked."""


def run(arguments: Namespace) -> int:
    """Fight, or play a stage, then print the report."""
    if arguments.stream_to is not None and arguments.stream is None:
        raise StudioError("--stream-to only sets the address. Add --stream PORT to send.")
    if arguments.stage is not None:
        return run_live_stage(arguments)
    library = library_with_clips(arguments)
    library = with_mirrored(library) if arguments.mirrored else library
    body = next(iter(chosen_characters([arguments.character]).values())).morphology
    inbox = Inbox()
    with ExitStack() as stack:
        streamer = None
        if arguments.stream is not None:
            streamer = stack.enter_context(Streamer(arguments.stream, arguments.stream_to or LOOPBACK))
        beside = None if arguments.fast else stack.enter_context(ThreadPoolExecutor(1))
        fighter = Fighter(library, body, guard_of(arguments.guard), executor=beside, follows=not arguments.frozen)
        rehearse(fighter)
        target_at = target_of(arguments, inbox, body.stature, stack)
        every = arguments.strike_every
        order_at = typed_order if every is None else orders_every(every, [ANY_STRIKE])
        timed = fighter, target_at, order_at, arguments.seconds
        if streamer is None:
            report = fight(*timed, paced=not arguments.fast)
        else:
            report = fight(*timed, streamer.send, paced=not arguments.fast)
    print(report.words)
    if arguments.head:
        counts = inbox.counts
        print(
            f"{counts.accepted} packets received, {counts.malformed} invalid,"
            f" {counts.unknown_senders} from unknown senders"
        )
    return INTERRUPTED_EXIT_CODE if report.stopped else 0


def rehearse(fighter: Fighter) -> None:
    """Let a second fighter strike for a moment, so that everything is compiled and loaded before the fight."""
    double = Fighter(fighter.library, fighter.body, fighter.guard)
    fight(double, lambda now: swaying_head(now, double.body.stature), orders_every(0.1, [ANY_STRIKE]), 1.0)


def guard_of(path: Path | None) -> MotionPiece:
    """Piece of motion that plays between blows: the first ``GUARD_SECONDS`` of a capture."""
    ready = ready_capture(path or example_captures_folder() / GUARD_EXAMPLE, GUESS_ALL)
    first = ready.capture.first_frame
    last = min(first + round(GUARD_SECONDS * ready.motion.frame_rate), ready.motion.frame_count - 1)
    return MotionPiece(ready.motion, ready.contacts, first, last)


def target_of(arguments: Namespace, inbox: Inbox, stature: float, stack: ExitStack) -> Callable[[float], FloatArray]:
    """Function that returns the target's position (3,) at a time in seconds: tracked, replayed, or of a
    swaying head.
    """
    if not arguments.head:
        return lambda now: swaying_head(now, stature)
    recording = read_recording(arguments.replay) if arguments.replay else None
    if recording is not None and recording.problem:
        print(recording.problem, file=sys.stderr)
    packets = iter(recording) if recording else None
    waiting = [next(packets, None)] if packets else [None]
    if packets is None:
        listener = UdpInput(inbox, arguments.port, arguments.listen, arguments.sender)
        stack.callback(listener.close)
    last = [swaying_head(0.0, stature)]

    def target_at(now: float) -> FloatArray:
        while packets is not None and waiting[0] is not None and waiting[0][0] <= now:
            inbox.receive(waiting[0][1])
            waiting[0] = next(packets, None)
        place = inbox.position_of(arguments.head)
        last[0] = last[0] if place is None else place
        return last[0]

    return target_at


def swaying_head(now: float, stature: float) -> FloatArray:
    """Position (3,) at second ``now`` of a swaying head at the height of the fighter's own chest."""
    x, y = 1.0 + SWAY_METRES * np.sin(SWAY_RATE * now), SWAY_METRES * np.sin(0.7 * SWAY_RATE * now)
    return np.array([x, y, stature * (0.78 + 0.04 * np.sin(now))])


def typed_order(_now: float = 0.0) -> Order | None:
    """Order typed since the last frame: ``left punch``, ``right kick``; any other line is any strike. None without a
    line.
    """
    if not sys.stdin.isatty() or not select.select([sys.stdin], [], [], 0.0)[0]:
        return None
    return FIGHT_ORDERS.get(sys.stdin.readline().strip().lower(), ANY_STRIKE)
