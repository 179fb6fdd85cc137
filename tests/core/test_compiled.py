"""Compiled kernels: linked parts, and tuples handed on as one address."""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any, NamedTuple

import numba
import numpy as np
import pytest
from llvmlite.binding import ffi
from numba import types
from numba.core.typing import templates

from studio.core.kernels.algebra.rotation_matrices import rotation_vector_to_matrix
from studio.core.kernels.compiling import allocating_kernel, kernel, linked_kernels, pack, small_kernel

# Kernels that call kernels: parts linked into one whole that gives what Python gives, fresh and from the cache.


ROOT = Path(__file__).resolve().parents[2]


@small_kernel
def doubled(number):
    """Twice a number."""
    return 2 * number


@kernel
def checked(number):
    """A number that is not negative."""
    if number < 0:
        raise ValueError("Less than nothing.")
    return doubled(number)


@kernel
def filled(number, out_numbers):
    """Write what is checked of rising numbers."""
    for index in range(out_numbers.shape[0]):
        out_numbers[index] = checked(number + index)


@allocating_kernel
def row_of(number, count):
    """A new row of doubled numbers."""
    numbers = np.empty(count)
    filled(number, numbers)
    return numbers


@allocating_kernel
def two_rows(number, count):
    """A row of rows, made by kernels that make arrays."""
    rows = np.empty((2, count))
    rows[0], rows[1] = row_of(number, count), row_of(-number, count)
    return rows, number


def test_kernels_that_call_kernels_give_what_python_gives() -> None:
    assert row_of(1.5, 3).tolist() == [3.0, 5.0, 7.0]
    rows, number = two_rows(0, 2)
    assert rows.tolist() == [[0.0, 2.0], [0.0, 2.0]]
    assert number == 0


def test_what_only_kernels_call_becomes_no_machine_code_but_counts_as_there() -> None:
    row_of(2.5, 1)
    row_of.recompile()  # it may have come from the cache
    assert not doubled.overloads
    assert doubled.signatures


def test_what_a_kernel_deep_below_refuses_reaches_python() -> None:
    with pytest.raises(ValueError, match="Less than nothing"):
        two_rows(1, 4)


def test_a_kernel_can_be_called_by_kernels_first_and_then_by_python() -> None:
    row_of(4.0, 1)
    assert checked(4.0) == 8.0
    assert row_of(4.0, 1).tolist() == [8.0]


OWN = (
    linked_kernels.KernelPostProcessor,
    linked_kernels.KernelPart,
    linked_kernels.KernelProgram,
    linked_kernels.KernelPipeline,
    linked_kernels.PartCompiler,
    linked_kernels.Kernel,
)


@pytest.mark.parametrize("own", OWN)
def test_numba_still_has_what_linking_puts_something_else_in_place_of(own) -> None:
    """A numba that renamed one of these would go on as if nothing were replaced."""
    added = {"part", "_make_part", "_flags", "parts", "signatures", "_note_below"}
    replaced = {name for name, what in vars(own).items() if callable(what) and name not in added}
    assert replaced - {"__init__"}
    assert not [name for name in replaced if not hasattr(own.__base__, name)]


@allocating_kernel
def first_ramp(count):
    """Rising numbers."""
    numbers = np.empty((count, 7))
    for index in range(count):
        numbers[index, 0] = index
    return numbers


@allocating_kernel
def second_ramp(count):
    """Falling numbers."""
    numbers = np.empty((count, 7))
    for index in range(count):
        numbers[index, 0] = -index
    return numbers


def test_what_two_kernels_call_of_numpy_is_compiled_once(monkeypatch) -> None:
    compiled, build = [], templates._OverloadFunctionTemplate._build_impl

    def note(self, known, arguments, named):
        compiled.append((self.key, tuple(arguments)))
        return build(self, known, arguments, named)

    monkeypatch.setattr(templates._OverloadFunctionTemplate, "_build_impl", note)
    for ramp in (first_ramp, second_ramp):
        ramp(2)
        ramp.recompile()  # it may have come from the cache
    assert compiled.count((np.empty, (types.UniTuple(types.int64, 2),))) <= 1


def test_what_others_compile_in_object_mode_still_knows_its_variables() -> None:
    @numba.jit(forceobj=True, looplift=False)
    def total(numbers):
        found = {}
        for number in numbers:
            found[number] = number
        return sum(found.values())

    assert total([1, 2, 4]) == 7


def test_nobody_is_told_of_every_call_of_the_compiler_below() -> None:
    assert not ffi.lib._lock._cblist


SCRIPT = """
import json
from tests.core import test_compiled as here
numbers = [here.row_of(1.5, 3).tolist(), here.checked(4.0)]
print(json.dumps([numbers, len(here.row_of.stats.cache_hits), len(here.doubled.signatures)]))
"""


def start(cache: Path) -> subprocess.Popen[str]:
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(cache), "PYTHONPATH": str(ROOT)}
    return subprocess.Popen([sys.executable, "-c", SCRIPT], env=environment, stdout=subprocess.PIPE, text=True)


