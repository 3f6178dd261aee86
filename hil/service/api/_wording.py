"""Refusals of requests in plain words: each field that is wrong, by its own name, and what would be right."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

from hil.api_schemas.api import Problem
from hil.core.errors.mistakes import dotted, needed
from hil.core.errors.wording import listed, printable

_PLACES = ("body", "query", "path", "header", "cookie")
#: More are counted: a hostile request may have ten thousand.
_MOST_NAMED = 20
_NAME = re.compile(r"\^\(?\[A-Za-z0-9\]\[A-Za-z0-9(?P<signs>[^\]]*)\]\{0,(?P<most>\d+)\}")
_HEXADECIMAL = re.compile(r"\^\(?\[0-9a-f\]\{(?P<count>\d+)\}")
_MOMENT = "must be a date and a time with their zone, as 2026-03-01T14:30:00+01:00"
_KINDS = {
    "missing": "is missing",
    "extra_forbidden": "is not known here",
    "datetime_parsing": _MOMENT,
    "datetime_from_date_parsing": _MOMENT,
    "datetime_type": _MOMENT,
    "timezone_aware": _MOMENT,
    "date_parsing": "must be a date, as 2026-03-01",
    "date_from_datetime_parsing": "must be a date, as 2026-03-01",
    "date_type": "must be a date, as 2026-03-01",
    "string_type": "must be a text",
    "model_attributes_type": "must be a JSON object",
}


def problem_of(errors: Sequence[Mapping[str, Any]]) -> Problem:
    """All that is wrong with a request, of pydantic's errors."""
    found = list(dict.fromkeys((_field(error), _what(error)) for error in errors[:_MOST_NAMED]))
    left = len(errors) - _MOST_NAMED
    if len(found) == 1 and left <= 0:
        field, what = found[0]
        return Problem(what=what, where=field)
    lines = listed([f"{field} {what}" if field else what for field, what in found])
    more = f"\n  and {left} more" if left > 0 else ""
    return Problem(what=f"{len(found) + max(left, 0)} fields are wrong{lines}{more}")


def _field(error: Mapping[str, Any]) -> str:
    """The name of the field; a query or a path has it without where it stands."""
    if error["type"] == "json_invalid":
        return ""
    first, *rest = error["loc"] or ("",)
    return printable(dotted(rest if first in _PLACES else error["loc"]), 120)


def _what(error: Mapping[str, Any]) -> str:
    kind, context = str(error["type"]), error.get("ctx", {})
    if kind == "json_invalid":
        return f"the request is no JSON: {printable(context.get('error', ''), 120)}"
    if kind == "missing" and tuple(error["loc"]) == ("body",):
        return "the request has no content"
    if kind == "string_pattern_mismatch":
        return _of_pattern(str(context["pattern"]))
    what = _KINDS.get(kind) or needed(error)
    value = error.get("input")
    shown = isinstance(value, int | float) and not isinstance(value, bool) and what.startswith("must")
    number = f"{value:g}" if isinstance(value, float) else str(value)
    return printable(f"{what}, not {printable(number)}" if shown else what, 500)


def _of_pattern(pattern: str) -> str:
    """The patterns of names, checksums and texts, as people say them."""
    if found := _NAME.match(pattern):
        signs = " ".join(found["signs"].replace("\\", ""))
        most = int(found["most"]) + 1
        ending = re.search(r"\\\.\(([a-z|]+)\)", pattern)
        kinds = f", and end with .{ending[1].replace('|', ', .')}" if ending else ""
        letters = f"1 to {most} letters from A to Z, digits and {signs}"
        return f"must have {letters}, and begin with a letter or digit{kinds}"
    if found := _HEXADECIMAL.match(pattern):
        return f"must be {found['count']} hexadecimal digits, in small letters"
    if " ?=" in pattern:
        return "must be CHANNEL=COLUMN, as motor_speed_rad_s=n_EM, unit=rpm"
    if r"[^\s" in pattern:
        return "must have something in it, and no control characters"
    return "has characters that it must not have"
