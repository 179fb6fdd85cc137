"""``script``: run a Python file that uses ``studio.api``."""

import runpy
import sys
from argparse import Namespace

from studio.core.errors import StudioError
from studio.startup.kernel_warm_up import compile_first


def run(arguments: Namespace) -> int:
    """Run the file as ``__main__``, with its own arguments in ``sys.argv``; an error in it shows its traceback."""
    if not arguments.file.is_file():
        raise StudioError(f"There is no script '{arguments.file}'.")
    try:
        compile(arguments.file.read_bytes(), str(arguments.file), "exec")
    except (SyntaxError, ValueError) as error:
        raise StudioError(f"'{arguments.file}' is not a Python script: {error}.") from error
    except OSError as error:
        raise StudioError(f"'{arguments.file}' cannot be read: {error.strerror}.") from error
    compile_first()
    before = sys.argv, sys.path[:]
    sys.argv = [str(arguments.file), *arguments.arguments]
    sys.path.insert(0, str(arguments.file.resolve().parent))
    try:
        runpy.run_path(str(arguments.file), run_name="__main__")
    except SystemExit as ended:
        if ended.code is None or isinstance(ended.code, int):
            return ended.code or 0
        print(ended.code, file=sys.stderr)
        return 1
    finally:
        sys.argv, sys.path[:] = before
    return 0
