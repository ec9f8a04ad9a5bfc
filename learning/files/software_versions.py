"""Versions of the software that made a result."""

from __future__ import annotations

import platform
from importlib import metadata

from isotorque.symbolic.common.version import VERSION


def software_versions() -> dict[str, str]:
    """Versions that decide the digits of a result; ``"absent"`` for what is not installed."""
    versions = {"python": platform.python_version()}
    for name in ("numpy", "pin", "numba"):
        try:
            versions[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            versions[name] = "absent"
    return {**versions, "isotorque": VERSION}
