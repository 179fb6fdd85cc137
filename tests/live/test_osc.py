"""Packets are read as an independent library writes them, and nothing in them is believed."""

import math
from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pythonosc.osc_bundle_builder import IMMEDIATELY, OscBundleBuilder
from pythonosc.osc_message import OscMessage
from pythonosc.osc_message_builder import OscMessageBuilder

from studio.live.osc import BadPacket, Message, bundles, decode, encode_message

TEXTS = st.text(st.characters(codec="utf-8", exclude_characters="\0"), max_size=20)
VALUES = st.one_of(
    st.integers(-(2**31), 2**31 - 1),
    st.floats(width=32, allow_nan=False),
    TEXTS,
    st.binary(min_size=1, max_size=9),
    st.booleans(),
)


def theirs(address, arguments):
    builder = OscMessageBuilder(address)
    for each in arguments:
        builder.add_arg(each)
    return builder.build()


@given(st.lists(VALUES, max_size=8))
def test_messages_of_an_independent_library_are_read(arguments):
    assert decode(theirs("/a/b", arguments).dgram) == [Message("/a/b", tuple(arguments))]


@given(st.lists(VALUES, max_size=8))
def test_an_independent_library_reads_our_messages(arguments):
    read = OscMessage(encode_message("/a/b", arguments))
    assert (read.address, list(read.params)) == ("/a/b", arguments)


def test_bundles_within_bundles_are_read_in_order():
    inner, outer = OscBundleBuilder(IMMEDIATELY), OscBundleBuilder(IMMEDIATELY)
    inner.add_content(theirs("/two", [2]))
    outer.add_content(theirs("/one", [1]))
    outer.add_content(inner.build())
    outer.add_content(theirs("/three", [3]))
    assert [each.address for each in decode(outer.build().dgram)] == ["/one", "/two", "/three"]


@given(st.lists(st.integers(0, 60), max_size=40), st.integers(100, 300))
def test_bundles_are_no_longer_than_they_may_be_and_hold_everything_in_order(sizes, largest):
    messages = [encode_message(f"/{k}", ["x" * size]) for k, size in enumerate(sizes)]
    packets = list(bundles(messages, largest))
    assert all(len(packet) <= largest for packet in packets)
    assert [each.address for packet in packets for each in decode(packet)] == [f"/{k}" for k in range(len(sizes))]


@given(st.binary(max_size=80))
def test_any_bytes_are_either_messages_or_a_bad_packet(data):
    for packet in (data, b"#bundle\0" + data, b"/a\0\0," + data):
        with suppress(BadPacket):
            decode(packet)


@given(st.data())
def test_a_damaged_packet_is_either_messages_or_a_bad_packet(data):
    packet = bytearray(theirs("/VMC/Ext/Bone/Pos", ["Hips", *([0.5] * 7)]).dgram)
    for _ in range(data.draw(st.integers(1, 4))):
        packet[data.draw(st.integers(0, len(packet) - 1))] = data.draw(st.integers(0, 255))
    with suppress(BadPacket):
        assert all(isinstance(each, Message) for each in decode(bytes(packet[: data.draw(st.integers(0, 80))])))


@pytest.mark.parametrize(
    "packet",
    [
        b"",
        b"no address\0\0",
        b"#bundle\0" + b"\0" * 7,
        b"#bundle\0" + b"\0" * 8 + b"\x7f\xff\xff\xff",
        b"#bundle\0" + b"\0" * 8 + b"\0\0\0\0" * 2,
        b"/a\0\0,b\0\0\x7f\xff\xff\xff",
        b"/a\0\0,b\0\0\xff\xff\xff\xff",
        b"/a\0\0,i\0\0",
        b"/a\0\0,?\0\0",
        b"/a\0\0" + b"," + b"T" * 99 + b"\0\0\0\0",
        b"/" + b"a" * 400,
        b"/\xff\xfe\0,\0\0\0",
        b"x" * 70_000,
    ],
)
def test_a_packet_that_is_none_is_bad(packet):
    with pytest.raises(BadPacket):
        decode(packet)


def test_bundles_too_deep_and_messages_too_many_are_bad():
    deep = encode_message("/a", [])
    for _ in range(6):
        (deep,) = bundles([deep], 1000)
    with pytest.raises(BadPacket, match="deep"):
        decode(deep)
    (many,) = bundles([encode_message("/a", [])] * 1100, 60_000)
    with pytest.raises(BadPacket, match="many"):
        decode(many)


def test_numbers_that_are_none_are_read_as_they_came():
    (message,) = decode(theirs("/a", [math.nan]).dgram)
    assert math.isnan(message.arguments[0])
