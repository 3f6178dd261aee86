"""Completion in shells, by typer: `hil --install-completion`, or `hil --show-completion` to see it first."""

from __future__ import annotations

import importlib.util
import os
from collections.abc import Callable, Iterable
from pathlib import Path

OPTIONS = ("--install-completion", "--show-completion")
_VARIABLE = "_HIL_COMPLETE"
#: With it typer takes the shell that is named, and does not look which one it was started from.
_NO_DETECTION = "_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION"

Complete = Callable[[str], list[str]]


def completion_wanted(arguments: list[str]) -> bool:
    """Whether a shell asks what can stand here, or a person for the shell's script."""
    return _VARIABLE in os.environ or arguments[:1] in ([option] for option in OPTIONS)


def take_named_shell(arguments: list[str]) -> None:
    """Have the script made for the shell that a person names behind the option, whichever asks for it."""
    if len(arguments) > 1 and arguments[0] in OPTIONS:
        os.environ[_NO_DETECTION] = "1"


def one_of(*words: str) -> Complete:
    """Completes with fixed words."""
    return _completing(lambda: words)


def shipped_plan() -> Complete:
    """Completes with the names of built-in plans; the shell offers files where none fits."""
    return _completing(lambda: _stems("test_plans", "library/*.yaml"))


def shipped_bench() -> Complete:
    """Completes with the names of shipped benches; the shell offers files where none fits."""
    return _completing(lambda: _stems("benches", "*.toml", "[buses."))


def shipped_model() -> Complete:
    """Completes with the names of shipped models; the shell offers files where none fits."""
    return _completing(lambda: _stems("benches", "*.toml", "\nkind = ", "[buses."))


def shipped_campaign() -> Complete:
    """Completes with the names of shipped campaigns; the shell offers files where none fits."""
    return _completing(lambda: _stems("hil", "analysis/campaigns/library/*.yaml"))


def _completing(words: Callable[[], Iterable[str]]) -> Complete:
    def complete(incomplete: str) -> list[str]:
        return [word for word in words() if word.startswith(incomplete)]

    return complete


def _stems(package: str, pattern: str, holding: str = "", without: str = "\0") -> list[str]:
    """Names of a package's files, which is not imported for it: that takes longer than a key press."""
    spec = importlib.util.find_spec(package)
    folders = [Path(place) for place in spec.submodule_search_locations or ()] if spec else []
    files = sorted(path for folder in folders for path in folder.glob(pattern))
    texts = {path.stem: path.read_text(encoding="utf-8") for path in files}
    return [name for name, text in texts.items() if holding in text and without not in text]
