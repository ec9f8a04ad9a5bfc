"""The package as others get it: installed in a fresh environment, used outside the repository.

Environments see the packages of the running one through a ``.pth`` file, so nothing is fetched.
"""

import os
import re
import shutil
import subprocess
import sys
import tarfile
import venv
import zipfile
from pathlib import Path

import pytest

import isotorque

ROOT = Path(__file__).parents[2]
SOURCE = (
    "isotorque",
    "symbolic",
    "learning",
    "verify",
    "pyproject.toml",
    "setup.py",
    "README.md",
    "LICENSE",
)
FOREIGN = 'raise RuntimeError("isotorque imported what is not its own")\n'

pytestmark = pytest.mark.slow


def call(*command, cwd, fails=False):
    """Run a command without the settings of this process; return its standard output."""
    clean = {
        k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "PIP_", "ISOTORQUE"))
    }
    clean["PIP_DISABLE_PIP_VERSION_CHECK"] = "1"
    found = subprocess.run(
        list(map(str, command)), cwd=cwd, env=clean, capture_output=True, text=True
    )
    assert (found.returncode != 0) == fails, found.stdout + found.stderr
    return found.stdout


def build(kind, source, out):
    """Build an sdist or a wheel of a source tree, as every front end does."""
    hook = f"import sys; from setuptools import build_meta as b; b.build_{kind}(sys.argv[1])"
    call(sys.executable, "-c", hook, out, cwd=source)
    [found] = out.glob("*.tar.gz" if kind == "sdist" else "*.whl")
    return found


@pytest.fixture(scope="module")
def source(tmp_path_factory):
    """A copy of the source tree, links kept, with what an earlier layout built still there."""
    tree = tmp_path_factory.mktemp("source")
    ignored = shutil.ignore_patterns("__pycache__", "*.egg-info", "build")
    for name in SOURCE:
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, tree / name, symlinks=True, ignore=ignored)
        else:
            shutil.copy(ROOT / name, tree / name)
    for stale in ("symbolic/gone.py", "isotorque/symbolic/gone.py", "isotorque/gone/__init__.py"):
        path = tree / "build" / "lib" / stale
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(FOREIGN)
    record = tree / "isotorque.egg-info" / "SOURCES.txt"
    record.parent.mkdir()
    record.write_text("isotorque/gone/__init__.py\nsymbolic/gone.py\n")
    return tree


@pytest.fixture(scope="module")
def sdist(source, tmp_path_factory):
    return build("sdist", source, tmp_path_factory.mktemp("sdist"))


@pytest.fixture(scope="module")
def wheel(source, tmp_path_factory):
    return build("wheel", source, tmp_path_factory.mktemp("wheel"))


@pytest.fixture(scope="module")
def wheel_of_sdist(sdist, tmp_path_factory):
    unpacked = tmp_path_factory.mktemp("unpacked")
    with tarfile.open(sdist) as archive:
        archive.extractall(unpacked, filter="data")
    [tree] = unpacked.iterdir()
    return build("wheel", tree, tmp_path_factory.mktemp("wheel-of-sdist"))


def contents(wheel):
    """Files of a wheel, the list of them apart."""
    with zipfile.ZipFile(wheel) as archive:
        names = [name for name in archive.namelist() if not name.endswith("/RECORD")]
        return {name: archive.read(name) for name in names}


def wanted():
    """All files that the package consists of, links followed: modules and what they read."""
    found = set()
    for folder, _, names in os.walk(ROOT / "isotorque", followlinks=True):
        if "__pycache__" not in folder:
            here = Path(folder).relative_to(ROOT)
            found |= {(here / name).as_posix() for name in names}
    return found


def test_a_wheel_holds_every_file_of_the_package_and_nothing_else(wheel):
    found = {name for name in contents(wheel) if ".dist-info/" not in name}
    assert found == wanted()
    assert {"isotorque/py.typed", "isotorque/symbolic/robot_files/2r.urdf"} <= found
    assert any(name.startswith("isotorque/verify/report/templates/") for name in found)


def test_a_wheel_of_the_sdist_is_the_wheel(wheel, wheel_of_sdist):
    assert contents(wheel_of_sdist) == contents(wheel)


