"""Folders for what can be computed again: compiled functions, lists of fonts."""

from __future__ import annotations

import os
import stat
import tempfile
from functools import cache
from pathlib import Path


@cache
def can_write(folder: Path) -> bool:
    """Say whether files can be made in a folder, which is made if need be; never in a relative one.

    What is left of ``~/.cache`` for a user without a home is such a path.
    """
    if not folder.is_absolute():
        return False
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError:
        return False
    return True


@cache
def user_cache() -> Path | None:
    """Return a folder of this user alone; None if there is nowhere to have one.

    Notes
    -----
    ``$XDG_CACHE_HOME`` or ``~/.cache``; for a user without a home that can be written, such as
    the random one of a container, a folder among the temporary files. Others could have made
    that one beforehand, and what is read from it is run: it is used only if it belongs to this
    user and is open to nobody else.

    Examples
    --------
    >>> folder = user_cache()
    >>> folder is None or can_write(folder)
    True
    """
    named = os.environ.get("XDG_CACHE_HOME") or "~/.cache"
    home = Path(os.path.expanduser(named)) / "isotorque"
    if can_write(home):
        return home
    user = getattr(os, "getuid", int)()
    try:
        folder = Path(tempfile.gettempdir()) / f"isotorque-{user}"
        folder.mkdir(mode=0o700, exist_ok=True)
        found = folder.lstat()
    except OSError:
        return None
    ours = stat.S_ISDIR(found.st_mode) and found.st_uid == user and not found.st_mode & 0o077
    return folder if ours and can_write(folder) else None
