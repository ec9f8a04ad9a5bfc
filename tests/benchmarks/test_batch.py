"""How the benchmark of batch learning reads its own measurements."""

import pytest

from benchmarks.batch.tables import Row, equal_errors, samples_needed, sentence, tables
from benchmarks.shared.document import write_between


def row(learner, symmetries, samples, error, noise=0.0):
    return Row(
        "2r",
        learner,
        symmetries,
        samples,
        noise,
        [error, error],
        {"66": error},
        error / 25.0,
        0.1,
        8.0,
        None,
        None,
    )


ROWS = [
    row("network", "exact", 4, 1.0),
    row("network", "exact", 16, 1e-4),
    row("network", "none", 32, 1.0),
    row("network", "none", 128, 1e-4),
]


def test_curves_are_interpolated_on_logarithmic_scales():
    assert samples_needed({10: 1.0, 1000: 1e-2}, 0.1) == pytest.approx(100.0)
    assert samples_needed({10: 1.0, 20: 0.01, 40: 0.2}, 0.1) is None  # it does not stay below
    assert samples_needed({10: 0.05}, 0.1) == 10.0


def test_the_factor_is_that_of_the_curves():
    found = {item["error"]: item["ratio"] for item in equal_errors(ROWS)}
    assert found[0.01] == pytest.approx([8.0, 8.0])
    assert "8.0 to 8.0 times the samples on 2r, whose group has order 8" in sentence(ROWS)


def test_what_contains_the_truth_makes_no_factor():
    assert sentence(
        [row("parametric", s, n, 1e-14) for s in ("exact", "none") for n in (2, 4)]
    ) == ("No entry resolves the factor.")


def test_every_noise_has_its_tables():
    text = tables([*ROWS, row("network", "exact", 16, 0.1, 0.5)])
    assert text.count("### Equal samples") == 2
    assert "angles off by 0.5 degrees" in text
    assert "| 2r | network | 16 |  |  | 128 |" in text  # samples for 1 % of the largest torque


def test_tables_go_between_markers(tmp_path):
    page = tmp_path / "page.md"
    page.write_text("a\n<!-- t -->\nold\n<!-- end of t -->\nb\n")
    for _ in range(2):
        write_between(page, "t", "new")
    assert page.read_text() == "a\n<!-- t -->\n\nnew\n\n<!-- end of t -->\nb\n"
    with pytest.raises(ValueError, match="markers"):
        write_between(page, "other", "new")
