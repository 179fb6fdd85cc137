"""Kernels are translated once each, and linked, optimised and assembled once for each that Python calls.

Numba links the code of all that a function calls into that function's library, optimises it there and makes machine
code of it, so that a leaf of a deep tree of calls is done again at every level above it. Here a kernel that kernels
call is a ``Part``, which is kept as it was translated; what Python calls is a ``Whole``: the parts it needs, linked,
with nothing to be seen from outside, so that the optimiser may inline and reshape every call.
"""

# mypy: allow-untyped-calls, allow-subclassing-any
# Numba says no types of its own.

from collections.abc import Callable, Iterable
from functools import cache
from typing import Any

from numba.core import compiler, config, sigutils, types, typing
from numba.core.codegen import CodeLibrary, JITCodeLibrary
from numba.core.dispatcher import _FunctionCompiler  # type: ignore[attr-defined]
from numba.core.registry import CPUDispatcher
from numba.core.targetconfig import ConfigStack

ENVIRONMENT = "_ZN08NumbaEnv"
"""How the names begin under which compiled code finds its Python objects."""
_SETTLED: dict[tuple[str, bool], Any] = {}
"""Flags by the options of a kernel and whether they are a part's."""


class Part(JITCodeLibrary):
    """What one kernel does by itself, without what it calls and never as machine code."""

    def finalize(self) -> None:
        """Be ready to be linked, as often as is asked."""
        for function in self._final_module.functions:
            if not function.is_declaration:
                function.linkage = "linkonce_odr"
        self._shared_module, self._finalized = self._final_module, True


class Whole(JITCodeLibrary):
    """A kernel that Python calls, with all parts below it."""

    def __init__(self, codegen: Any, name: str, seen: Iterable[str]) -> None:
        super().__init__(codegen, name)
        self._seen = frozenset(seen)

    def add_linking_library(self, library: CodeLibrary) -> None:
        """Link a library and all that it calls once, callers first: what nobody has called yet is not taken along."""
        below: list[CodeLibrary] = []
        self._note_below(library, below)
        for each in reversed(below):
            super().add_linking_library(each)

    def _note_below(self, library: CodeLibrary, found: list[CodeLibrary]) -> None:
        """Add a library to those ``found``, after all that it calls."""
        if library in found or library in self._linking_libraries:
            return
        if isinstance(library, Part):
            for below in library._linking_libraries:
                self._note_below(below, found)
        found.append(library)

    def _optimize_final_module(self) -> None:
        module = self._final_module
        environments = (each for each in module.global_variables if each.name.startswith(ENVIRONMENT))
        for each in (*module.functions, *environments):
            if not each.is_declaration and each.name not in self._seen:
                each.linkage = "internal"
        super()._optimize_final_module()


class Settled(compiler.Flags):
    """Flags that kernels share and nobody may change, each the same as itself alone.

    Numba finds again by its flags how each call is to be translated, and compares them option by option.
    """

    __hash__ = object.__hash__

    def __eq__(self, other: object) -> bool:
        return self is other


class Remembering:
    """A typing context that finds only once what an operator, or a function of Python itself, makes of some types.

    Numba tries all that could be meant, numpy's meanings among them, for every sum of every kernel: an eighth of all
    instructions that compiling took.
    """

    def __init__(self, context: typing.Context) -> None:
        self._context = context
        self._found: dict[tuple[Any, tuple[Any, ...]], Any] = {}

    def __getattr__(self, name: str) -> Any:
        return getattr(self._context, name)

    def resolve_function_type(self, function: Any, arguments: tuple[Any, ...], named: dict[str, Any]) -> Any:
        """The signature of a call, None where there is none."""
        known = getattr(function, "typing_key", function)
        if named or getattr(known, "__module__", None) not in ("_operator", "builtins", "math"):
            return self._context.resolve_function_type(function, arguments, named)
        call = known, tuple(arguments)
        if call not in self._found:
            self._found[call] = self._context.resolve_function_type(function, arguments, named)
        return self._found[call]


