"""A deliberate fault in one place of the source, and the tests that must notice it."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Mutation:
    """A fault to plant.

    Attributes
    ----------
    file : str
        Path of the source file, from the root of the repository.
    original : str
        Text of the file that is replaced; it occurs exactly once.
    mutated : str
        What stands in its place.
    tests : tuple of str
        Test files, or single tests as ``file::test``, nearest to the guard: one must fail.
    why : str
        What would be trusted wrongly if nobody noticed.
    equivalent : str
        Why no test can notice it; empty where one must.
    """

    file: str
    original: str
    mutated: str
    tests: tuple[str, ...]
    why: str
    equivalent: str = ""

    @property
    def name(self) -> str:
        """File and the change in one line."""
        before, after = (" ".join(text.split()) for text in (self.original, self.mutated))
        return f"{self.file}: `{before}` becomes `{after or '(nothing)'}`"

    def text(self, root: Path) -> str:
        """Return the mutated file.

        Raises
        ------
        ValueError
            If the mutation is stale: the original text is not there exactly once.
        """
        path = root / self.file
        if not path.is_file():
            raise ValueError(f"stale: {self.file} is no file (of `{self.original}`)")
        source = path.read_text(encoding="utf-8")
        count = source.count(self.original)
        if count != 1:
            raise ValueError(f"stale: {self.file} has {count} times `{self.original}`, not once")
        if self.original == self.mutated:
            raise ValueError(f"{self.file}: `{self.original}` is not changed")
        changed = source.replace(self.original, self.mutated)
        try:
            compile(changed, self.file, "exec")
        except SyntaxError as error:
            raise ValueError(f"{self.name} is no Python: {error}") from None
        return changed

    def missing_tests(self, root: Path) -> list[str]:
        """Return the tests that are named and do not exist."""
        return [test for test in self.tests if not _exists(root, test)]


def _exists(root: Path, test: str) -> bool:
    name, *inside = test.split("::")
    path = root / name
    if not path.is_file():
        return False
    body: list[ast.stmt] = ast.parse(path.read_text(encoding="utf-8")).body
    for wanted in inside:
        found = next(
            (
                node
                for node in body
                if isinstance(node, ast.FunctionDef | ast.ClassDef) and node.name == wanted
            ),
            None,
        )
        if found is None:
            return False
        body = found.body
    return True
