"""`python -m tests.bad_inputs [--write] [--only TEXT] [--requests]`: tries all cases, two at a time."""

from __future__ import annotations

import argparse
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from tests.bad_inputs.all_cases import all_cases
from tests.bad_inputs.api_bounds import table_of, try_routes
from tests.bad_inputs.case import BOUNDS, Case
from tests.bad_inputs.inputs import make_inputs
from tests.bad_inputs.page import (
    BOUNDS_PAGE,
    PAGE,
    Tried,
    bounds_page_of,
    failures_of,
    page_of,
    with_requests,
    with_routes,
)
from tests.bad_inputs.route_cases import table_of as values_table_of
from tests.bad_inputs.route_cases import try_values
from tests.bad_inputs.trying import execute

AT_ONCE = 2


def try_all(cases: list[Case], place: Path) -> list[Tried]:
    """Carry all cases out, in folders below `place`."""
    make_inputs(place / "inputs")

    def one(numbered: tuple[int, Case]) -> Tried:
        number, case = numbered
        tried = case, execute(case, place / "inputs", place / f"case-{number}")
        for line in failures_of([tried]):
            print(line, flush=True)
        return tried

    with ThreadPoolExecutor(AT_ONCE) as pool:
        return list(pool.map(one, enumerate(cases)))


def main() -> int:
    """Try them, say what is wrong, write the page if asked to."""
    parser = argparse.ArgumentParser(prog="python -m tests.bad_inputs")
    parser.add_argument(
        "--write",
        action="store_true",
        help="write docs/reference/bad-inputs.md and bounds.md; with --only the latter alone",
    )
    parser.add_argument("--only", default="", help="cases whose command, kind or words have this text")
    parser.add_argument(
        "--requests",
        action="store_true",
        help="only requests to the service; with --write they replace their parts of both pages",
    )
    options = parser.parse_args()
    if options.requests:
        return _requests(write=options.write)
    cases = [c for c in all_cases() if options.only in f"{c.command} {c.kind} {c.tried}"]
    with tempfile.TemporaryDirectory() as directory:
        tried = try_all(cases, Path(directory))
    failures = failures_of(tried)
    values = [] if options.only else list(try_values())
    failures += [fault for one in values for fault in one.faults]
    if options.write and any(case.kind == BOUNDS for case in cases):
        routes = list(try_routes())
        failures += [fault for route in routes for fault in route.faults]
        BOUNDS_PAGE.write_text(bounds_page_of(tried, table_of(routes)), "utf-8")
    if options.write and not options.only:
        PAGE.write_text(page_of(tried, values_table_of(values)), "utf-8")
    print(f"{len(tried)} tried, {len(failures)} faults")
    return 1 if failures else 0


def _requests(*, write: bool) -> int:
    found, routes = list(try_values()), list(try_routes())
    failures = [fault for one in found for fault in one.faults]
    failures += [fault for one in routes for fault in one.faults]
    if write:
        BOUNDS_PAGE.write_text(with_routes(BOUNDS_PAGE.read_text("utf-8"), table_of(routes)), "utf-8")
        PAGE.write_text(with_requests(PAGE.read_text("utf-8"), values_table_of(found)), "utf-8")
    print("\n".join([*failures, f"{len(found) + len(routes)} tried, {len(failures)} faults"]))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
