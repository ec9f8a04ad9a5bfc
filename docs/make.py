"""Make the pictures of the documentation anew: ``python -m docs.make`` (about a minute)."""

from __future__ import annotations

import tempfile
from pathlib import Path

from isotorque.runs.experiment import run_experiment
from isotorque.runs.judgement import judge_run
from isotorque.runs.options.run_options import RunOptions
from isotorque.verify.report.figures.style import to_svg
from isotorque.verify.report.run_figures import report_pictures

PICTURES = Path(__file__).parent / "pictures"
KEPT = ("fig2a-configurations", "fig2b-level-sets", "fig6-bcts", "fig13-learning-curve")


def main() -> None:
    """Run the 2R scheme and keep the pictures of its report."""
    PICTURES.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as out:
        run = run_experiment(RunOptions("2r"), Path(out), lambda stage, done, total, note: None)
    for picture in report_pictures(judge_run(run)):
        if picture.name not in KEPT:
            continue
        path = PICTURES / f"2r-{picture.name}.svg"
        path.write_text(to_svg(picture.figure, picture.caption, prefix=picture.name))
        print(path.name, "-", picture.caption)


if __name__ == "__main__":
    main()
