"""Many mutants tested in several copies at once, and the table of what became of them."""

from __future__ import annotations

import datetime
import math
import queue
import random
import tempfile
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from tests.mutations.mutation import Mutation
from tests.mutations.planting import ROOT, Copy, Outcome, Result

Say = Callable[[str], None]


@dataclass(frozen=True)
class Results:
    """What became of all mutants, in the order of the catalogue, and the time of the run."""

    pairs: tuple[tuple[Mutation, Result], ...]
    seconds: float

    def of(self, outcome: Outcome, equivalent: bool) -> list[tuple[Mutation, Result]]:
        """Return those of one outcome that are listed as equivalent, or are not."""
        return [
            (mutation, result)
            for mutation, result in self.pairs
            if result.outcome is outcome and bool(mutation.equivalent) == equivalent
        ]

    @property
    def status(self) -> int:
        """Exit status: 2 where something could not be tested, 1 where one survived."""
        if any(result.outcome is Outcome.BROKEN for _, result in self.pairs):
            return 2
        return 1 if self.of(Outcome.SURVIVED, equivalent=False) else 0


def stale(mutations: Sequence[Mutation]) -> list[str]:
    """Say what is wrong with a list of mutations: texts that are gone, tests that are none."""
    wrong = []
    for mutation in mutations:
        try:
            mutation.text(ROOT)
        except ValueError as error:
            wrong.append(str(error))
        wrong += [f"{mutation.file}: no test {name}" for name in mutation.missing_tests(ROOT)]
    return wrong


def share_of(mutations: Sequence[Mutation], share: float, seed: int) -> list[Mutation]:
    """Return a share of the mutations, in their order; one seed, one share."""
    count = math.ceil(share * len(mutations))
    chosen = random.Random(seed).sample(range(len(mutations)), count)
    return [mutations[i] for i in sorted(chosen)]


def run(mutations: Sequence[Mutation], jobs: int, say: Say) -> tuple[Results, int]:
    """Try mutations, each in a copy of the tree, after the tests have passed without any.

    Parameters
    ----------
    mutations
        What to try.
    jobs
        Copies that are worked in at the same time.
    say
        Takes a line whenever something is finished.

    Returns
    -------
    tuple
        The results and the exit status.
    """
    start = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="mutations-") as folder:
        count = min(jobs, len(mutations))
        copies = [Copy(Path(folder) / str(i)) for i in range(count)]
        tests = sorted({test for mutation in mutations for test in mutation.tests})
        say(f"{len(tests)} tests without mutations ...")
        failed = copies[0].baseline(tests, jobs)
        if failed:
            broken = Result(Outcome.BROKEN, "fails without mutation: " + ", ".join(failed), 0.0)
            return Results(((mutations[0], broken),), time.monotonic() - start), 2
        free: queue.Queue[Copy] = queue.Queue()
        for copy in copies:
            free.put(copy)
        lock, done = threading.Lock(), [0]

        def tried(mutation: Mutation) -> Result:
            copy = free.get()
            try:
                result = copy.tried(mutation)
            finally:
                free.put(copy)
            with lock:
                done[0] += 1
                say(
                    f"{done[0]}/{len(mutations)} {result.outcome} "
                    f"{result.seconds:.0f} s {mutation.name}"
                )
            return result

        with ThreadPoolExecutor(count) as pool:
            outcomes = list(pool.map(tried, mutations))
    pairs = tuple(zip(mutations, outcomes, strict=True))
    results = Results(pairs, time.monotonic() - start)
    return results, results.status


def report(results: Results, jobs: int) -> str:
    """Write the results as Markdown: survivors first, then equivalents, then all others."""
    survivors = results.of(Outcome.SURVIVED, equivalent=False)
    equivalents = [pair for pair in results.pairs if pair[0].equivalent]
    killed = results.of(Outcome.KILLED, equivalent=False)
    broken = [pair for pair in results.pairs if pair[1].outcome is Outcome.BROKEN]
    today = datetime.date.today().isoformat()
    lines = [
        f"{today}: {len(results.pairs)} mutations, {len(killed)} killed, "
        f"{len(survivors)} survived, {len(equivalents)} listed as equivalent, "
        f"{len(broken)} not tested; {results.seconds / 60:.0f} minutes with {jobs} jobs.",
        "",
    ]
    if broken:
        lines += ["Not tested:", ""]
        lines += [f"- {m.name}: {result.by}" for m, result in broken] + [""]
    if survivors:
        lines += ["Survivors:", ""]
        lines += [f"- {m.name}: {m.why}; not noticed by {_tests(m)}" for m, _ in survivors] + [""]
    if equivalents:
        lines += ["Equivalents:", ""]
        lines += [
            f"- {m.name}: {m.equivalent}" + (f" (killed by {r.by})" if r.by else "")
            for m, r in equivalents
        ] + [""]
    if killed:
        lines += ["| file | mutation | killed by | what it guards |", "|---|---|---|---|"]
        lines += [_row(mutation, result) for mutation, result in killed]
    return "\n".join(lines).rstrip() + "\n"


def _tests(mutation: Mutation) -> str:
    return ", ".join(mutation.tests)


def _row(mutation: Mutation, result: Result) -> str:
    change = mutation.name.removeprefix(f"{mutation.file}: ")
    cells = (mutation.file, change, result.by.split("::")[-1], mutation.why)
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"
