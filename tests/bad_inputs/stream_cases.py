"""Standard streams that are closed, full or cut short, and terminals of other kinds."""

from __future__ import annotations

from collections.abc import Iterator

from tests.bad_inputs.case import BENCH, FINISHED, REFUSED, STREAMS, Case
from tests.bad_inputs.commands import COMMANDS, usual

_PIPE = '"$@" | head -n 1 >/dev/null; exit ${PIPESTATUS[0]}'
_STREAMS = (
    ("standard output closed", 'exec "$@" >&-'),
    ("standard error closed", 'exec "$@" 2>&-'),
    ("standard input closed", 'exec "$@" <&-'),
    ("all of them closed", 'exec "$@" <&- >&- 2>&-'),
    ("standard output on /dev/full", 'exec "$@" >/dev/full'),
    ("standard error on /dev/full", 'exec "$@" 2>/dev/full'),
    ("a reader that goes after a line", _PIPE),
)
# Commands that take seconds: what can differ between them.
_LESS_WITH_JSON = ("standard output on /dev/full",)
_LESS = (
    *_LESS_WITH_JSON,
    "all of them closed",
    "standard error on /dev/full",
    "a reader that goes after a line",
)
_ENVIRONMENTS = (
    {"PYTHONIOENCODING": "ascii"},
    {"LC_ALL": "C"},
    {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
    {"COLUMNS": "20"},
    {"TERM": "dumb", "NO_COLOR": "1"},
)
_QUICK = ("export", "schema", "hil")


def stream_cases() -> Iterator[Case]:
    """Every command that prints, with and without --json; the quick ones with everything."""
    for command in (*COMMANDS, "hil"):
        usually = usual(command) if command != "hil" else ("--help",)
        variants = [(usually, "")]
        if command not in ("schema", "hil"):
            variants.append(((*usually, "--json"), ", --json"))
        for arguments, said in variants:
            for tried, shell in _STREAMS:
                if command in _QUICK or tried in (_LESS_WITH_JSON if said else _LESS):
                    yield _stream(command, tried, said, arguments, shell)
            for number, environment in enumerate(_ENVIRONMENTS):
                if command in _QUICK or (number == 0 and not said):
                    words = " ".join(f"{key}={value}" for key, value in environment.items())
                    yield Case(command, STREAMS, words + said, arguments, FINISHED, environment=environment)
    # A message must reach a person whatever the terminal is.
    for environment in _ENVIRONMENTS:
        words = " ".join(f"{key}={value}" for key, value in environment.items())
        arguments = ("größe Ω.yaml",)
        yield Case(
            "check", STREAMS, f"{words}, a missing file", arguments, (REFUSED,), environment=environment
        )


def _stream(command: str, tried: str, said: str, arguments: tuple[str, ...], shell: str) -> Case:
    full = "output on /dev/full" in tried
    return Case(
        command,
        STREAMS,
        tried + said,
        arguments,
        (BENCH,) if full else FINISHED,
        shell=shell,
        silent="2>" in shell,
        deaf=">&-" in shell.replace("2>&-", "") or "/dev/full" in shell or "head" in shell,
    )