class Compiler(_FunctionCompiler):
    """Makes parts of one kernel for the kernels that call it, and wholes for Python."""

    def __init__(self, kernel: CPUDispatcher) -> None:
        super().__init__(
            kernel.py_func, kernel.targetdescr, kernel.targetoptions, kernel.locals, pipeline_class=compiler.Compiler
        )
        self.parts: dict[tuple[Any, ...], Any] = {}

    def part(self, arguments: tuple[Any, ...]) -> Any:
        """Numba's result for these types of arguments, made the first time."""
        if arguments not in self.parts:
            self.parts[arguments] = self._make_part(arguments)
        return self.parts[arguments]

    def _make_part(self, arguments: tuple[Any, ...]) -> Any:
        flags = self._flags(as_part=True)
        typing_context, context = remembering(self.targetdescr.typing_context), self.targetdescr.target_context
        library = Part(context.codegen(), self.py_func.__qualname__)
        made = compiler.compile_extra(
            typing_context, context, self.py_func, arguments, None, flags, self.locals, library, self.pipeline_class
        )
        made = made._replace(entry_point=made.fndesc.mangled_name)  # what callers find it by
        context.insert_user_function(made.entry_point, made.fndesc, [library])
        return made

    def _compile_core(self, args: tuple[Any, ...], _return_type: Any) -> Any:
        made = self.part(tuple(args))
        context, described, environment = made.target_context, made.fndesc, made.environment
        seen = described.llvm_cpython_wrapper_name, context.get_env_name(described)
        library = Whole(context.codegen(), self.py_func.__qualname__, seen)
        library.enable_object_caching()
        with ConfigStack().enter(self._flags()), context.push_code_library(library):
            context.create_cpython_wrapper(
                library, described, environment, made.call_helper, self.targetoptions["nogil"]
            )
        library.add_linking_library(made.library)
        callable = context.get_executable(library, described, environment)
        return made._replace(entry_point=callable, library=library, metadata={})

    def _flags(self, as_part: bool = False) -> Any:
        options = repr(sorted(self.targetoptions.items())), as_part
        if options not in _SETTLED:
            flags: Any = Settled()
            self.targetdescr.options.parse_as_flags(flags, self.targetoptions)
            flags.no_compile = flags.no_cpython_wrapper = flags.no_cfunc_wrapper = as_part
            _SETTLED[options] = flags
        return _SETTLED[options]


@cache
def remembering(context: typing.Context) -> Remembering:
    """``context`` with its memory, the same for all kernels."""
    return Remembering(context)


class Kernel(CPUDispatcher):
    """A compiled function that is a part for kernels and a whole for Python; only wholes are cached."""

    def __init__(self, py_func: Callable[..., Any], targetoptions: dict[str, Any]) -> None:
        super().__init__(py_func, targetoptions=targetoptions)
        self._compiler = Compiler(self)
        self.enable_caching()

    @property
    def signatures(self) -> list[Any]:
        """The types of arguments for which there is a part or a whole."""
        return list({*list(self._compiler.parts), *list(self.overloads)})  # copies, as another thread may be adding

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """What a kernel that calls this one learns of it: one part, whether arguments vary or are written there."""
        signature, arguments = self._compiler.fold_argument_types(args, kws)
        arguments = tuple(types.unliteral(each) for each in arguments)
        self._compiler.part(arguments)
        signatures = [part.signature for part in self._compiler.parts.values()]
        name = self.py_func.__name__
        return typing.make_concrete_template(name, name, signatures), signature, arguments, {}

    def get_overload(self, sig: Any) -> Any:
        """What a kernel that calls this one finds its part by."""
        return self._compiler.parts[tuple(sigutils.normalize_signature(sig)[0])].entry_point


def compiled(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """A decorator that makes a function a ``Kernel`` with ``numba.njit``'s options; none is taken over from callers."""
    options = {"nopython": True, "forceinline": False, **options}
    disabled = vars(config)["DISABLE_JIT"]
    return lambda function: function if disabled else Kernel(function, options)
