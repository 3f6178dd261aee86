"""Every case there is, and the few that a quick look takes."""

from __future__ import annotations

from itertools import chain

from tests.bad_inputs.bound_cases import bound_cases
from tests.bad_inputs.case import Case
from tests.bad_inputs.file_cases import file_cases
from tests.bad_inputs.option_cases import option_cases
from tests.bad_inputs.place_cases import place_cases
from tests.bad_inputs.signal_cases import signal_cases
from tests.bad_inputs.stream_cases import stream_cases
from tests.bad_inputs.value_cases import value_cases

_QUICK_COMMANDS = ("hil", "schema", "export")
_QUICK = 10


def all_cases() -> list[Case]:
    """All cases, in the order of the page."""
    return list(
        chain(
            file_cases(),
            bound_cases(),
            value_cases(),
            option_cases(),
            place_cases(),
            signal_cases(),
            stream_cases(),
        )
    )


def quick_cases() -> list[Case]:
    """Some of each kind, of the commands that start quickest."""
    fast = [c for c in all_cases() if c.command in _QUICK_COMMANDS and c.interruption is None]
    step = max(1, len(fast) // _QUICK)
    return fast[::step][:_QUICK]
