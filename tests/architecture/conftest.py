import gc
from collections.abc import Iterator

import pytest

from tests.architecture.sources import functions_of, tree_of


@pytest.fixture(scope="package", autouse=True)
def trees_dropped() -> Iterator[None]:
    """Keep Python's collector off while there are syntax trees, which it would visit many times, then drop them."""
    gc.disable()
    yield
    functions_of.cache_clear()
    tree_of.cache_clear()
    gc.enable()
