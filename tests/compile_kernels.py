"""Compile what most tests call, once for all the processes that run them: python -m tests.compile_kernels."""

from studio.startup.process import prepare_process

if __name__ == "__main__":
    prepare_process()
    from studio.startup.kernel_warm_up import compile_first  # late: it imports numba, whose cache is named above

    compile_first()
