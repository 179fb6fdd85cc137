"""Plain decimal numbers out of text, exactly as C reads them, where that can be known without long arithmetic."""

import numpy as np

from studio.core.kernels.compiling import kernel

NEW_LINE = 10
POWERS = np.array([float(10**power) for power in range(23)])
EXACT = 1 << 53
"""Whole numbers up to here are exact as floats, and so are powers of ten up to 22: one rounding joins them."""


@kernel
def is_space(byte):
    """Whether a byte separates words: space, tab, line ends, vertical tab, form feed."""
    return byte == 32 or 9 <= byte <= 13


@kernel
def count_words(text, out_counts):
    """Words of each line of ``text``, bytes (N,) with lines ended by line feeds, in ``out_counts`` (L,)."""
    line, within = 0, False
    for place in range(text.shape[0]):
        byte = text[place]
        if is_space(byte):
            within = False
            line += byte == NEW_LINE
        elif not within:
            within = True
            out_counts[line] += 1


@kernel
def read_decimals(text, most, out_values):
    """Read the numbers of ``text`` (N,) into ``out_values``; whether that is all of them, and nothing but them.

    No where a word is no plain decimal number, has more digits than are exact (D. W. Clinger, How to read floating
    point numbers accurately, 1990), is farther than ``most`` from zero, or where there are more or fewer than there is
    room for.
    """
    place, count, end = 0, 0, text.shape[0]
    while True:
        while place < end and is_space(text[place]):
            place += 1
        if place == end:
            return count == out_values.shape[0]
        value, place = read_decimal(text, place)
        if place < 0 or count == out_values.shape[0] or abs(value) > most:
            return False
        out_values[count] = value
        count += 1


@kernel
def read_decimal(text, place):
    """The number at ``place`` of ``text`` and the place after it, which is -1 where that is not sure."""
    negative = text[place] == 45
    place += negative or text[place] == 43
    whole, digits, after, fraction = 0, 0, 0, False
    while place < text.shape[0]:
        byte = text[place]
        if byte == 46 and not fraction:
            fraction = True
        elif 48 <= byte <= 57 and whole < EXACT // 10:
            whole = 10 * whole + int(byte) - 48
            digits += 1
            after += fraction
        else:
            break
        place += 1
    exponent = -after
    if digits > 0 and place < text.shape[0] and (text[place] == 101 or text[place] == 69):
        tenfold, place = read_exponent(text, place + 1)
        exponent += tenfold
    if digits == 0 or (0 <= place < text.shape[0] and not is_space(text[place])) or abs(exponent) > 22:
        return 0.0, -1
    value = whole / POWERS[-exponent] if exponent < 0 else whole * POWERS[exponent]
    return (-value if negative else value), place


@kernel
def read_exponent(text, place):
    """The power of ten at ``place`` of ``text``, of three digits at most, and the place after; -1 where it is none."""
    negative = place < text.shape[0] and text[place] == 45
    place += negative or (place < text.shape[0] and text[place] == 43)
    power, digits = 0, 0
    while place < text.shape[0] and 48 <= text[place] <= 57 and digits < 3:
        power = 10 * power + int(text[place]) - 48
        digits += 1
        place += 1
    if digits == 0:
        return 0, -1
    return (-power if negative else power), place
