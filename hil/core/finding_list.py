"""Several findings in one message, a line each: as many as somebody reads."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

#: Some two screens; the first line is told whatever its length.
MOST_CHARACTERS = 4000


def listed(findings: Sequence[str]) -> str:
    """Each on an indented line, its further lines below it; the last line counts what is left out."""
    lines: list[str] = []
    characters = 0
    for finding in findings:
        line = "\n  " + finding.replace("\n", "\n  ")
        characters += len(line)
        if lines and characters > MOST_CHARACTERS:
            lines.append(f"\n  and {len(findings) - len(lines)} more, when these are corrected")
            break
        lines.append(line)
    return "".join(lines)


def repeated(names: Iterable[str]) -> list[str]:
    """Names that stand more than once, sorted."""
    return sorted(name for name, count in Counter(names).items() if count > 1)
