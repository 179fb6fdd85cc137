"""Compile what most tests call, once for all the processes that run them: python -m tests.compile_kernels."""

from studio.cli.process import prepare_process

if __name__ == "__main__":
    prepare_process()
    from studio.cli.warm_up import compile_first  # late: it imports numba, whose cache is named above

    compile_first()
