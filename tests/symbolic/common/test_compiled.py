"""Where machine code is kept, so that that of another version is never read."""

import subprocess
import sys
from pathlib import Path

from isotorque.symbolic.common.compiled import PACKAGE, cache_folder, module_names

SQUARE = """
from isotorque.symbolic.common.compiled import compiled
from {helper} import half
@compiled
def whole(x):
    return 2.0 * half(x)
"""
HALF = """
from collections import namedtuple
from numba import njit
Pair = namedtuple("Pair", "x y")
@njit
def half(pair):
    return 0.5 * pair.x + 0.0 * pair.y
"""


def test_a_new_name_of_a_module_is_a_new_folder(tmp_path):
    (tmp_path / "room").mkdir()
    (tmp_path / "room" / "old.py").write_text("x = 1")
    (tmp_path / "linked").symlink_to(tmp_path / "room")
    before = module_names(tmp_path)
    module_names.cache_clear()
    (tmp_path / "room" / "old.py").write_text("x = 2")
    assert module_names(tmp_path) == before  # contents are compared file by file
    module_names.cache_clear()
    (tmp_path / "room" / "old.py").rename(tmp_path / "room" / "new.py")
    assert module_names(tmp_path) != before


def test_what_is_kept_does_not_change_where_it_is_kept(tmp_path):
    (tmp_path / "room").mkdir()
    (tmp_path / "room" / "module.py").write_text("x = 1")
    before = module_names(tmp_path)
    module_names.cache_clear()
    kept = tmp_path / "room" / "__pycache__" / "numba-0123"
    kept.mkdir(parents=True)
    (kept / "module.nbi").touch()
    assert module_names(tmp_path) == before


def test_a_second_process_compiles_nothing(tmp_path):
    (tmp_path / "half.py").write_text(HALF)
    (tmp_path / "square.py").write_text(SQUARE.format(helper="half"))
    code = (
        "from pathlib import Path; import isotorque.symbolic.common.compiled as c;"
        "c.PACKAGE = Path('.'); from square import whole; from half import Pair;"
        "whole(Pair(3.0, 1.0)); print(sum(whole.stats.cache_hits.values()))"
    )
    hits = [
        subprocess.run(
            [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True
        ).stdout
        for _ in range(3)
    ]
    assert hits == ["0\n", "1\n", "1\n"]


def test_modules_behind_links_count():
    folder = cache_folder(Path(__file__).parent)
    assert folder is not None
    assert folder.name == f"numba-{module_names(PACKAGE)}"
    assert module_names(PACKAGE) != module_names(PACKAGE / "cli")
    assert (PACKAGE / "symbolic" / "common" / "compiled.py").is_file()


def test_code_compiled_with_a_module_of_another_name_is_not_read(tmp_path):
    """What was compiled with the old module cannot be read without it."""

    def run(helper):
        (tmp_path / f"{helper}.py").write_text(HALF)
        (tmp_path / "square.py").write_text(SQUARE.format(helper=helper))
        code = (
            "from pathlib import Path; import isotorque.symbolic.common.compiled as c;"
            "c.PACKAGE = Path('.'); from square import whole; import square, sys;"
            f"from {helper} import Pair; print(whole(Pair(3.0, 1.0)))"
        )
        done = subprocess.run(
            [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False
        )
        assert (done.returncode, done.stdout) == (0, "3.0\n"), done.stderr

    run("old_name")
    (tmp_path / "old_name.py").unlink()
    run("new_name")
