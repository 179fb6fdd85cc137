"""Kernels are translated once each, and linked, optimised and assembled once for each entry point that Python calls.

Numba links the code of all callees into each function's library, and optimises and assembles it there, so that a leaf
of a deep call tree is compiled again at every level above it. Here a kernel called by kernels is a ``KernelPart``, kept
as it was translated; an entry point is a ``KernelProgram``: the parts that it needs, linked, with no symbol visible
from outside, so that the optimiser may inline and reshape every call.
"""

# mypy: allow-untyped-calls, allow-subclassing-any
# Numba says no types of its own.

from collections.abc import Callable, Iterable
from functools import cache
from typing import Any

from llvmlite.binding import ffi  # type: ignore[import-untyped]
from numba.core import (
    compiler,
    compiler_machinery,
    config,
    postproc,
    sigutils,
    transforms,
    typed_passes,
    types,
    typing,
    untyped_passes,
)
from numba.core.codegen import CodeLibrary, JITCodeLibrary
from numba.core.dispatcher import _FunctionCompiler  # type: ignore[attr-defined]
from numba.core.environment import Environment
from numba.core.registry import CPUDispatcher
from numba.core.targetconfig import ConfigStack

KERNEL_PASSES = (
    untyped_passes.TranslateByteCode,
    untyped_passes.FixupArgs,
    untyped_passes.IRProcessing,
    untyped_passes.RewriteSemanticConstants,
    untyped_passes.DeadBranchPrune,
    untyped_passes.GenericRewrites,
    untyped_passes.ReconstructSSA,
    typed_passes.NopythonTypeInference,
    typed_passes.PreLowerStripPhis,
    typed_passes.NopythonRewrites,
    typed_passes.IRLegalization,
    typed_passes.NativeLowering,
    typed_passes.NoPythonBackend,
)
ENVIRONMENT = "_ZN08NumbaEnv"
"""Prefix of the names under which compiled code finds its Python objects."""
_SETTLED: dict[tuple[str, bool], Any] = {}
"""Flags by the options of a kernel and by part or program."""


for _listener in tuple(ffi.lib._lock._cblist):  # of numba's, told of every call of LLVM: a twentieth of compiling
    ffi.unregister_lock_callback(*_listener)


class KernelPostProcessor(postproc.PostProcessor):
    """Numba's post-processing of a kernel's intermediate code, without the computation of live variables.

    Numba finds the variables alive at the entry of each block seven times for each kernel; only generators and object
    mode read them.
    """

    def run(self, emit_dels: bool = False, extend_lifetimes: bool = False) -> None:
        """Recompute the order of the blocks; with ``emit_dels`` add deletions of variables after their last use."""
        code = self.func_ir
        if code.is_generator or not isinstance(ConfigStack.top_or_none(), SharedFlags):
            super().run(emit_dels, extend_lifetimes)
            return
        code.blocks = transforms.canonicalize_cfg(code.blocks)
        code.variable_lifetime, code.generator_info = postproc.VariableLifetime(code.blocks), None
        if emit_dels:
            self._insert_var_dels(extend_lifetimes=extend_lifetimes)


postproc.PostProcessor = KernelPostProcessor  # type: ignore[misc]


class KernelPart(JITCodeLibrary):
    """Library of one kernel without its callees, never assembled to machine code."""

    def finalize(self) -> None:
        """Make the library linkable any number of times, without optimising or assembling it."""
        for function in self._final_module.functions:
            if not function.is_declaration:
                function.linkage = "linkonce_odr"
        self._shared_module, self._finalized = self._final_module, True


class KernelProgram(JITCodeLibrary):
    """Library of an entry point, linked with all kernels that it calls."""

    def __init__(self, codegen: Any, name: str, seen: Iterable[str]) -> None:
        super().__init__(codegen, name)
        self._seen = frozenset(seen)

    def add_linking_library(self, library: CodeLibrary) -> None:
        """Link a library and its callees once, callers first."""
        below: list[CodeLibrary] = []
        self._note_below(library, below)
        for each in reversed(below):
            super().add_linking_library(each)

    def _note_below(self, library: CodeLibrary, found: list[CodeLibrary]) -> None:
        """Append a library to ``found``, after its callees."""
        if library in found or library in self._linking_libraries:
            return
        if isinstance(library, KernelPart):
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


class SharedFlags(compiler.Flags):
    """Immutable compiler flags that kernels share, compared by identity.

    Numba looks up each callee by its flags, and would compare them option by option.
    """

    __hash__ = object.__hash__

    def __eq__(self, other: object) -> bool:
        return self is other


class CachingTypingContext:
    """Typing context that resolves each operator or builtin function once for each combination of types.

    Numba tries all candidates, numpy's among them, for every sum of every kernel: an eighth of all instructions of
    compiling.
    """

    def __init__(self, context: typing.Context) -> None:
        self._context = context
        self._found: dict[tuple[Any, tuple[Any, ...]], Any] = {}

    def __getattr__(self, name: str) -> Any:
        return getattr(self._context, name)

    def resolve_function_type(self, function: Any, arguments: tuple[Any, ...], named: dict[str, Any]) -> Any:
        """Signature of a call, None where there is none."""
        known = getattr(function, "typing_key", function)
        if named or getattr(known, "__module__", None) not in ("_operator", "builtins", "math"):
            return self._context.resolve_function_type(function, arguments, named)
        call = known, tuple(arguments)
        if call not in self._found:
            self._found[call] = self._context.resolve_function_type(function, arguments, named)
        return self._found[call]


