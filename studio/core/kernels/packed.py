"""Tuples that are handed on as one address.

Numba hands a tuple of arrays on word by word: a kernel's scratch is some 250 words that every call would push and that
were a third of the time of all kernels. A packed tuple is written into its maker's frame once and read where it is
used; indexed and taken apart it is a tuple like any other, but it must not outlive its maker.
"""

# mypy: allow-untyped-calls, allow-untyped-decorators, allow-subclassing-any
# Numba says no types of its own.

from collections.abc import Iterator
from typing import Any

from llvmlite import ir  # type: ignore[import-untyped]
from numba.core import cgutils, config, types
from numba.core.imputils import impl_ret_borrowed
from numba.extending import NativeValue, intrinsic, lower_builtin, models, register_model, unbox


class Packed(types.BaseTuple):
    """The type of the address of a tuple of ``types``; no tuple turns into one, nor it into a tuple."""

    def __init__(self, types: tuple[Any, ...]) -> None:
        self.types, self.count = tuple(types), len(types)
        super().__init__(f"Packed({', '.join(map(str, types))})")

    def __len__(self) -> int:
        return self.count

    def __iter__(self) -> Iterator[Any]:
        return iter(self.types)


@register_model(Packed)
class PackedModel(models.PrimitiveModel):
    """One word, whatever it leads to."""

    def __init__(self, manager: Any, packed: Packed) -> None:
        kept = ir.LiteralStructType([manager[each].get_value_type() for each in packed.types])
        super().__init__(manager, packed, kept.as_pointer())


@unbox(Packed)
def refuse(packed: Any, _value: Any, code: Any) -> Any:
    """Python has no such tuples to hand on."""
    code.pyapi.err_set_string("PyExc_TypeError", "A packed tuple is made by kernels only.")
    return NativeValue(ir.Constant(code.context.get_value_type(packed), None), is_error=cgutils.true_bit)


def pack_values(_typing: Any, values: Any) -> Any:
    """The signature of ``pack`` for a tuple, and what writes its code."""

    def write(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        kept = context.get_value_type(signature.return_type).pointee
        address = cgutils.alloca_once(builder, kept)
        for place in range(len(kept.elements)):
            builder.store(builder.extract_value(arguments[0], place), cgutils.gep_inbounds(builder, address, 0, place))
        return address

    return Packed(values.types)(values), write


def read_whole(builder: Any, address: Any, kind: Any) -> Any:
    """The value at an address, word by word: what is not used of it is not read."""
    if not isinstance(kind, ir.LiteralStructType | ir.ArrayType):
        return builder.load(address)
    value = ir.Constant(kind, ir.Undefined)
    for place, each in enumerate(
        kind.elements if isinstance(kind, ir.LiteralStructType) else [kind.element] * kind.count
    ):
        word = read_whole(builder, cgutils.gep_inbounds(builder, address, 0, place), each)
        value = builder.insert_value(value, word, place)
    return value


@lower_builtin("static_getitem", Packed, types.IntegerLiteral)
def member_of(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    """Write the code of ``packed[index]`` and of taking apart."""
    packed, index = signature.args[0], arguments[1]
    index += len(packed) if index < 0 else 0
    kind = context.get_value_type(packed.types[index])
    value = read_whole(builder, cgutils.gep_inbounds(builder, arguments[0], 0, index), kind)
    return impl_ret_borrowed(context, builder, signature.return_type, value)


pack: Any = (lambda values: values) if vars(config)["DISABLE_JIT"] else intrinsic(pack_values)
"""``pack(values)``: a tuple, handed on as one address from here."""
