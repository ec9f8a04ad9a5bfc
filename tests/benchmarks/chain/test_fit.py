"""Rows of the rigid chain: some may be measured anew, the others stay."""

import pytest

from benchmarks.chain.fit import COMMAND, HEAD, PAGE, Row, lines, main, measured, table, with_rows
from isotorque.symbolic.common.errors import InputError

ROWS = [Row("a", "1", "2", True), Row("b", "3"), Row("c", "4", "3", False)]


def page(rows):
    return f"before\n<!-- {COMMAND} -->\n\n{table(rows)}\n\n<!-- end of {COMMAND} -->\nafter"


def test_rows_of_the_same_name_are_replaced_others_stay_and_new_ones_come_last():
    new = [Row("b", "5", "5", True), Row("d", "6")]
    expected = [ROWS[0], new[0], ROWS[2], new[1]]
    assert with_rows(page(ROWS), new) == table(expected)
    assert with_rows(page([]), ROWS).splitlines() == [*HEAD, *lines(ROWS)]


def test_the_page_keeps_all_its_rows():
    text = PAGE.read_text(encoding="utf-8")
    kept = with_rows(text, [])
    assert kept in text
    assert len(kept.splitlines()) > 20


def test_a_function_that_is_none_is_refused_with_those_there_are(monkeypatch):
    monkeypatch.setattr("sys.argv", ["benchmarks.chain", "--only", "nothing"])
    with pytest.raises(InputError) as refused:
        main()
    for step in measured(1, 1):
        assert step.func.__name__ in str(refused.value)
