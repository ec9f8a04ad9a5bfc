"""The one exception for input that cannot be used."""

from __future__ import annotations

from typing import Any


class InputError(ValueError):
    """Input that cannot be used, said in one line.

    Parameters
    ----------
    where
        The file, command or argument the input came from.
    field
        The field within it.
    value
        What was found there.
    accepted
        What would be accepted instead.

    Notes
    -----
    The command line prints the message after ``error: `` and ends with exit status 2. Characters
    that a terminal does not show are escaped (`visible`), so the message is one line whatever a
    file holds. Errors come back from other processes as they were raised.

    Examples
    --------
    >>> print(InputError("arm.urdf", "mass of link 'hand'", -1.0, "a number >= 0 [kg]"))
    arm.urdf: mass of link 'hand' is -1.0; accepted: a number >= 0 [kg]
    """

    def __init__(self, where: object, field: str, value: object, accepted: str) -> None:
        self.where = str(where)
        self.field = field
        self.value = value
        self.accepted = accepted
        shown = " ".join(str(value).split())
        if len(shown) > 120:
            shown = shown[:117] + "..."
        super().__init__(visible(f"{self.where}: {field} is {shown}; accepted: {accepted}"))

    def __reduce__(self) -> tuple[Any, ...]:
        # exceptions are pickled as a call with their message, which is not what classes here take
        return _restored, (type(self), self.args, self.__dict__)


InputError.__module__ = "isotorque"  # where users find it, in tracebacks too


def _restored(kind: type[InputError], args: tuple[Any, ...], state: dict[str, Any]) -> InputError:
    error = kind.__new__(kind, *args)
    error.__dict__.update(state)
    return error


def visible(text: str) -> str:
    r"""Return a text with control, bidirectional and other unprintable characters escaped.

    Parameters
    ----------
    text
        Any text, such as the name of a joint or of a file.

    Returns
    -------
    str
        One line that a terminal shows from left to right as it is.

    Examples
    --------
    >>> print(visible("a\nb"), visible("élbow"))
    a\nb élbow
    """
    if text.isprintable():
        return text
    return "".join(
        c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text
    )
