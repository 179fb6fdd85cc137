"""Tuples passed between kernels as one address.

Numba passes a tuple of arrays word by word: a kernel's scratch is some 250 words, which every call would push, a third
of the time of all kernels. A packed tuple is written into its maker's frame once and read where it is used. It is
accessed like any tuple, by name, by index and by unpacking, and it must not outlive its maker.
"""

# mypy: allow-untyped-calls, allow-untyped-decorators, allow-subclassing-any
# Numba says no types of its own.

from collections.abc import Iterator
from typing import Any

from llvmlite import ir  # type: ignore[import-untyped]
from numba.core import cgutils, config, types
from numba.core.imputils import impl_ret_borrowed
from numba.core.typing.templates import AttributeTemplate
from numba.extending import (
    NativeValue,
    infer_getattr,
    intrinsic,
    lower_builtin,
    lower_getattr_generic,
    models,
    register_model,
    unbox,
)


class Packed(types.BaseTuple):
    """Type of a pointer to a tuple of ``types``, with the names ``fields`` if it has names. Neither converts to the
    other implicitly.
    """

    def __init__(self, types: tuple[Any, ...], fields: tuple[str, ...]) -> None:
        self.types, self.fields, self.count = tuple(types), fields, len(types)
        super().__init__(f"Packed({', '.join(fields)}: {', '.join(map(str, types))})")

    def __len__(self) -> int:
        return self.count

    def __iter__(self) -> Iterator[Any]:
        return iter(self.types)


@register_model(Packed)
class PackedModel(models.PrimitiveModel):
    """Data model of one pointer."""

    def __init__(self, manager: Any, packed: Packed) -> None:
        kept = ir.LiteralStructType([manager[each].get_value_type() for each in packed.types])
        super().__init__(manager, packed, kept.as_pointer())


@unbox(Packed)
def raise_unboxing_error(packed: Any, _value: Any, code: Any) -> Any:
    """Raise TypeError: Python has no packed tuples to pass."""
    code.pyapi.err_set_string("PyExc_TypeError", "A packed tuple is made by kernels only.")
    return NativeValue(ir.Constant(code.context.get_value_type(packed), None), is_error=cgutils.true_bit)


def pack_values(_typing: Any, values: Any) -> Any:
    """Signature of ``pack`` for a tuple, and the function that writes its code."""

    def write(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        kept = context.get_value_type(signature.return_type).pointee
        address = cgutils.alloca_once(builder, kept)
        for position in range(len(kept.elements)):
            builder.store(
                builder.extract_value(arguments[0], position), cgutils.gep_inbounds(builder, address, 0, position)
            )
        return address

    return Packed(values.types, tuple(getattr(values, "fields", ())))(values), write


def read_whole(builder: Any, address: Any, kind: Any) -> Any:
    """Value at an address, read word by word, so that the optimiser drops unused words."""
    if not isinstance(kind, ir.LiteralStructType | ir.ArrayType):
        return builder.load(address)
    value = ir.Constant(kind, ir.Undefined)
    for position, each in enumerate(
        kind.elements if isinstance(kind, ir.LiteralStructType) else [kind.element] * kind.count
    ):
        word = read_whole(builder, cgutils.gep_inbounds(builder, address, 0, position), each)
        value = builder.insert_value(value, word, position)
    return value


@infer_getattr
class PackedAttributes(AttributeTemplate):
    """Types of the named members."""

    key = Packed

    def generic_resolve(self, packed: Packed, name: str) -> Any:  # type: ignore[override]
        """Type of ``packed.name``, None where there is no such member."""
        return packed.types[packed.fields.index(name)] if name in packed.fields else None


@lower_getattr_generic(Packed)
def named_member(context: Any, builder: Any, packed: Packed, address: Any, name: str) -> Any:
    """Write the code of ``packed.name``."""
    return read_member(context, builder, packed, address, packed.fields.index(name))


@lower_builtin("static_getitem", Packed, types.IntegerLiteral)
def numbered_member(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    """Write the code of ``packed[index]`` and of unpacking."""
    packed, index = signature.args[0], arguments[1]
    return read_member(context, builder, packed, arguments[0], index + (len(packed) if index < 0 else 0))


def read_member(context: Any, builder: Any, packed: Packed, address: Any, index: int) -> Any:
    """Write the code that reads one member at an ``address``."""
    kind = packed.types[index]
    position = cgutils.gep_inbounds(builder, address, 0, index)
    return impl_ret_borrowed(context, builder, kind, read_whole(builder, position, context.get_value_type(kind)))


pack: Any = (lambda values: values) if vars(config)["DISABLE_JIT"] else intrinsic(pack_values)
"""``pack(values)``: pointer to a tuple, which other kernels take in place of the tuple itself."""
