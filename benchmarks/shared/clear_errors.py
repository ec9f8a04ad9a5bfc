"""Bad input of a benchmark ends it with one clear line and status 2, as it does every command."""

from __future__ import annotations

import functools
import sys
from collections.abc import Callable

from isotorque.symbolic.common.errors import InputError


def clear_errors(main: Callable[[], int]) -> Callable[[], int]:
    """Say in one line on stderr what was refused, and return 2, instead of a traceback.

    Examples
    --------
    >>> @clear_errors
    ... def main():
    ...     raise InputError("command line", "robots", "no-such-arm", "2r or 3r")
    >>> main()
    2
    """

    @functools.wraps(main)
    def guarded() -> int:
        try:
            return main()
        except InputError as error:
            print(f"error: {error}", file=sys.stderr)
            return 2

    return guarded
