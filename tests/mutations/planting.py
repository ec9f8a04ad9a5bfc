"""Copies of the source tree in which one mutation at a time is planted and tested."""

from __future__ import annotations

import ast
import compileall
import os
import py_compile
import resource
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from pathlib import Path

from tests.mutations.mutation import Mutation

ROOT = Path(__file__).resolve().parents[2]
SECONDS = 150
"""Processor time that the tests of one mutant may take; endless loops are killed by it."""
PATIENCE = 6
"""Times that of the clock: a busy machine is no endless loop."""
TESTS_FAILED, ALL_PASSED = 1, 0  # exit statuses of pytest
COMPILED = "isotorque.symbolic.common.compiled"


class Outcome(StrEnum):
    """What became of a mutant."""

    KILLED = "killed"
    SURVIVED = "survived"
    BROKEN = "broken"
    """It could not be tested: the tests did not start."""


@dataclass(frozen=True)
class Result:
    """What became of a mutant, by which test, and how long that took."""

    outcome: Outcome
    by: str
    seconds: float


class Copy:
    """A copy of what git knows of the source tree, with caches of its own.

    Notes
    -----
    Nothing stale is tested: byte code is checked by the hash of the source and never written, and
    where a mutation can reach a function compiled by numba, all of them are compiled anew.
    """

    def __init__(self, folder: Path) -> None:
        self.root = folder / "tree"
        self._caches = folder
        listed = subprocess.run(
            ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
            cwd=ROOT,
            check=True,
            capture_output=True,
        ).stdout
        for name in filter(None, listed.decode().split("\0")):
            source, target = ROOT / name, self.root / name
            if source.is_file() or source.is_symlink():
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(source, target, follow_symlinks=False)
        for room in ("isotorque", "symbolic", "learning", "verify", "benchmarks"):
            compileall.compile_dir(
                self.root / room,
                quiet=2,
                invalidation_mode=py_compile.PycInvalidationMode.CHECKED_HASH,
            )

    def baseline(self, tests: list[str], jobs: int) -> list[str]:
        """Return the tests that fail without any mutation."""
        done = self._pytest(tests, self._caches / "compiled", ["-n", str(jobs)], SECONDS * 20)
        failed = _failures(done.stdout)
        if done.returncode not in (TESTS_FAILED, ALL_PASSED):
            failed.append(f"pytest ended with {done.returncode}: {done.stdout[-2000:]}")
        return failed

    def tried(self, mutation: Mutation) -> Result:
        """Plant a mutation, run its tests, take it out again."""
        place = self.root / mutation.file
        before = place.stat()
        original = place.read_bytes()
        fresh = reaches_compiled(mutation.file)
        cache = self._caches / ("compiled-anew" if fresh else "compiled")
        if fresh:
            shutil.rmtree(cache, ignore_errors=True)
        start = time.monotonic()
        try:
            place.write_text(mutation.text(self.root), encoding="utf-8")
            done = self._pytest(list(mutation.tests), cache, ["-x"], SECONDS)
        finally:
            place.write_bytes(original)
            os.utime(place, ns=(before.st_atime_ns, before.st_mtime_ns))
        seconds = time.monotonic() - start
        if done.returncode == ALL_PASSED:
            return Result(Outcome.SURVIVED, "", seconds)
        failed = _failures(done.stdout)
        # a file that cannot be collected ends pytest -x with the status of a test that failed
        if done.returncode == TESTS_FAILED and any("::" in test for test in failed):
            return Result(Outcome.KILLED, ", ".join(failed), seconds)
        if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
            return Result(Outcome.KILLED, f"more than {SECONDS} s of processor time", seconds)
        return Result(Outcome.BROKEN, done.stdout[-2000:] + done.stderr[-2000:], seconds)

    def _pytest(
        self, tests: list[str], cache: Path, options: list[str], seconds: int
    ) -> subprocess.CompletedProcess[str]:
        environment = {name: value for name, value in os.environ.items() if "PYTEST" not in name}
        environment |= {
            "PYTHONPATH": str(self.root),
            "PYTHONDONTWRITEBYTECODE": "1",
            "NUMBA_CACHE_DIR": str(cache),
            "HYPOTHESIS_STORAGE_DIRECTORY": str(self._caches / "hypothesis"),
            "ISOTORQUE_SLOW": "0",
            **dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"),
        }
        quiet = ["-q", "--tb=no", "-rfE", "-p", "no:cacheprovider", "--no-header"]
        quiet += ["--hypothesis-profile", "first-failure"]
        command = [sys.executable, "-m", "pytest", *quiet, *options, *tests]
        process = subprocess.Popen(
            command,
            cwd=self.root,
            env=environment,
            text=True,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            start_new_session=True,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 5)),
        )
        try:
            out, error = process.communicate(timeout=PATIENCE * seconds)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            out, error = process.communicate()
        return subprocess.CompletedProcess(command, process.returncode, out, error)


def _failures(output: str) -> list[str]:
    lines = [line for line in output.splitlines() if line.startswith(("FAILED ", "ERROR "))]
    return [line.split(" ", 1)[1].split(" - ")[0] for line in lines]


@cache
def _parsed(file: Path) -> ast.Module:
    return ast.parse(file.read_text(encoding="utf-8"))


@cache
def _imports(file: Path) -> dict[str, str]:
    """Names that a file imports anywhere in it, and the modules they come from."""
    found = {}
    for node in ast.walk(_parsed(file)):
        if isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                found[alias.asname or alias.name] = node.module
                found[f"{node.module}.{alias.name}"] = f"{node.module}.{alias.name}"
        elif isinstance(node, ast.Import):
            found |= {alias.name: alias.name for alias in node.names}
    return found


def _decorators(file: Path) -> set[str]:
    """Modules that the decorators of a file's functions come from."""
    used = set()
    for node in ast.walk(_parsed(file)):
        for decorator in getattr(node, "decorator_list", ()):
            call = decorator.func if isinstance(decorator, ast.Call) else decorator
            if isinstance(call, ast.Name):
                used.add(_imports(file).get(call.id, ""))
    return used


@cache
def _seen_by_compiled() -> frozenset[str]:
    """Modules with compiled functions, and all that they import: constants are compiled in."""
    rooms = ("symbolic", "learning", "verify")
    files = {
        "isotorque." + ".".join(path.relative_to(ROOT).with_suffix("").parts): path
        for room in rooms
        for path in (ROOT / room).rglob("*.py")
    }
    reached = {name for name, path in files.items() if COMPILED in _imports(path).values()}
    more = reached
    while more:  # decorators that compile may be made elsewhere
        more = {name for name, path in files.items() if _decorators(path) & reached} - reached
        reached |= more
    fresh = set(reached)
    while fresh:
        seen = {name for module in fresh for name in _imports(files[module]).values()}
        fresh = (seen & files.keys()) - reached
        reached |= fresh
    return frozenset(reached)


def reaches_compiled(file: str) -> bool:
    """Say whether what a file defines can be inside a function compiled by numba."""
    return "isotorque." + ".".join(Path(file).with_suffix("").parts) in _seen_by_compiled()
