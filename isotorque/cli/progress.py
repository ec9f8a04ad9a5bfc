"""Progress bars on standard error."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext


@contextmanager
def progress_bars(quiet: bool) -> Iterator[Callable[[str, int, int, str], None]]:
    """Yield ``progress(stage, done, total, note)``; a total of 0 is one that is not known.

    Where standard error is not a terminal, one line is printed for each finished stage.
    """
    if quiet:
        yield lambda stage, done, total, note: None
        return
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TaskID,
        TextColumn,
        TimeElapsedColumn,
    )

    console = Console(stderr=True)
    columns = (
        TextColumn("{task.description:28s}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("{task.fields[note]}"),
    )
    tasks: dict[str, TaskID] = {}
    notes: dict[str, str] = {}
    counts: dict[str, int] = {}
    bars = Progress(*columns, console=console, disable=not console.is_terminal)
    # rich before 14.3 ends bars with an empty line even where none are shown
    with bars if console.is_terminal else nullcontext():

        def update(stage: str, done: int, total: int, note: str) -> None:
            if stage not in tasks:
                for task in tasks.values():  # the stage before is complete
                    bars.update(task, total=bars.tasks[task].completed)
                tasks[stage] = bars.add_task(stage, total=total or None, note="")
            notes[stage] = note or notes.get(stage, "")
            counts[stage] = done
            bars.update(tasks[stage], completed=done, total=total or None, note=notes[stage])

        yield update
        for task in tasks.values():
            bars.update(task, total=bars.tasks[task].completed)
    if not console.is_terminal:
        for stage, note in notes.items():
            console.print(f"{stage}: {counts[stage]} {note}".rstrip(), highlight=False)
