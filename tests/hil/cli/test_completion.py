"""What a shell is told when somebody presses tab."""

from __future__ import annotations

import os
import subprocess

import pytest

from tests.hil.cli.test_commands import HIL, hil
from tests.hil.cli.test_start import SLOW, modules_of


def offered(*words: str) -> set[str]:
    asked = {"_HIL_COMPLETE": "complete_bash", "COMP_WORDS": "\n".join(("hil", *words))}
    environment = {**os.environ, **asked, "COMP_CWORD": str(len(words))}
    done = subprocess.run([HIL], env=environment, capture_output=True, text=True)
    assert not done.stderr
    return set(done.stdout.split())


@pytest.mark.parametrize(
    ("words", "answer"),
    [
        (("sc",), {"schema"}),
        (("run", "acc"), {"acceptance"}),
        (("run", "acceptance", "--ben"), {"--bench"}),
        (("run", "acceptance", "--bench", "pa"), {"paper_car"}),
        (("bench", "doctor", "rear"), {"rear_axle_socketcan"}),
        (("schema", "co"), {"controller"}),
        (("campaign", "rob"), {"robustness"}),
        (("run", "./my"), set()),  # then the shell offers files
    ],
)
def test_what_can_stand_there_is_offered(words, answer):
    assert offered(*words) == answer


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_shell_takes_the_script(shell):
    script = hil("--show-completion", shell).stdout
    assert "_HIL_COMPLETE" in script
    assert ("compdef" in script, "complete --command" in script) == (shell == "zsh", shell == "fish")
    if shell == "bash":
        subprocess.run(["bash", "-n"], input=script, text=True, check=True)


def test_an_answer_imports_nothing_slow(monkeypatch):
    monkeypatch.setenv("_HIL_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", "hil\nrun\nacc")
    monkeypatch.setenv("COMP_CWORD", "2")
    assert not modules_of() & (SLOW - {"pydantic", "rich"})  # typer's own
