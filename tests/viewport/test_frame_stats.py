"""The chip's figures: pictures a second, and the age of the pose that a picture shows."""

from studio.viewport.frame_stats import FrameStats


class Clock:
    now = 100.0

    def __call__(self) -> float:
        return self.now


def test_pictures_of_the_last_second_are_counted_and_the_pose_is_as_old_as_its_question() -> None:
    clock = Clock()
    pace = FrameStats(clock)
    assert pace.text == ""
    for step in range(40):
        clock.now = 100.0 + step / 20
        pace.note_picture(asked_at=clock.now - 0.085)
    assert pace.text == "20 fps · latency 85 ms"


def test_an_answer_seen_again_is_no_older_for_that_playback_has_no_age_and_at_rest_there_is_nothing_to_tell() -> None:
    clock = Clock()
    pace = FrameStats(clock)
    for _ in range(11):
        clock.now += 0.1
        pace.note_picture(asked_at=100.05)
    assert pace.text == "10 fps · latency 50 ms"
    for _ in range(11):
        clock.now += 0.1
        pace.note_picture(None)
    assert pace.text == "10 fps"
    pace.note_rest()
    assert pace.text == ""


def test_a_body_that_nobody_has_moved_since_the_drag_began_is_not_behind() -> None:
    """A box is dragged beside it: what it shows was asked a minute and a half ago."""
    clock = Clock()
    pace = FrameStats(clock)
    for _ in range(11):
        clock.now += 0.1
        pace.note_picture(asked_at=clock.now - 96.073)
    assert pace.text == "10 fps"
    for _ in range(11):
        clock.now += 0.1
        pace.note_picture(asked_at=clock.now - 0.085)
    assert pace.text == "10 fps · latency 85 ms"
