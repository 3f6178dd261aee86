"""docs/reference/bad-inputs.md, from the outcomes."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from tests.bad_inputs.case import BOUNDS, FILES, OPTIONS, PLACES, SIGNALS, STREAMS, VALUES, Case, Outcome
from tests.bad_inputs.commands import COMMANDS
from tests.bad_inputs.judging import FAULTS, faults_of, message_of

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "bad-inputs.md"
_ORDER = ("hil", *COMMANDS)
_KINDS = {
    FILES: "files that are missing, of another kind or broken",
    BOUNDS: "files without end, too large, too deep or with too many mistakes",
    VALUES: "values out of range",
    OPTIONS: "options unknown, missing or contradictory",
    PLACES: "places that cannot be written",
    SIGNALS: "interruptions",
    STREAMS: "streams and terminals",
}
_INTRODUCTION = """\
# Bad inputs

Made by `python -m tests.bad_inputs --write`: each case is a process in a folder of its own with a copy of the
inputs; afterwards the folder is compared with what it was. Exit codes are those of
[commands](commands.md); a case states which of them are right. Cases with the same message stand in one row;
paths are shortened to names.
"""

BOUNDS_PAGE = PAGE.with_name("bounds.md")
_BOUNDS_INTRODUCTION = """\
# Bounds of inputs

Made by `python -m tests.bad_inputs --write`: every argument that names a file, given one that must not be
read whole. Each command has 4 GB of addresses (`ulimit -v`), 60 s, and 700 MB of memory that it may use;
`hil --version` alone needs some 160 MB. Each refuses the file in a message with its name; seconds are of a
machine with two busy processors. A process begins as a copy of the program that tries it, so that 281 MB are
the least that can be read here.

What is read at most: 500 kB of a plan, a campaign or a sequence (YAML), 5 MB of a bench, model or
controller file (TOML, keys of up to 32 parts), 20 MB of a DBC or EDS, 200 MB of an A2L, 64 MB of a result
or list (JSON); of a table (CSV, Parquet, MDF4, MAT) 10,000 columns and 250 million values, 2 GB as numbers.
MCAP is read piece by piece.

| command | file | exit code | s | MB |
|---|---|---|---|---|
"""

_ROUTES = "\n\n## Routes of the API\n"
_ROUTES_INTRODUCTION = f"""{_ROUTES}
Every route that takes a body, on one service with a simulated bench: 3 MB, 100,000 lists in each other
(of TOML a key of as many parts), a text of 200,000 characters, 20,000 keys. Given are the status of each
answer, how long the slowest took, and by how much the memory of the service and of the process that reads
for it grew. That process starts with the first file.

"""

_REQUESTS = "\n## Requests to the service\n"
_VALUES_INTRODUCTION = f"""{_REQUESTS}
On one service with a simulated bench, to the routes of what people share, give and sign in with: values that
must not be taken (`--requests` makes this part alone). Each is refused with a status of the asker's (400 to
499) and with words; moments are shortened. Bodies too large, too deep or too long are in
[bounds of inputs](bounds.md).

"""

Tried = tuple[Case, Outcome]


def bounds_page_of(tried: Sequence[Tried], routes: str) -> str:
    """The page of what each bounded input costs; `routes` is the table of the API's."""
    rows = [
        f"| `{case.command}` | {case.tried} | {outcome.code} "
        f"| {outcome.seconds:.1f} | {outcome.megabytes:.0f} |"
        for case, outcome in tried
        if case.kind == BOUNDS
    ]
    return with_routes(_BOUNDS_INTRODUCTION + "\n".join(rows), routes)


def with_routes(page: str, routes: str) -> str:
    """The page of bounds with its last part, routes of the API, made anew."""
    return page.partition(_ROUTES)[0].rstrip("\n") + _ROUTES_INTRODUCTION + routes


def page_of(tried: Sequence[Tried], routes: str = "") -> str:
    """The whole page; `routes` is the table of requests to the service's API."""
    parts = [_INTRODUCTION, _counts(tried)]
    for command in _ORDER:
        own = [(case, outcome) for case, outcome in tried if case.command == command]
        if own:
            title = "hil" if command == "hil" else f"hil {command}"
            parts.append(f"## {title}\n\n| tried | exit code | message |\n|---|---|---|\n" + _rows(own))
    return with_requests("\n".join(parts), routes) if routes else "\n".join(parts)


def with_requests(page: str, routes: str) -> str:
    """The page with its last part, requests to the service, made anew."""
    return page.partition(_REQUESTS)[0] + _VALUES_INTRODUCTION + routes


def failures_of(tried: Sequence[Tried]) -> list[str]:
    """Each fault on a line: case, what came, what the contract says."""
    lines = []
    for case, outcome in tried:
        for kind, words in faults_of(case, outcome).items():
            lines.append(f"{case.command}: {case.tried}: {kind}: {words}")
    return lines


def _counts(tried: Sequence[Tried]) -> str:
    found = [faults_of(case, outcome) for case, outcome in tried]
    head = "| | tried | " + " | ".join(FAULTS) + " |\n|---|" + "---|" * (1 + len(FAULTS)) + "\n"
    rows = []
    for kind, words in _KINDS.items():
        own = [faults for (case, _), faults in zip(tried, found, strict=True) if case.kind == kind]
        numbers = " | ".join(str(sum(fault in faults for faults in own)) for fault in FAULTS)
        rows.append(f"| {words} | {len(own)} | {numbers} |\n")
    numbers = " | ".join(f"**{sum(fault in faults for faults in found)}**" for fault in FAULTS)
    rows.append(f"| all | **{len(tried)}** | {numbers} |\n")
    return head + "".join(rows)


def _rows(tried: Sequence[Tried]) -> str:
    merged: dict[tuple[str, str, str], list[str]] = {}
    for case, outcome in tried:
        message = message_of(outcome) if not (case.silent or outcome.code in (0, 1)) else ""
        code = "none" if outcome.code is None else str(outcome.code)
        faults = "; ".join(f"**{kind}**: {words}" for kind, words in faults_of(case, outcome).items())
        merged.setdefault((code, message, faults), []).append(case.tried)
    rows = []
    for (code, message, faults), cases in merged.items():
        said = "; ".join(part for part in (faults, message) if part)
        rows.append(f"| {_cell('; '.join(dict.fromkeys(cases)))} | {code} | {_cell(said)} |\n")
    return "".join(rows)


def _cell(text: str) -> str:
    shown = "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)
    return shown.replace("|", "\\|").replace("<", "&lt;")
