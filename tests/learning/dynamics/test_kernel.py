"""The cache of compiled functions is renewed whenever one of their files changes."""

import ast
from pathlib import Path

from learning.dynamics import compiled_motion, kernel

FOLDER = Path(kernel.__file__).parent


def test_all_that_kernels_use_is_in_their_fingerprint():
    """Follow the imports of the compiled modules through the package."""
    counted = {path.name for path in kernel.sources(FOLDER)}
    python_only = {"engine.py", "equations.py"}  # for annotations and results
    for name in sorted(counted):
        for node in ast.walk(ast.parse((FOLDER / name).read_text())):
            if isinstance(node, ast.ImportFrom) and node.module:
                package, _, module = node.module.rpartition(".")
                if package == "learning.dynamics":
                    assert f"{module}.py" in counted | python_only, (name, module)


def test_a_change_of_any_of_them_changes_the_fingerprint(tmp_path):
    for path in kernel.sources(FOLDER):
        (tmp_path / path.name).write_bytes(path.read_bytes())
    uncached = kernel._fingerprint.__wrapped__
    before = uncached(tmp_path)
    assert before == uncached(FOLDER)
    for path in kernel.sources(tmp_path):
        text = path.read_bytes()
        path.write_bytes(text + b"# changed\n")
        assert uncached(tmp_path) != before
        path.write_bytes(text)


def test_kernels_are_cached_there():
    folder = str(Path(compiled_motion.move.stats.cache_path))
    assert f"kernels-{kernel._fingerprint(FOLDER)}" in folder
