"""Which faults can be put into a file: cosmic-ray's operators, where they change what the code does."""

from __future__ import annotations

import random
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from itertools import islice
from pathlib import Path
from typing import Any

from cosmic_ray.ast import ast_nodes, get_ast
from cosmic_ray.mutating import mutate_code
from cosmic_ray.plugins import get_operator, operator_names

#: Decorators of functions that numba compiles: they have tests by closed forms, and each mutant would be
#: compiled anew.
COMPILED = ("compiled", "inlined", "compiled_without_lock", "njit")
_STARRED = ("parameters", "param", "argument", "arglist", "lambdef")
_ARITHMETIC = ("Add", "Sub", "Mul", "Div", "FloorDiv", "Mod", "Pow")


@dataclass(frozen=True)
class Mutant:
    """The `occurrence`th place of a file where `operator` applies; lines from 1, columns from 0."""

    file: str
    operator: str
    occurrence: int
    line: int
    column: int

    def code(self, source: str) -> str:
        """The source with the fault in it."""
        changed = mutate_code(source, get_operator(self.operator)(), self.occurrence)
        assert isinstance(changed, str)
        return changed


def drawn(files: list[Path], root: Path, count: int, seed: int) -> tuple[list[Mutant], int]:
    """(`count` mutants, all that there are): every place once before any place a second time, by `seed`."""
    rng = random.Random(seed)
    places: dict[tuple[str, int, int], list[Mutant]] = defaultdict(list)
    for file in sorted(files):
        for one in mutants_of(file.read_text("utf-8"), file.relative_to(root).as_posix()):
            places[one.file, one.line, one.column].append(one)
    groups = list(places.values())
    for group in groups:
        rng.shuffle(group)
    rng.shuffle(groups)
    order = [g[turn] for turn in range(max(map(len, groups), default=0)) for g in groups if turn < len(g)]
    return list(islice(filter(_Compiles(root), order), count)), len(order)


class _Compiles:
    """Whether a mutant is Python at all: the star of keyword-only arguments is not, made a power."""

    def __init__(self, root: Path) -> None:
        self._root = root

    def __call__(self, mutant: Mutant) -> bool:
        try:
            compile(mutant.code((self._root / mutant.file).read_text("utf-8")), mutant.file, "exec")
        except (SyntaxError, AttributeError):  # an operator of cosmic-ray's meets code it does not know
            return False
        return True


def mutants_of(source: str, file: str) -> Iterator[Mutant]:
    """Every fault that can be put into a file, whether or not it is Python then."""
    nodes = list(ast_nodes(get_ast(source)))
    idle = {node for node in nodes if _is_idle(node)}
    for name in _operators():
        operator = get_operator(name)()
        occurrence = 0
        for node in nodes:
            for start, _ in operator.mutation_positions(node):
                if not _under(node, idle):
                    yield Mutant(file, name, occurrence, *start)
                occurrence += 1


def difference(before: str, after: str) -> tuple[str, str]:
    """The first line that differs."""
    for old, new in zip(before.splitlines(), after.splitlines(), strict=False):
        if old != new:
            return old.strip(), new.strip()
    return before.splitlines()[-1].strip(), "(nothing)"


@cache
def _operators() -> tuple[str, ...]:
    return tuple(name for name in operator_names() if _is_telling(name.removeprefix("core/")))


def _is_telling(name: str) -> bool:
    """Arithmetic turned into bits ends in a TypeError that any test notices: it only pleases the score."""
    if name in ("VariableReplacer", "VariableInserter"):
        return False
    before, _, after = name.removeprefix("ReplaceBinaryOperator_").partition("_")
    return not name.startswith("ReplaceBinaryOperator_") or (before in _ARITHMETIC) == (after in _ARITHMETIC)


def _is_idle(node: Any) -> bool:
    """Annotations, which nothing evaluates, functions that are compiled, and stars that multiply nothing."""
    parent = node.parent
    if node.type == "decorated":
        code = node.children[0].get_code()
        return any(f"@{name}\n" in code or f"@{name}(" in code for name in COMPILED)
    if parent is None:
        return False
    if node.type == "operator" and parent.type in _STARRED:
        return True
    if parent.type == "annassign":
        return node is parent.children[1]
    if parent.type == "tfpdef":
        return node is parent.children[-1]
    return parent.type == "funcdef" and node is parent.annotation


def _under(node: Any, idle: set[Any]) -> bool:
    while node is not None:
        if node in idle:
            return True
        node = node.parent
    return False
