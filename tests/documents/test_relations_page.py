"""The examples of docs/relations.md run."""

import doctest
from pathlib import Path


def test_the_examples_of_the_page_run():
    page = Path(__file__).parents[2] / "docs" / "relations.md"
    tried = doctest.testfile(str(page), module_relative=False, raise_on_error=True)
    assert tried.attempted > 5
    assert tried.failed == 0
