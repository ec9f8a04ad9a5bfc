"""What came of data sets: judged one by one, and kept, so that what was stopped goes on."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from benchmarks.claims.claims import Claims, judged_claims
from benchmarks.claims.data_sets import Setting, draw
from benchmarks.claims.naming import Naming, judged_naming
from isotorque.parallel import in_processes

ROOT = Path(__file__).parents[2]
CODE = (
    "symbolic/**/*.py",
    "learning/**/*.py",
    "verify/testing/contaminated_arms.py",
    "benchmarks/claims/data_sets.py",
    "benchmarks/claims/claims.py",
    "benchmarks/claims/naming.py",
)
"""Files that outcomes depend on."""


@dataclass(frozen=True)
class Outcome:
    """What came of one data set.

    Attributes
    ----------
    setting : Setting
    joint : int or None
        Where the contamination is, from 0.
    size, deviations : float
        In the unit of its kind; in least standard errors.
    claims : Claims
    naming : Naming
    """

    setting: Setting
    joint: int | None
    size: float
    deviations: float
    claims: Claims
    naming: Naming

    @classmethod
    def of(cls, plain: dict[str, Any]) -> Outcome:
        """Make it of what JSON gives back of `asdict`."""
        naming = dict(plain["naming"])
        for name in ("right", "parts"):
            naming[name] = tuple((kind, joint) for kind, joint in naming[name])
        naming["named"] = tuple(tuple((k, j) for k, j in rivals) for rivals in naming["named"])
        return cls(
            Setting(**plain["setting"]),
            plain["joint"],
            plain["size"],
            plain["deviations"],
            Claims(**plain["claims"]),
            Naming(**naming),
        )


def judged(setting: Setting) -> Outcome:
    """Draw a data set, learn from it, judge."""
    data = draw(setting)
    return Outcome(
        setting,
        data.contamination.joint,
        data.size,
        data.deviations,
        judged_claims(setting.robot, data),
        judged_naming(data),
    )


def outcomes(settings: Sequence[Setting], cache: Path | None, jobs: int) -> Iterator[Outcome]:
    """Outcomes of data sets: those that are kept, then the others as they come.

    Parameters
    ----------
    settings
        Which.
    cache
        File of one line each; None: nothing is kept. Lines that other code has written are left
        alone: their outcomes are made anew.
    jobs
        Number of processes.
    """
    code = code_mark()
    kept = {} if cache is None else _read(cache, code)
    yield from (kept[setting] for setting in settings if setting in kept)
    left = [setting for setting in settings if setting not in kept]
    for _, outcome in in_processes(judged, left, jobs):
        if cache is not None:
            cache.parent.mkdir(parents=True, exist_ok=True)
            with cache.open("a", encoding="utf-8") as file:
                file.write(json.dumps({"code": code, **asdict(outcome)}) + "\n")
        yield outcome


def code_mark() -> str:
    """Digest of everything that outcomes depend on."""
    digest = hashlib.sha256()
    for pattern in CODE:
        for path in sorted(ROOT.glob(pattern)):
            digest.update(str(path.relative_to(ROOT)).encode() + path.read_bytes())
    return digest.hexdigest()[:16]


def _read(path: Path, code: str) -> dict[Setting, Outcome]:
    """Outcomes of a file, without a last line that was cut off."""
    if not path.exists():
        return {}
    found = []
    for line in path.read_text(encoding="utf-8").splitlines():
        try:
            plain = json.loads(line)
        except ValueError:
            continue
        if plain.pop("code") == code:
            found.append(Outcome.of(plain))
    return {outcome.setting: outcome for outcome in found}
