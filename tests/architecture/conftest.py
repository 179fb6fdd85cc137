from collections.abc import Iterator

import pytest

from tests.architecture.sources import functions_of, tree_of


@pytest.fixture(scope="package", autouse=True)
def trees_dropped() -> Iterator[None]:
    """Drop the syntax trees after the tests of this folder: the collector would visit them in all later tests."""
    yield
    functions_of.cache_clear()
    tree_of.cache_clear()
