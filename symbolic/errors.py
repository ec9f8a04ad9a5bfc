"""The one exception for input that cannot be used."""

from __future__ import annotations


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
    The command line prints the message after ``error: `` and ends with exit status 2.

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
        super().__init__(f"{self.where}: {field} is {shown}; accepted: {accepted}")