def test_a_whole_comes_from_the_cache_without_its_parts(tmp_path) -> None:
    """Two processes fill one cache at once, the third only fetches."""
    answers = [json.loads(each.communicate()[0]) for each in [start(tmp_path), start(tmp_path)]]
    answers.append(json.loads(start(tmp_path).communicate()[0]))
    assert [numbers for numbers, _, _ in answers] == 3 * [[[3.0, 5.0, 7.0], 8.0]]
    assert answers[2][1:] == [1, 0]


BELOW_FIRST = """
import subprocess
import sys
from pathlib import Path
from tests.core import test_compiled as here
if len(sys.argv) == 2:
    here.two_rows(0.0, 3)
    for file in Path(sys.argv[1]).rglob("*.nb*"):  # so that the other compiles the same, and names it the same
        file.unlink()
    subprocess.run([*sys.orig_argv, "other"], check=True)
else:
    here.two_rows(0.0, 3)
print(here.row_of(1.5, 3).tolist(), len(here.row_of.stats.cache_hits))
"""


def test_a_whole_that_another_process_cached_works_where_its_part_is_compiled(tmp_path) -> None:
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path), "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-c", BELOW_FIRST, str(tmp_path)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.stdout.splitlines()[-1:] == ["[3.0, 5.0, 7.0] 1"], done.stdout + done.stderr


ANOTHER = """
import sys
import numba
import numpy as np
numba.__version__ = "0.99.0"
from studio.core.kernels.compiling import kernel, pack
from studio.core.kernels.algebra.rotation_matrices import rotation_vector_to_matrix

@kernel
def handed_on(packed, out_matrix):
    vector, factor = packed
    rotation_vector_to_matrix(factor * vector[0], factor * vector[1], factor * vector[2], out_matrix)

@kernel
def both(vector, out_matrix):
    handed_on(pack((vector, 2.0)), out_matrix)

matrix = np.empty((3, 3))
both(np.array([0.1, 0.2, 0.3]), matrix)
ways = [name for name in ("linked_kernels", "plain_numba") if f"studio.core.kernels.compiling.{name}" in sys.modules]
assert ways == ["plain_numba"], ways
print(matrix.ravel().tolist())
"""


def test_a_numba_that_nobody_has_tried_is_used_by_its_public_ways(tmp_path):
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path), "PYTHONPATH": str(ROOT)}
    file = tmp_path / "another.py"  # numba's own cache wants a file
    file.write_text(ANOTHER)
    command = (sys.executable, str(file))
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    matrix = np.empty((3, 3))
    rotation_vector_to_matrix(0.2, 0.4, 0.6, matrix)
    assert json.loads(done.stdout) == pytest.approx(matrix.ravel().tolist(), abs=1e-12)


# Packed tuples: what kernels hand on as one address is the tuple it was made from.


@kernel
def spread(packed, out_numbers):
    """Write what a packed tuple holds, by index, from its end and taken apart."""
    inner, factor, flag = packed
    (first, second), weights = inner
    out_numbers[0] = factor * first[0] + second[1, 2]
    out_numbers[1] = packed[1] * weights[-1]
    out_numbers[2] = packed[2] + flag
    first[1] = 7.0


@kernel
def spread_packed(values, again, out_numbers):
    """Pack a tuple with a packed tuple in it, as often as is asked, and hand it on."""
    for _ in range(again):
        (arrays, weights), factor, flag = values
        spread(pack((pack((arrays, weights)), factor, flag)), out_numbers)


def make_values():
    first, second = np.array([2.0, 3.0]), np.arange(6.0).reshape(2, 3)
    return ((first, second[:, :]), np.array([0.5, 4.0])), 10.0, 3


def test_a_packed_tuple_reads_as_the_tuple_it_was_made_from() -> None:
    plain, packed = np.zeros(3), np.zeros(3)
    spread(make_values(), plain)
    spread_packed(make_values(), 3, packed)
    assert plain.tolist() == packed.tolist() == [25.0, 40.0, 6.0]


def test_arrays_of_a_packed_tuple_are_those_of_its_maker() -> None:
    values = make_values()
    spread_packed(values, 1, np.zeros(3))
    assert values[0][0][0].tolist() == [2.0, 7.0]


class Place(NamedTuple):
    point: Any
    weight: float


class Pair(NamedTuple):
    here: Place
    there: Place


@kernel
def between(pair, out_point):
    """Point between two places, by their weights; by names."""
    whole = pair.here.weight + pair.there.weight
    for axis in range(3):
        share = pair.here.weight * pair.here.point[axis] + pair.there.weight * pair.there.point[axis]
        out_point[axis] = share / whole


@kernel
def between_packed(pair, out_point):
    """The same of a record that is packed, with packed records in it."""
    between(pack(Pair(pack(pair.here), pack(pair.there))), out_point)


def test_a_packed_record_reads_by_its_names_as_the_record_it_was_made_from() -> None:
    pair = Pair(Place(np.array([0.0, 3.0, 1.0]), 1.0), Place(np.array([3.0, 0.0, 1.0]), 2.0))
    plain, packed = np.zeros(3), np.zeros(3)
    between(pair, plain)
    between_packed(pair, packed)
    assert plain.tolist() == packed.tolist() == pytest.approx([2.0, 1.0, 1.0])
