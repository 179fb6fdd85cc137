"""Warm up, do everything, and print the kernels that were compiled, or fetched, only then: a process of a test."""

from importlib import import_module
from pkgutil import walk_packages

from studio.startup.kernel_warm_up import WarmUp
from studio.startup.process import prepare_process


def called() -> set[tuple[str, str]]:
    """Kernels that Python called, each with the types of its arguments."""
    package = import_module("studio.core.kernels")
    modules = [import_module(module.name) for module in walk_packages(package.__path__, f"{package.__name__}.")]
    found = {each for module in modules for each in vars(module).values() if hasattr(each, "overloads")}
    return {(each.__name__, str(types)) for each in found for types in each.overloads}


if __name__ == "__main__":
    prepare_process()
    WarmUp().follow(lambda _share, _text: None)
    warmed = called()
    import_module("tests.startup.everything").do_everything()
    print("\n".join(f"{kernel}{types}" for kernel, types in sorted(called() - warmed)))
