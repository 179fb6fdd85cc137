"""Numbers out of text: to the last bit what Python reads, and nothing that is no plain decimal number."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.errors import StudioError
from studio.core.kernels.decimals import count_words, read_decimals
from studio.io.numbers import count_per_line, number, table

MOST = 1e12
spaces = st.sampled_from([" ", "\t", "\n", "\r\n", "  ", "\f", "\v"])
believable = st.floats(-MOST, MOST)
formats = st.sampled_from(["{:.6f}", "{:.3e}", "{:+.2f}", "{!r}", "{:g}", "{:.0f}.", "{:.17g}"])
written = st.tuples(formats, believable).map(lambda pair: pair[0].format(pair[1]))


def as_bytes(text: str) -> np.ndarray:
    return np.frombuffer(text.encode(), dtype=np.uint8)


@given(st.lists(st.tuples(written, spaces), min_size=1, max_size=12))
def test_what_is_read_is_what_python_reads(words: list[tuple[str, str]]) -> None:
    values = np.empty(len(words))
    if read_decimals(as_bytes("".join(word + space for word, space in words)), MOST, values):
        expected = np.array([float(word) for word, _ in words])
        assert values.tobytes() == expected.tobytes()


@pytest.mark.parametrize(
    "word", ["0", "-0", "12.5", "-.25", "7.", "+3.000001", "1e3", "2.5E-07", "0.900719925474098", "1e-22"]
)
def test_usual_spellings_are_read_at_once(word: str) -> None:
    values = np.empty(1)
    assert read_decimals(as_bytes(f" {word}\n"), MOST, values)
    assert values.tobytes() == np.array([float(word)]).tobytes()


@given(st.text(st.sampled_from("0123456789+-.eE nax_,"), min_size=1, max_size=12))
def test_nothing_is_taken_for_a_number_that_is_none(text: str) -> None:
    words = text.split()
    values = np.empty(len(words))
    if read_decimals(as_bytes(text), MOST, values):
        assert values.tolist() == [number(word, "here") for word in words]


@pytest.mark.parametrize(("text", "room"), [("1 2 3", 2), ("1 2", 3), ("1e13", 1), ("", 1)])
def test_more_fewer_or_absurd_numbers_are_left_to_who_tells_of_them(text: str, room: int) -> None:
    assert not read_decimals(as_bytes(text), MOST, np.empty(room))


@given(st.lists(st.text(st.sampled_from("12.5 \t\v\f-x"), max_size=20), min_size=1, max_size=8))
def test_words_are_counted_line_by_line(lines: list[str]) -> None:
    counts = np.zeros(len(lines), dtype=np.int64)
    count_words(as_bytes("\n".join(lines)), counts)
    assert counts.tolist() == [len(line.split()) for line in lines]


def test_a_long_table_is_that_of_its_lines() -> None:
    random = np.random.default_rng(1)
    expected = random.normal(size=(20_000, 12)).round(6)
    lines = [" ".join(f"{value:.6f}" for value in row).encode() for row in expected]
    counts, shares = count_per_line(lines), []
    values = table(lines, counts, "walk.bvh", 1, shares.append)
    assert (counts == 12).all()
    assert values.tobytes() == expected.tobytes()
    assert len(shares) > 5
    assert shares[-1] == 1.0


def test_a_word_amid_a_long_table_is_told_with_its_line() -> None:
    lines = [b"1.0 2.0"] * 30_000
    lines[21_000] = b"1.0 two"
    with pytest.raises(StudioError, match=r"walk\.bvh, line 21005: 'two' is not a number"):
        table(lines, count_per_line(lines), "walk.bvh", 5, lambda _share: None)
