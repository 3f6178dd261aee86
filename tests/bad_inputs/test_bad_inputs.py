"""No bad input gives a traceback, hangs, leaves half-written files or a wrong exit code."""

import pytest

from test_plans import library_plans
from tests.bad_inputs.__main__ import AT_ONCE, try_all
from tests.bad_inputs.all_cases import all_cases, quick_cases
from tests.bad_inputs.api_bounds import try_routes
from tests.bad_inputs.bound_cases import bound_cases
from tests.bad_inputs.case import FILES, REFUSED, SIGNALS, Case, Outcome
from tests.bad_inputs.judging import HALF_WRITTEN, HANG, TRACEBACK, UNCLEAR, WRONG_CODE, faults_of
from tests.bad_inputs.page import PAGE, failures_of, page_of
from tests.bad_inputs.route_cases import try_values

CASE = Case("export", FILES, "a case", ("--json",), (REFUSED,))
GOOD = Outcome(2, "", "error: x: is missing\n  give another\n", (), (), ())


def outcome(**changes):
    return Outcome(**(GOOD.__dict__ | changes))


@pytest.mark.parametrize(
    ("changes", "fault"),
    [
        ({"err": "Traceback (most recent call last)\n"}, TRACEBACK),
        ({"code": None}, HANG),
        ({"new": ("out.csv",)}, HALF_WRITTEN),
        ({"new": (".out.x.csv",), "code": 0}, HALF_WRITTEN),
        ({"changed": ("short.csv",)}, HALF_WRITTEN),
        ({"code": 3}, WRONG_CODE),
        ({"err": ""}, UNCLEAR),
        ({"err": "error: \x1b[31m"}, UNCLEAR),
        ({"out": "{} and more"}, UNCLEAR),
    ],
)
def test_what_is_wrong_with_an_outcome_is_seen(changes, fault):
    assert faults_of(CASE, GOOD) == {}
    assert fault in faults_of(CASE, outcome(**changes))


def test_the_page_merges_what_says_the_same():
    page = page_of([(CASE, GOOD), (Case("export", FILES, "another", (), (REFUSED,)), GOOD)])
    assert "| a case; another | 2 | error: x: is missing / give another |" in page


def test_the_page_knows_the_plans_that_there_are():
    """A page that was made before the newest plan lists fewer."""
    shipped = ", ".join(library_plans())
    rows = [row for row in PAGE.read_text("utf-8").splitlines() if "a built-in plan" in row]
    assert rows
    for row in rows:
        listed = row.rpartition("known: ")[2].partition("…")[0].partition(";")[0].rstrip("| ")
        assert len(listed) > 20
        assert shipped.startswith(listed)


@pytest.mark.slow
def test_the_quickest_commands_stand_bad_input(tmp_path):
    assert failures_of(try_all(quick_cases(), tmp_path)) == []


@pytest.mark.slow
def test_a_sixteenth_of_all_cases_stands_bad_input(tmp_path):
    """All of them, and the signals, are `make bad-inputs`; a run's signals are in tests/hil/cli too."""
    assert AT_ONCE == 2
    cases = [case for case in all_cases() if case.kind != SIGNALS][::16]
    assert len({case.command for case in cases}) >= 9
    assert failures_of(try_all(cases, tmp_path)) == []


@pytest.mark.slow
def test_every_route_refuses_what_is_too_large_too_deep_too_long_or_too_many():
    routes = list(try_routes())
    assert len(routes) >= 20
    assert [fault for route in routes for fault in route.faults] == []


@pytest.mark.slow
def test_values_that_a_route_must_not_take_are_refused_in_words():
    found = list(try_values())
    assert len(found) >= 50
    assert [fault for one in found for fault in one.faults] == []


@pytest.mark.slow
def test_files_without_end_are_refused_in_little_memory(tmp_path):
    """A device in the place of each file; all shapes of them are `make bad-inputs`."""
    cases = [case for case in bound_cases() if case.tried.endswith("is a device")]
    assert len(cases) >= 30
    assert failures_of(try_all(cases, tmp_path)) == []
