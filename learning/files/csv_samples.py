"""Static samples of an arm as a CSV file, measured anywhere."""

from __future__ import annotations

import csv
import math
import os
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from isotorque.learning.files.static_samples import StaticSamples
from isotorque.symbolic.common.errors import InputError

LARGEST = 1e9
"""Largest angle [rad] or torque [N m] taken for a measured one; of larger angles no digit is left
behind the point that says where the joint is."""
SMALLEST_TORQUE = 1e-12
"""If no torque is larger [N m], nothing was measured: this is below the noise of any sensor."""


def read_csv(path: str | Path, joint_names: Sequence[str]) -> StaticSamples:
    r"""Read static samples.

    Parameters
    ----------
    path
        The file: text (UTF-8), comma separated, decimal points, one header line. Columns are
        ``q1,..,qn,tau1,..,taun`` or ``<joint>.q`` and ``<joint>.tau`` for every joint, in any
        order. Radians and N m; metres and N for prismatic joints. Empty lines are skipped.
    joint_names
        Names of the n joints, in the order wanted.

    Returns
    -------
    StaticSamples
        The m >= 1 samples in the order of the file, columns in the order of ``joint_names``.

    Raises
    ------
    InputError
        Naming file, line and column, for a missing, unknown or repeated column, a line of another
        length, and anything that is not a finite number.

    Examples
    --------
    >>> import tempfile
    >>> directory = tempfile.TemporaryDirectory()
    >>> path = Path(directory.name) / "arm.csv"
    >>> _ = path.write_text("elbow.q,shoulder.q,shoulder.tau,elbow.tau\n0,-1.5,0.25,-0.5\n")
    >>> samples = read_csv(path, ["shoulder", "elbow"])
    >>> samples.q, samples.tau
    (array([[-1.5,  0. ]]), array([[ 0.25, -0.5 ]]))
    >>> directory.cleanup()
    """
    n = len(joint_names)
    rows: list[list[float]] = []
    lines = _lines(Path(path))
    line, header = next(lines, (1, []))
    order = _column_order(path, line, header, joint_names)
    for line, entries in lines:
        if len(entries) != len(header):
            where = f"{path}, line {line}"
            raise InputError(where, "number of columns", len(entries), str(len(header)))
        rows.append([_number(path, line, header[k], entries[k]) for k in order])
    if not rows:
        raise InputError(path, "number of samples", 0, "at least one line below the header")
    table = np.array(rows, dtype=np.float64)
    largest = float(np.abs(table[:, n:]).max())
    if 0.0 < largest < SMALLEST_TORQUE:
        accepted = f"torques [N m] above {SMALLEST_TORQUE:g}, or zeros"
        raise InputError(path, "largest torque", f"{largest:g}", accepted)
    return StaticSamples(table[:, :n].copy(), table[:, n:].copy())


def joint_names_of(path: str | Path) -> tuple[str, ...]:
    r"""Names of the joints by the header of a file of static samples, in the order of their q.

    Parameters
    ----------
    path
        The file, see `read_csv`.

    Returns
    -------
    tuple of str
        ``q1``, ``q2``, .. where columns are numbered.

    Raises
    ------
    InputError
        If the file cannot be read, or the header does not pair angles with torques.

    Examples
    --------
    >>> import tempfile
    >>> directory = tempfile.TemporaryDirectory()
    >>> path = Path(directory.name) / "arm.csv"
    >>> _ = path.write_text("elbow.q,shoulder.q,shoulder.tau,elbow.tau\n0,-1.5,0.25,-0.5\n")
    >>> joint_names_of(path)
    ('elbow', 'shoulder')
    >>> directory.cleanup()
    """
    line, header = next(_lines(Path(path)), (1, []))
    names = tuple(column.removesuffix(".q") for column in header if column.endswith(".q"))
    if not names:
        n = sum(column == f"q{k + 1}" for k, column in enumerate(_numbered(header)))
        names = tuple(f"q{k}" for k in range(1, n + 1))
    if not names or any(not name for name in names):
        found = repr(",".join(header))
        accepted = "q1,..,qn,tau1,..,taun or <joint>.q,..,<joint>.tau,.."
        raise InputError(f"{path}, line {line}", "header", found, accepted)
    _column_order(path, line, list(header), names)
    return names


