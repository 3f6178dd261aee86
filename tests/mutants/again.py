"""Faults of an earlier run that no test noticed, found in the code as it is now."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path

from tests.mutants.mutating import Mutant, difference, mutants_of
from tests.mutants.page import Outcome


def not_noticed_before(outcomes: Sequence[Outcome], root: Path) -> list[Mutant]:
    """One of each fault; what has left the code since is left out."""
    wanted: dict[str, dict[tuple[str, str, str], int]] = defaultdict(dict)
    for one in outcomes:
        if one.survived:
            wanted[one.file][one.operator, one.before, one.after] = one.line
    return [mutant for file, faults in wanted.items() for mutant in _found(file, root, faults)]


def _found(file: str, root: Path, faults: dict[tuple[str, str, str], int]) -> list[Mutant]:
    source = (root / file).read_text("utf-8")
    nearest: dict[tuple[str, str, str], Mutant] = {}
    for mutant in mutants_of(source, file):
        name = mutant.operator.removeprefix("core/")
        if not any(name == operator for operator, _, _ in faults):
            continue
        fault = (name, *difference(source, mutant.code(source)))
        if fault not in faults:
            continue
        # the same words may stand in several lines
        known = nearest.get(fault)
        if known is None or abs(mutant.line - faults[fault]) < abs(known.line - faults[fault]):
            nearest[fault] = mutant
    return list(nearest.values())
