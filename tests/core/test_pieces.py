"""Pieces by two threads: all are done, what goes wrong is told, and who stops asking stops the work."""

import threading

import pytest

from studio.core.threads import in_threads


@pytest.mark.parametrize("count", [1, 2, 40])
def test_every_piece_is_done_and_the_share_grows_to_all(count: int) -> None:
    done: list[int] = []
    shares = list(in_threads(done.append, range(count)))
    assert sorted(done) == list(range(count))
    assert shares == [pytest.approx((place + 1) / count) for place in range(count)]


def test_what_a_piece_raises_is_raised() -> None:
    def work(piece: int) -> None:
        if piece == 3:
            raise ValueError("piece 3")

    with pytest.raises(ValueError, match="piece 3"):
        list(in_threads(work, range(10)))


def test_who_stops_asking_stops_the_work() -> None:
    begun, go_on = [], threading.Event()

    def work(piece: int) -> None:
        begun.append(piece)
        if piece > 1:
            go_on.wait()

    shares = in_threads(work, range(100))
    next(shares)
    threading.Timer(0.05, go_on.set).start()
    shares.close()
    assert len(begun) < 10
