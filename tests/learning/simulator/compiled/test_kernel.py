"""The cache of compiled functions is renewed whenever one of their files changes."""

import ast
from pathlib import Path

from isotorque.learning.simulator.compiled import kernel
from isotorque.learning.simulator.compiled import motion as compiled_motion

FOLDER = Path(kernel.__file__).parent
ROOM = FOLDER.parent


def test_all_that_kernels_use_is_in_their_fingerprint():
    """Follow the imports of the compiled modules through the package."""
    counted = set(kernel.sources(FOLDER))
    python_only = {
        ROOM / f"{name}.py" for name in ("dynamics/engine", "dynamics/equations", "settings")
    }
    for path in sorted(counted):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and node.module:
                _, inside, module = node.module.partition("isotorque.learning.simulator.")
                if inside:
                    used = ROOM / f"{module.replace('.', '/')}.py"
                    assert used in counted | python_only, (path, module)


def test_a_change_of_any_of_them_changes_the_fingerprint(tmp_path):
    copy = tmp_path / FOLDER.name
    for path in kernel.sources(FOLDER):
        (tmp_path / path.parent.name).mkdir(exist_ok=True)
        (tmp_path / path.parent.name / path.name).write_bytes(path.read_bytes())
    uncached = kernel._fingerprint.__wrapped__
    before = uncached(copy)
    assert before == uncached(FOLDER)
    for path in kernel.sources(copy):
        text = path.read_bytes()
        path.write_bytes(text + b"# changed\n")
        assert uncached(copy) != before
        path.write_bytes(text)


def test_kernels_are_cached_there():
    folder = str(Path(compiled_motion.move.stats.cache_path))
    assert f"kernels-{kernel._fingerprint(FOLDER)}" in folder