def _numbered(header: list[str]) -> list[str]:
    """Columns q1, q2, .. of a header, by number."""
    numbers = (column[1:] for column in header if column[:1] == "q")
    return [f"q{k}" for k in sorted(int(x) for x in numbers if x.isdecimal())]


def write_csv(path: str | Path, samples: StaticSamples, joint_names: Sequence[str]) -> None:
    """Write static samples, every number with all its digits.

    Parameters
    ----------
    path
        The file; it is replaced in one step when all is written.
    samples
        m samples of n joints.
    joint_names
        Names of the n joints; they head the columns as ``<joint>.q`` and ``<joint>.tau``.

    Raises
    ------
    InputError
        If the shapes do not fit, a number is not finite, or the file cannot be written.
    """
    path = Path(path)
    n = len(joint_names)
    for name, array in (("q", samples.q), ("tau", samples.tau)):
        if array.ndim != 2 or array.shape != (len(samples.q), n):
            raise InputError("samples", f"shape of {name}", array.shape, f"(m, {n})")
        if not np.all(np.isfinite(array)):
            raise InputError("samples", name, "not finite", "finite numbers")
    fresh = path.with_name(f".{path.name}.new")
    try:
        with fresh.open("w", newline="", encoding="utf-8") as stream:
            writer = csv.writer(stream, lineterminator="\n")
            writer.writerow(_named_columns(joint_names))
            writer.writerows(np.hstack([samples.q, samples.tau]).tolist())
        os.replace(fresh, path)
    except OSError as error:
        fresh.unlink(missing_ok=True)
        found = f"not writable ({error.strerror})"
        raise InputError(
            path, "file", found, "a place with free space this user may write"
        ) from error


def _named_columns(joint_names: Sequence[str]) -> list[str]:
    return [f"{joint}.{what}" for what in ("q", "tau") for joint in joint_names]


def _lines(path: Path) -> Iterator[tuple[int, list[str]]]:
    """Yield (line number, stripped entries) of all lines that are not empty."""
    try:
        # "utf-8-sig" also takes the byte order mark that spreadsheets write.
        with path.open(newline="", encoding="utf-8-sig") as stream:
            reader = csv.reader(stream, strict=True)
            for entries in reader:
                if any(entry.strip() for entry in entries):
                    yield reader.line_num, [entry.strip() for entry in entries]
    except OSError as error:
        raise InputError(path, "file", f"not readable ({error.strerror})", "a CSV file") from error
    except UnicodeDecodeError as error:
        raise InputError(path, "text", f"not UTF-8 ({error.reason})", "UTF-8 text") from error
    except csv.Error as error:
        where = f"{path}, line {reader.line_num}"
        raise InputError(where, "text", f"not CSV ({error})", "comma separated values") from error


def _column_order(
    path: str | Path, line: int, header: list[str], joint_names: Sequence[str]
) -> list[int]:
    """Places in a line of q of all joints, then tau of all joints."""
    n = len(joint_names)
    numbered = [f"{what}{k}" for what in ("q", "tau") for k in range(1, n + 1)]
    named = _named_columns(joint_names)
    where = f"{path}, line {line}"
    for wanted in (numbered, named):
        if sorted(header) == sorted(wanted):
            return [header.index(column) for column in wanted]
    accepted = f"{','.join(numbered)} or {','.join(named)}"
    # Speak about the style that was meant, which is the one that more columns are of.
    meant = max(numbered, named, key=lambda columns: len(set(columns) & set(header)))
    repeated = sorted({column for column in header if header.count(column) > 1})
    unknown = [column for column in header if column not in meant]
    missing = [column for column in meant if column not in header]
    if len(unknown) == len(header):
        raise InputError(where, "header", repr(",".join(header)), accepted)
    for what, columns in (("unknown", unknown), ("repeated", repeated), ("missing", missing)):
        if columns:
            raise InputError(where, f"{what} column", repr(columns[0]), accepted)
    raise AssertionError("a header of the wanted columns is taken above")


def _number(path: str | Path, line: int, column: str, entry: str) -> float:
    """Read a finite decimal number (not all that Python takes for one: no ``1_0``)."""
    try:
        value = float(entry) if entry.isascii() and "_" not in entry else math.nan
    except ValueError:
        value = math.nan
    if not abs(value) <= LARGEST:
        where = f"{path}, line {line}"
        accepted = f"a finite number of at most {LARGEST:g}"
        raise InputError(where, f"column {column!r}", repr(entry), accepted)
    return value
