"""What two threads ask for at the same time is worked out once, and nothing of it is kept."""

import threading
from concurrent.futures import ThreadPoolExecutor

import pytest

from studio.core.sharing import Shared


def test_who_asks_while_it_is_computed_shares_the_result() -> None:
    begun, go_on, asked = threading.Event(), threading.Event(), []

    def compute(key: str) -> list[str]:
        asked.append(key)
        begun.set()
        go_on.wait()
        return [key]

    shared, key = Shared(compute), "capture"
    with ThreadPoolExecutor(2) as pool:
        first = pool.submit(shared, key)
        begun.wait()
        second = pool.submit(shared, key)
        while not second.running():
            pass
        threading.Timer(0.05, go_on.set).start()
        assert first.result() is second.result()
    assert asked == [key]
    assert shared(key) == [key]
    assert asked == [key, key]


def test_what_goes_wrong_is_told_every_time() -> None:
    def compute(key: str) -> None:
        raise ValueError(key)

    shared = Shared(compute)
    for _ in range(2):
        with pytest.raises(ValueError, match="capture"):
            shared("capture")