def test_an_sdist_holds_files_and_no_links(sdist):
    with tarfile.open(sdist) as archive:
        members = archive.getmembers()
    assert not [member.name for member in members if member.issym() or "gone" in member.name]
    assert any(
        member.name.endswith("/isotorque/symbolic/robot_files/2r.urdf") for member in members
    )


class Environment:
    """A fresh environment with isotorque in it, and a working directory with foreign modules."""

    def __init__(self, folder, *what):
        venv.create(folder, symlinks=True)
        self.bin = folder / "bin"
        [self.packages] = folder.glob("lib/python*/site-packages")
        others = [path for path in sys.path if path.endswith(("site-packages", "dist-packages"))]
        (self.packages / "others.pth").write_text("\n".join(others))
        before = set(self.packages.iterdir())
        pip = (sys.executable, "-m", "pip", "--python", self.bin / "python", "install", "--quiet")
        call(*pip, "--no-deps", "--no-index", "--no-build-isolation", *what, cwd=folder)
        self.installed = {path.name for path in set(self.packages.iterdir()) - before}
        (self.packages / "symbolic").mkdir()
        (self.packages / "symbolic" / "__init__.py").write_text(FOREIGN)
        self.work = folder / "work"
        (self.work / "learning").mkdir(parents=True)
        (self.work / "learning" / "__init__.py").write_text(FOREIGN)
        (self.work / "verify.py").write_text(FOREIGN)

    def isotorque(self, *arguments):
        """Run the command in the working directory."""
        return call(self.bin / "isotorque", *arguments, cwd=self.work)

    def python(self, *arguments):
        """Run Python in the working directory, which is then the first place of its path."""
        return call(self.bin / "python", *arguments, cwd=self.work)


@pytest.fixture(scope="module")
def from_sdist(wheel_of_sdist, tmp_path_factory):
    return Environment(tmp_path_factory.mktemp("from-sdist"), wheel_of_sdist)


@pytest.fixture(scope="module")
def editable(source, tmp_path_factory):
    return Environment(tmp_path_factory.mktemp("editable"), "--editable", source)


@pytest.fixture(params=["from_sdist", "editable"])
def environment(request):
    return request.getfixturevalue(request.param)


def test_only_isotorque_lands_in_site_packages(from_sdist, editable):
    assert sorted(name.split("-")[0] for name in from_sdist.installed) == ["isotorque"] * 2
    names = editable.installed - {"__pycache__"}
    assert all(re.match(r"(__editable__[._]+)?isotorque[-_]", name) for name in names), names


def test_foreign_modules_of_the_same_names_are_neither_used_nor_hidden(environment):
    for name in ("symbolic", "learning", "verify"):
        call(environment.bin / "python", "-c", f"import {name}", cwd=environment.work, fails=True)
    where = "import isotorque.verify.verdict as v; print(v.__file__)"
    assert str(ROOT) not in environment.python("-c", where)
    assert "panda" in environment.python("-m", "isotorque", "robots")


def test_commands_work_outside_the_repository(environment):
    assert environment.isotorque("simulate", "2r", "--torque", "3,1").startswith("settled")
    environment.isotorque(
        "run", "pendulum", "--learner", "recursive-least-squares", "--samples", "40", "--out", "out"
    )
    assert (environment.work / "out" / "report.html").stat().st_size > 10_000


def test_worker_processes_find_the_same_package(environment):
    (environment.work / "table.toml").write_text(
        'robots = ["pendulum"]\nlearners = ["recursive-least-squares"]\nseeds = 2\nsamples = 20\n'
    )
    environment.python("-m", "isotorque", "sweep", "table.toml", "--jobs", "2", "--out", "sweep")
    assert any((environment.work / "sweep").iterdir())


def test_the_version_is_told_by_the_package_and_by_its_metadata(environment):
    says = "import isotorque; from importlib.metadata import version as v; print(v('isotorque'))"
    assert environment.python("-c", f"{says}; print(isotorque.__version__)").split() == (
        [isotorque.__version__] * 2
    )


def test_the_wheel_of_an_sdist_runs_the_whole_scheme(from_sdist):
    assert from_sdist.isotorque("run", "2r", "--out", "run").startswith("passed")
    assert (from_sdist.work / "run" / "report.html").stat().st_size > 10_000
