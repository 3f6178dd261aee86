"""Ctrl-C, a termination, a closed terminal and a quit, at every moment of a command."""

from __future__ import annotations

from collections.abc import Iterator

from tests.bad_inputs.case import FINISHED, INTERRUPTED, SIGNALS, Case, Interruption
from tests.bad_inputs.commands import usual

_NAMES = ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT")
_MOMENTS_S = (0.1, 0.3, 0.6, 1.0, 2.0, 4.0)
_COMMANDS = ("run", "diagnose", "identify", "design", "check", "report", "export")
_APPEARING = ("out/recording.mcap", "out/report.html", "out/result.json")
_WORDS = {"SIGINT": "Ctrl-C", "SIGTERM": "a termination", "SIGHUP": "a closed terminal", "SIGQUIT": "SIGQUIT"}


def signal_cases() -> Iterator[Case]:
    """One signal at each moment, in turn; two of them; and while a run writes its files."""
    for row, command in enumerate(_COMMANDS):
        for column, moment_s in enumerate(_MOMENTS_S):
            name = _NAMES[(row + column) % len(_NAMES)]
            yield _case(command, f"{_WORDS[name]} after {moment_s:g} s", Interruption((name,), moment_s))
        for moment_s, name in ((0.8, "SIGINT"), (1.5, "SIGTERM")):
            tried = f"{_WORDS[name]} twice after {moment_s:g} s"
            yield _case(command, tried, Interruption((name, name), moment_s))
    for path in _APPEARING:
        for name in _NAMES:
            tried = f"{_WORDS[name]} when {path.removeprefix('out/')} appears"
            yield _case("run", tried, Interruption((name,), when_there=path))


def _case(command: str, tried: str, what: Interruption) -> Case:
    allowed = (INTERRUPTED, *FINISHED)
    return Case(command, SIGNALS, tried, usual(command), allowed, interruption=what)
