"""Mistakes of a file by line, of what reading it was refused with."""

from __future__ import annotations

import re

from hil.api_schemas.plan_check import PlanMistake
from hil.core.errors import BadInputError

_SEVERAL = re.compile(r"\d+ mistakes\n")
_PLACE = re.compile(r"(?:.*(?:: |, ))?line (?P<line>\d+)(?:, key '(?P<key>[^']*)')?")
_ON_A_LINE = re.compile(rf"{_PLACE.pattern}: (?P<text>.*)", re.DOTALL)


def mistakes_of(error: BadInputError) -> list[PlanMistake]:
    """Each with its line, where it has one."""
    if _SEVERAL.match(error.what):
        lines = error.what.split("\n  ")[1:]
        return [_mistake(_ON_A_LINE.fullmatch(one), one) for one in lines]
    text = f"{error.what}; {error.fix}" if error.fix else error.what
    return [_mistake(_PLACE.match(error.where), text)]


def _mistake(found: re.Match[str] | None, text: str) -> PlanMistake:
    if found is None:
        return PlanMistake(line=None, key="", text=text)
    groups = found.groupdict()
    return PlanMistake(line=int(groups["line"]), key=groups.get("key") or "", text=groups.get("text") or text)
