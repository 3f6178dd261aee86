"""The paper's figures are found again, and the page in docs says what was found."""

from __future__ import annotations

import re

import pytest

from hil.analysis.control_design import Design, DesignSpec, design
from hil.analysis.identification import Identification
from tests.hil.analysis import paper_table
from tests.hil.analysis.paper_table import Results, Row


@pytest.fixture(scope="module")
def all_(paper_identification: Identification, paper_design: Design, optimised_design: Design) -> Results:
    identified = design(paper_identification.model, DesignSpec())
    return Results(paper_identification, identified, paper_design, optimised_design)


def check(rows: list[Row]) -> None:
    missed = [row for row in rows if not row.kept]
    assert not missed, [row.cells() for row in missed]


def test_responses_within_half_a_percent_and_dead_time_within_a_tenth_of_a_millisecond(all_: Results) -> None:
    check(list(paper_table.response_rows(all_.identification)))


def test_poles_within_half_a_percent(all_: Results) -> None:
    check(list(paper_table.pole_rows(all_.identification)))


def test_coefficients_within_their_uncertainty(all_: Results) -> None:
    rows = list(paper_table.coefficient_rows(all_.identification))
    assert len(rows) == 4 + 5 + 4 + 4
    assert all(abs(row.difference) < 0.01 for row in rows)


def test_chain(all_: Results) -> None:
    del all_
    check(list(paper_table.chain_rows()))


def test_design(all_: Results) -> None:
    check(list(paper_table.design_rows(all_)))


def test_optimum_beats_the_paper(all_: Results) -> None:
    best, paper = all_.optimised.loop("phase").margins, all_.as_printed.loop("phase").margins
    assert best.comfort_peak < 0.85 * paper.comfort_peak


_NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


def test_page_is_up_to_date(all_: Results) -> None:
    """Numbers may differ in the last digits from machine to machine, words may not."""
    written = paper_table.PATH.read_text(encoding="utf-8")
    computed = paper_table.document(all_)
    fix = "run python -m tests.hil.analysis.paper_table"
    assert _NUMBER.sub("#", written) == _NUMBER.sub("#", computed), fix
    pairs = zip(_NUMBER.findall(written), _NUMBER.findall(computed), strict=True)
    for old, new in pairs:
        assert float(old) == pytest.approx(float(new), rel=0.03, abs=0.06), fix
