"""Parsing of plain decimal numbers, with C's result wherever that needs no long arithmetic."""

import numpy as np

from studio.core.kernels.compiling import kernel

NEW_LINE = 10
POWERS_OF_TEN = np.array([float(10**power) for power in range(23)])
"""Powers of ten from 0 to 22, all exact."""
MAX_EXACT_INTEGER = 1 << 53
"""Integer up to which all integers are exact as floats. So are powers of ten up to 22: the quotient or product of both
is rounded once.
"""


@kernel
def is_space(byte):
    """True if a byte separates words: space, tab, line ends, vertical tab, form feed."""
    return byte == 32 or 9 <= byte <= 13


@kernel
def count_words(text, out_counts):
    """Write the number of words of each line of ``text`` (N,), bytes with line feeds, into ``out_counts`` (L,)."""
    line, within = 0, False
    for index in range(text.shape[0]):
        byte = text[index]
        if is_space(byte):
            within = False
            line += byte == NEW_LINE
        elif not within:
            within = True
            out_counts[line] += 1


@kernel
def read_decimals(text, most, out_values):
    """Read the numbers of ``text`` (N,), bytes, into ``out_values``; True if the text is exactly these numbers.

    False for a token that is no plain decimal, has too many digits for an exact conversion (D. W. Clinger, How to read
    floating point numbers accurately, 1990) or exceeds ``most`` in magnitude, and for another number of tokens.
    """
    index, count, end = 0, 0, text.shape[0]
    while True:
        while index < end and is_space(text[index]):
            index += 1
        if index == end:
            return count == out_values.shape[0]
        value, index = read_decimal(text, index)
        if index < 0 or count == out_values.shape[0] or abs(value) > most:
            return False
        out_values[count] = value
        count += 1


@kernel
def read_decimal(text, index):
    """(number, index after it) of the decimal at ``index`` of ``text``; the index is -1 if the result might be
    inexact.
    """
    negative = text[index] == 45
    index += negative or text[index] == 43
    whole, digits, after, fraction = 0, 0, 0, False
    while index < text.shape[0]:
        byte = text[index]
        if byte == 46 and not fraction:
            fraction = True
        elif 48 <= byte <= 57 and whole < MAX_EXACT_INTEGER // 10:
            whole = 10 * whole + int(byte) - 48
            digits += 1
            after += fraction
        else:
            break
        index += 1
    exponent = -after
    if digits > 0 and index < text.shape[0] and (text[index] == 101 or text[index] == 69):
        tenfold, index = read_exponent(text, index + 1)
        exponent += tenfold
    if digits == 0 or (0 <= index < text.shape[0] and not is_space(text[index])) or abs(exponent) > 22:
        return 0.0, -1
    value = whole / POWERS_OF_TEN[-exponent] if exponent < 0 else whole * POWERS_OF_TEN[exponent]
    return (-value if negative else value), index


@kernel
def read_exponent(text, index):
    """(power of ten, index after it) of the exponent at ``index`` of ``text``, three digits at most; the index is -1 if
    there is none.
    """
    negative = index < text.shape[0] and text[index] == 45
    index += negative or (index < text.shape[0] and text[index] == 43)
    power, digits = 0, 0
    while index < text.shape[0] and 48 <= text[index] <= 57 and digits < 3:
        power = 10 * power + int(text[index]) - 48
        digits += 1
        index += 1
    if digits == 0:
        return 0, -1
    return (-power if negative else power), index
