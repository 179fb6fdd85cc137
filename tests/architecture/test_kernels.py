import ast

from tests.architecture.sources import KERNELS, functions_of, is_compiled, place_of, product_files


def compiled_functions():
    return [(file, each) for file in product_files() for each in functions_of(file) if is_compiled(each)]


def test_compiled_functions_live_in_the_kernels_and_nowhere_else():
    strays = [
        f"{place_of(file, function.lineno)} {function.name}"
        for file, function in compiled_functions()
        if KERNELS not in file.parents
    ]
    assert strays == []


def test_every_kernel_says_what_it_computes():
    silent = [
        f"{place_of(file, function.lineno)} {function.name}"
        for file, function in compiled_functions()
        if not ast.get_docstring(function)
    ]
    assert silent == []


def test_no_kernel_is_parallel_or_loses_nans():
    """Two threads on numba's own thread pool abort the process; fast maths may drop the test for a NaN."""
    for file, function in compiled_functions():
        decorators = " ".join(ast.unparse(decorator) for decorator in function.decorator_list)
        assert "parallel=True" not in decorators, place_of(file, function.lineno)
        assert "fastmath=True" not in decorators, place_of(file, function.lineno)