class KernelPipeline(compiler.CompilerBase):
    """Passes of numba that kernels need.

    Kernels have no closures, contexts, inlined Python functions or parallel loops; numba looks for them in each. It
    also copies the flags, so that each kernel would compile ``np.zeros`` and its like anew for itself.
    """

    def _compile_core(self) -> Any:
        with ConfigStack().enter(self.state.flags):
            kernel_passes().run(self.state)
        self.state.pipeline = None
        return self.state.cr


@cache
def kernel_passes() -> compiler_machinery.PassManager:
    """Manager of the compiler passes of ``KERNEL_PASSES``, in order."""
    passes = compiler_machinery.PassManager("kernel")
    for each in KERNEL_PASSES:
        passes.add_pass(each, each.name())
    passes.finalize()
    return passes


class PartCompiler(_FunctionCompiler):
    """Compiler of one kernel: to a ``KernelPart`` for calls by kernels, to a ``KernelProgram`` for calls by Python."""

    def __init__(self, kernel: CPUDispatcher) -> None:
        super().__init__(
            kernel.py_func, kernel.targetdescr, kernel.targetoptions, kernel.locals, pipeline_class=KernelPipeline
        )
        self.parts: dict[tuple[Any, ...], Any] = {}

    def part(self, arguments: tuple[Any, ...]) -> Any:
        """Numba's compile result for these argument types, compiled once."""
        if arguments not in self.parts:
            self.parts[arguments] = self._make_part(arguments)
        return self.parts[arguments]

    def _make_part(self, arguments: tuple[Any, ...]) -> Any:
        flags = self._flags(as_part=True)
        typing_context, context = caching_context(self.targetdescr.typing_context), self.targetdescr.target_context
        library = KernelPart(context.codegen(), self.py_func.__qualname__)
        made = compiler.compile_extra(
            typing_context, context, self.py_func, arguments, None, flags, self.locals, library, self.pipeline_class
        )
        made = made._replace(entry_point=made.fndesc.mangled_name)  # what callers find it by
        # A program that another process has put into the cache since brings its own environment, with its constants.
        Environment._memo.pop(made.fndesc.env_name, None)
        context.insert_user_function(made.entry_point, made.fndesc, [library])
        return made

    def _compile_core(self, args: tuple[Any, ...], _return_type: Any) -> Any:
        made = self.part(tuple(args))
        context, described, environment = made.target_context, made.fndesc, made.environment
        seen = described.llvm_cpython_wrapper_name, context.get_env_name(described)
        library = KernelProgram(context.codegen(), self.py_func.__qualname__, seen)
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
            flags: Any = SharedFlags()
            self.targetdescr.options.parse_as_flags(flags, self.targetoptions)
            flags.no_compile = flags.no_cpython_wrapper = flags.no_cfunc_wrapper = as_part
            _SETTLED[options] = flags
        return _SETTLED[options]


@cache
def caching_context(context: typing.Context) -> CachingTypingContext:
    """The ``CachingTypingContext`` of ``context``, shared by all kernels."""
    return CachingTypingContext(context)


class Kernel(CPUDispatcher):
    """Compiled function: a ``KernelPart`` for kernels, a ``KernelProgram`` for Python. Only programs are cached on
    disk.
    """

    def __init__(self, py_func: Callable[..., Any], targetoptions: dict[str, Any]) -> None:
        super().__init__(py_func, targetoptions=targetoptions)
        self._compiler = PartCompiler(self)
        self.enable_caching()

    @property
    def signatures(self) -> list[Any]:
        """Argument types for which a part or a program has been compiled."""
        return list({*list(self._compiler.parts), *list(self.overloads)})  # copies, as another thread may be adding

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Call template for a kernel that calls this one; literal arguments count as their types."""
        signature, arguments = self._compiler.fold_argument_types(args, kws)
        arguments = tuple(types.unliteral(each) for each in arguments)
        self._compiler.part(arguments)
        signatures = [fraction.signature for fraction in self._compiler.parts.values()]
        name = self.py_func.__name__
        return typing.make_concrete_template(name, name, signatures), signature, arguments, {}

    def get_overload(self, sig: Any) -> Any:
        """Entry point of the part with this signature."""
        return self._compiler.parts[tuple(sigutils.normalize_signature(sig)[0])].entry_point


def compiled(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """Decorator that makes a function a ``Kernel`` with ``numba.njit``'s options; callers' options are not
    inherited.
    """
    options = {"nopython": True, "forceinline": False, **options}
    disabled = vars(config)["DISABLE_JIT"]
    return lambda function: function if disabled else Kernel(function, options)
