"""The folder where Matplotlib keeps its list of fonts, which takes seconds to make."""

from __future__ import annotations

import logging
import os
import sys
from pathlib import Path

from isotorque.symbolic.common.cache_folders import can_write, user_cache


def give_matplotlib_a_folder() -> None:
    """Name a folder to Matplotlib where its own cannot be written; it would warn each time.

    Notes
    -----
    ``$MPLCONFIGDIR`` is respected where it can be written. Matplotlib also says so when it makes
    its list of fonts; nobody who asked for a report needs to know.
    """
    logging.getLogger("matplotlib.font_manager").setLevel(logging.ERROR)
    given = os.environ.get("MPLCONFIGDIR")
    if all(can_write(folder) for folder in ([Path(given).absolute()] if given else _own_folders())):
        return
    ours = user_cache()
    if ours is not None and can_write(ours / "matplotlib"):
        os.environ["MPLCONFIGDIR"] = str(ours / "matplotlib")


def _own_folders() -> list[Path]:
    """Return the folders that Matplotlib takes by itself, for settings and for what it computes."""
    if not sys.platform.startswith(("linux", "freebsd")):
        return [Path(os.path.expanduser("~/.matplotlib"))]
    places = (("XDG_CONFIG_HOME", "~/.config"), ("XDG_CACHE_HOME", "~/.cache"))
    return [
        Path(os.path.expanduser(os.environ.get(name) or default)) / "matplotlib"
        for name, default in places
    ]
