"""An installation that cannot be written, used by somebody without a home."""

import ctypes
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from isotorque.symbolic.common import cache_folders

ROOT = Path(__file__).parents[3]
NOBODY = 65534
WITHOUT_PLACES = ("NUMBA_CACHE_DIR", "MPLCONFIGDIR", "XDG_CACHE_HOME", "XDG_CONFIG_HOME")


@pytest.fixture(scope="module")
def installation():
    """A copy of the packages that nobody may write to, and a folder for temporary files."""
    folder = Path(tempfile.mkdtemp())  # pytest's own is closed to other users
    try:
        leave_out = shutil.ignore_patterns("__pycache__")
        shutil.copytree(ROOT / "isotorque", folder / "site" / "isotorque", ignore=leave_out)
        for path in [folder, *folder.rglob("*")]:
            path.chmod(0o555 if path.is_dir() else 0o444)
        yield folder / "site"
    finally:
        for path in [folder, *folder.rglob("*")]:
            path.chmod(0o755)
        shutil.rmtree(folder)


def obey_permissions():
    """Let root, too, write only where file modes allow it: drop CAP_DAC_OVERRIDE."""
    if os.geteuid() == 0:
        drop_from_bounding_set, dac_override = 24, 1
        assert ctypes.CDLL(None).prctl(drop_from_bounding_set, dac_override, 0, 0, 0) == 0


def as_somebody(installation, code, **places):
    """Run Python code without a home, from the read-only copy."""
    temporary = Path(tempfile.mkdtemp())
    temporary.chmod(0o777)
    environment = {k: v for k, v in os.environ.items() if k not in WITHOUT_PLACES}
    environment |= {"HOME": "/proc/nowhere", "TMPDIR": str(temporary)}
    environment |= {"PYTHONPATH": str(installation), "PYTHONDONTWRITEBYTECODE": "1", **places}
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=temporary,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=obey_permissions,
    )
    made = sorted(str(p.relative_to(temporary)) for p in temporary.rglob("*"))
    shutil.rmtree(temporary)
    return done, made


COMPILE = """
from isotorque.symbolic.common.compiled import compiled
from isotorque.learning.learners.local_linear import cell_list_search as cell_search
import isotorque.learning.simulator.compiled.motion
import isotorque.learning.relations.pairing.hough_transform
assert isotorque.__file__.startswith({site!r}), isotorque.__file__
import ctypes
import os
try:
    open(os.path.join(os.path.dirname(isotorque.__file__), "x"), "w")
except OSError:
    pass
else:
    raise AssertionError("the installation can be written")
import isotorque.verify.report.figures
assert "isotorque-" in os.environ["MPLCONFIGDIR"]
print(cell_search.cell_step.stats.cache_path)
"""


def test_everything_is_imported_in_silence(installation):
    done, made = as_somebody(installation, COMPILE.format(site=str(installation)))
    assert (done.returncode, done.stderr) == (0, "")
    ours = f"isotorque-{os.getuid()}"
    assert ours in done.stdout
    assert {name.split("/")[0] for name in made} == {ours}


def test_without_any_place_nothing_is_kept(installation):
    code = "import isotorque.learning.simulator.compiled.motion; from pathlib import Path\n"
    code += "from isotorque.symbolic.common.compiled import cache_folder\n"
    code += "print(cache_folder(Path(isotorque.__file__).parent))"
    blocked = "import os, tempfile; tempfile.tempdir = '/proc/nowhere'\n"
    done, made = as_somebody(installation, blocked + code)
    assert (done.returncode, done.stdout, done.stderr, made) == (0, "None\n", "", [])


def test_the_folder_that_the_user_names_is_taken(installation):
    place = Path(tempfile.mkdtemp())
    place.chmod(0o777)
    try:
        code = "from isotorque.learning.learners.local_linear.cell_list_search import cell_step\n"
        code += "print(cell_step.stats.cache_path)"
        done, made = as_somebody(installation, code, NUMBA_CACHE_DIR=str(place))
        assert (done.returncode, done.stderr, made) == (0, "", [])
        assert done.stdout.startswith(str(place))
    finally:
        shutil.rmtree(place)


@pytest.mark.slow
def test_commands_work_in_silence(installation):
    for command in (
        ["simulate", "2r", "--torque", "5,1"],
        [
            "run",
            "pendulum",
            "--out",
            "out",
            "--samples",
            "20",
            "--quiet",
            "--learner",
            "recursive-least-squares",
        ],
    ):
        code = f"from isotorque.cli.main import run; run({command!r})"
        done, _ = as_somebody(installation, code)
        assert (done.returncode, done.stderr) == (0, ""), command


def test_all_compiled_functions_know_where_they_are_kept():
    """No module asks numba by itself, which gives up where it finds no place."""
    apart = {"symbolic/common/compiled.py", "learning/simulator/compiled/kernel.py"}
    for package in ("symbolic", "learning", "verify", "isotorque"):
        for path in (ROOT / package).rglob("*.py"):
            if "njit" in path.read_text():
                assert str(path.relative_to(ROOT)) in apart


def test_matplotlib_is_given_a_folder_before_it_is_imported():
    for package in ("symbolic", "learning", "verify", "isotorque"):
        for path in (ROOT / package).rglob("*.py"):
            if path.parent.name != "figures":
                imports = [line for line in path.read_text().splitlines() if "matplotlib" in line]
                assert not any(line.startswith(("import", "from")) for line in imports), path


@pytest.fixture
def fresh(monkeypatch, tmp_path):
    """A user whose home cannot be written, with a folder for temporary files."""
    monkeypatch.setenv("HOME", "/proc/nowhere")
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    cache_folders.user_cache.cache_clear()
    cache_folders.can_write.cache_clear()
    yield tmp_path / f"isotorque-{os.getuid()}"
    cache_folders.user_cache.cache_clear()
    cache_folders.can_write.cache_clear()


def test_the_temporary_folder_is_for_one_user_alone(fresh):
    assert cache_folders.user_cache() == fresh
    assert fresh.stat().st_mode & 0o777 == 0o700


def open_to_all(fresh):
    fresh.mkdir()
    fresh.chmod(0o777)


def a_link(fresh):
    (fresh.parent / "elsewhere").mkdir(mode=0o700)
    fresh.symlink_to(fresh.parent / "elsewhere")


def a_file(fresh):
    fresh.touch()


def of_another_user(fresh):
    if os.geteuid() != 0:
        pytest.skip("only root may give a folder away")
    fresh.mkdir(mode=0o700)
    os.chown(fresh, NOBODY, NOBODY)


@pytest.mark.parametrize("prepare", [open_to_all, a_link, a_file, of_another_user])
def test_a_folder_that_others_could_have_filled_is_not_read(fresh, prepare):
    prepare(fresh)
    assert cache_folders.user_cache() is None


def test_a_path_that_is_not_absolute_is_no_place(fresh, monkeypatch):
    monkeypatch.chdir(fresh.parent)
    assert not cache_folders.can_write(Path("~/.cache"))
    assert list(fresh.parent.iterdir()) == []
