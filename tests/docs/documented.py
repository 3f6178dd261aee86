"""The command lines that stand in the documents."""

from __future__ import annotations

import re
import shlex
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
_FOLDERS = ("tutorial", "how-to", "explanation", "reference")
PAGES = (
    *sorted(page for folder in _FOLDERS for page in (ROOT / "docs" / folder).glob("*.md")),
    ROOT / "README.md",
    ROOT / "hil/cli/starter/README.md",
)
_BLOCK = re.compile(r"^```(\w*)\n(.*?)^```", re.DOTALL | re.MULTILINE)
_SHELLS = ("", "sh", "console", "bash")
_COMMAND = re.compile(r"(?:\.venv/bin/)?hil (.*)")


@dataclass(frozen=True)
class Documented:
    """One of them: arguments behind `hil`, without comment and redirection."""

    page: str
    arguments: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.page}: hil {shlex.join(self.arguments)}"


def blocks_of(page: str, language: str) -> list[str]:
    """What stands in a page's blocks of a language."""
    blocks = _BLOCK.findall((ROOT / page).read_text("utf-8"))
    return [block for kind, block in blocks if kind == language]


def documented() -> list[Documented]:
    """Every command line of every page, in order."""
    found = []
    for page in PAGES:
        for language, block in _BLOCK.findall(page.read_text("utf-8")):
            if language not in _SHELLS:
                continue
            for line in block.replace("\\\n", " ").splitlines():
                command = _COMMAND.fullmatch(line.strip())
                if command:
                    words = shlex.split(command[1], comments=True)
                    until = next((n for n, word in enumerate(words) if word in (">", "|", "&")), len(words))
                    found.append(Documented(str(page.relative_to(ROOT)), tuple(words[:until])))
    return found
