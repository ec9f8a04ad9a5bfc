"""Mutations that do not apply any more are told from those that do."""

import pytest

from tests.mutations.mutation import Mutation


@pytest.fixture
def tree(tmp_path):
    (tmp_path / "guard.py").write_text("def guard(x):\n    return x > 0 or x < 0\n")
    (tmp_path / "test_guard.py").write_text(
        "def test_it():\n    pass\n\n\nclass TestMore:\n    def test_again(self):\n        pass\n"
    )
    return tmp_path


def mutation(original="x > 0", mutated="x > 1", file="guard.py", tests=("test_guard.py",)):
    return Mutation(file, original, mutated, tests, "an example")


def test_a_mutation_changes_one_place(tree):
    assert mutation().text(tree) == "def guard(x):\n    return x > 1 or x < 0\n"


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"original": "x > 5"}, "has 0 times `x > 5`"),
        ({"original": "x"}, "has 3 times `x`"),
        ({"file": "other.py"}, "other.py is no file"),
        ({"mutated": "x >"}, "is no Python"),
        ({"mutated": "x > 0"}, "is not changed"),
    ],
)
def test_what_does_not_apply_is_said(tree, changed, said):
    with pytest.raises(ValueError, match=said):
        mutation(**changed).text(tree)


def test_tests_that_are_none_are_named(tree):
    there = ("test_guard.py", "test_guard.py::test_it", "test_guard.py::TestMore::test_again")
    missing = ("test_gone.py", "test_guard.py::test_gone", "test_guard.py::TestMore::test_it")
    assert mutation(tests=there + missing).missing_tests(tree) == list(missing)
