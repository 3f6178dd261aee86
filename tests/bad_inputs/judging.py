"""What is wrong with an outcome, by the contract on commands and exit codes."""

from __future__ import annotations

import json
import re

from tests.bad_inputs.case import BENCH, BOUNDS, DONE, FAILED, INTERRUPTED, REFUSED, Case, Outcome

TRACEBACK, HANG, HALF_WRITTEN, WRONG_CODE, UNCLEAR, MEMORY = (
    "traceback",
    "hang",
    "half-written",
    "wrong exit code",
    "unclear",
    "memory",
)
FAULTS = (TRACEBACK, HANG, HALF_WRITTEN, WRONG_CODE, UNCLEAR, MEMORY)
#: Of a command that refuses its input, MB.
MOST_MEGABYTES = 700.0
_SPILLED = ("Traceback (most recent call last)", "internal error", "Exception ignored", "Fatal Python error")
_ALL_OR_NONE = ("identify", "design", "diagnose")  # the fewest files that each of them writes
_LEAST_FILES = 4


def faults_of(case: Case, outcome: Outcome) -> dict[str, str]:
    """Kinds of faults with words for each; empty if all is well."""
    found: dict[str, str] = {}
    if any(text in outcome.err + outcome.out for text in _SPILLED):
        found[TRACEBACK] = _telling_line(outcome.err)
    if case.kind == BOUNDS and outcome.megabytes > MOST_MEGABYTES:
        found[MEMORY] = f"{outcome.megabytes:.0f} MB, at most {MOST_MEGABYTES:.0f} are allowed"
    if outcome.code is None:
        found[HANG] = "ended after the time limit"
        return found
    if outcome.code not in case.allowed and not _died_before_the_start(case, outcome):
        allowed = ", ".join(map(str, case.allowed))
        found[WRONG_CODE] = f"exit {outcome.code}, allowed: {allowed}"
    half = _half_written(case, outcome)
    if half:
        found[HALF_WRITTEN] = half
    unclear = _unclear(case, outcome)
    if unclear and TRACEBACK not in found:
        found[UNCLEAR] = unclear
    return found


def message_of(outcome: Outcome) -> str:
    """The first two lines of the message, without what differs from run to run."""
    lines = [line.strip() for line in outcome.err.strip().splitlines()]
    start = next((i for i, line in enumerate(lines) if line.startswith(("error:", "Error"))), 0)
    text = " / ".join(lines[start : start + 2])
    text = re.sub(r"(?<![\w.])(/[^\s/':,]+)+/", "", text)  # paths become names
    text = re.sub(r"\d+(\.\d+)? ?m?s\b", "… s", text)
    return text if len(text) <= 230 else text[:229] + "…"


def _died_before_the_start(case: Case, outcome: Outcome) -> bool:
    """A signal that came before the interpreter had reached the program ends it as the system does."""
    early = case.interruption is not None and 0 < case.interruption.after_s <= 0.1
    return early and outcome.code is not None and outcome.code < 0 and not outcome.err and not outcome.new


def _half_written(case: Case, outcome: Outcome) -> str:
    hidden = [name for name in outcome.new if name.rpartition("/")[2].startswith(".")]
    if hidden:
        return f"left over: {', '.join(hidden)}"
    if outcome.changed and not _renews(case):
        return f"changed: {', '.join(outcome.changed)}"
    if outcome.broken:
        return f"not whole: {', '.join(outcome.broken)}"
    if outcome.code == REFUSED and outcome.new:
        return f"refused, but left: {', '.join(outcome.new[:4])}"
    stopped = outcome.code in (BENCH, INTERRUPTED) and case.command in _ALL_OR_NONE
    if stopped and 0 < sum("." in name for name in outcome.new) < _LEAST_FILES:
        return f"some of the results only: {', '.join(outcome.new)}"
    return ""


def _renews(case: Case) -> bool:
    """Whether the case asks for results to be replaced."""
    return case.command == "report" or "--overwrite" in case.arguments


def _unclear(case: Case, outcome: Outcome) -> str:
    if outcome.code in (REFUSED, BENCH, INTERRUPTED) and not case.silent:
        if not outcome.err.strip():
            return "no message"
        escapes = [c for c in outcome.err if not c.isprintable() and c != "\n"]
        if escapes and not case.environment:
            return f"control characters in the message: {escapes[0]!r}"
        if sum(line.startswith("error:") for line in outcome.err.splitlines()) > 1:
            return "more than one message"
    if case.as_json and not case.deaf and outcome.code is not None:
        return _not_json(outcome)
    return ""


def _not_json(outcome: Outcome) -> str:
    if not outcome.out and outcome.code not in (DONE, FAILED):
        return ""
    try:
        value = json.loads(outcome.out)
    except ValueError:
        return "standard output is not one JSON object"
    return "" if isinstance(value, dict) else "standard output is JSON, but no object"


def _telling_line(text: str) -> str:
    """The line that says what went wrong: the program's own message, else a traceback's last line."""
    lines = text.strip().splitlines()
    told = [line for line in lines if "internal error" in line]
    return [*told, *lines[-1:], ""][0][:300]
