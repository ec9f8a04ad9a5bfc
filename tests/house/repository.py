"""The files of the repository, as they are found from its root."""

from pathlib import Path

ROOT = Path(__file__).parents[2]
PACKAGES = ("symbolic", "learning", "verify", "isotorque")
FOLDERS = (*PACKAGES, "tests", "benchmarks", "contracts", "docs", "examples")
PAGES = ("README.md", "CONTRIBUTING.md", "Makefile", "pyproject.toml", ".ci/run", "conftest.py")


def files(*endings: str) -> list[Path]:
    """Source files and pages with one of the endings, relative to the root; links left out."""
    found = [Path(name) for name in PAGES if (ROOT / name).is_file()]
    for folder in FOLDERS:
        for path in sorted((ROOT / folder).rglob("*")):
            place = path.relative_to(ROOT)
            linked = any((ROOT / above).is_symlink() for above in place.parents)
            if path.is_file() and not linked and "__pycache__" not in place.parts:
                found.append(place)
    return [path for path in found if not endings or path.suffix in endings]
