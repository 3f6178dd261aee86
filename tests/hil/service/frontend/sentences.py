"""Sentences of the code, read from its source, and which of them the page has words for.

A literal reads like a sentence if two of its words stand side by side. A text with values in it is read with
a figure for each value; a value that is itself a text of this function or module is read as that text, and a
text that only stands in others is read there. Where a text goes on its way to a person is not followed.
"""

from __future__ import annotations

import ast
import itertools
import json
import re
import subprocess
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path
from types import MappingProxyType

ROOT = Path(__file__).parents[4]
NODE = ROOT / ".venv-node/bin/node"
#: Stands for a value.
VALUE = "7"
_PHRASES = ROOT / "hil/service/frontend/src/i18n/phrases.ts"
_TWO_WORDS = re.compile(r"[A-Za-z']{2,}[,;:]? \(?[A-Za-z']{2,}")
_MOST = 24  # of the texts that one with several alternatives may be
_LOGS = ("debug", "info", "warning", "error", "exception")
#: Keywords of a call whose text is read in the form of a file.
_OF_FORMS = ("description", "json_schema_extra")


def unknown(texts: list[str]) -> list[str]:
    """Those whose form the page does not know."""
    program = (
        f"const {{translated}} = await import({json.dumps(_PHRASES.as_uri())});"
        f"console.log(JSON.stringify({json.dumps(texts)}.filter((one) => translated(one) === null)))"
    )
    command = [str(NODE), "--input-type=module", "--no-warnings", "-e", program]
    found: list[str] = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    return found


def sentences(
    source: str, left_out: Collection[str] = (), values: Mapping[str, str] = MappingProxyType({})
) -> list[str]:
    """What a module may say to people; not its docstrings, log, descriptions of fields and ValueErrors.

    Args:
        left_out: names of functions whose texts are read elsewhere.
        values: what stands for some values in place of a figure, by the last name of their expressions.
    """
    reader = _Reader(left_out, values)
    reader.visit(ast.parse(source))
    found = (text for node, texts in reader.found if id(node) not in reader.inner for text in texts)
    lines = (line.strip() for text in found for line in text.split("\n"))
    return [line for line in dict.fromkeys(lines) if _TWO_WORDS.search(line)]


class _Reader(ast.NodeVisitor):
    """Collects `found`: nodes with the texts that each may be; `inner`: nodes that stand in other texts."""

    def __init__(self, left_out: Collection[str], values: Mapping[str, str]) -> None:
        self._left_out, self._values = left_out, values
        self._scopes: list[dict[str, list[ast.expr]]] = []
        self.found: list[tuple[ast.expr, list[str]]] = []
        self.inner: set[int] = set()

    def visit_Module(self, node: ast.Module) -> None:
        self._scope(node.body)

    def visit_ClassDef(self, node: ast.ClassDef) -> None:
        self._scope(node.body)

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        if node.name not in self._left_out:
            self._scope(node.body)

    def visit_Expr(self, node: ast.Expr) -> None:
        if not isinstance(node.value, ast.Constant):  # a docstring
            self.visit(node.value)

    def visit_Call(self, node: ast.Call) -> None:
        name = _last_name(node.func)
        if name in ("ValueError", "compile") or (name in _LOGS and _is_a_log(node.func)):
            return
        for one in (node.func, *node.args, *(one.value for one in node.keywords if one.arg not in _OF_FORMS)):
            self.visit(one)

    def visit_Constant(self, node: ast.Constant) -> None:
        if isinstance(node.value, str):
            self.found.append((node, [node.value]))

    def visit_JoinedStr(self, node: ast.JoinedStr) -> None:
        self.found.append((node, list(itertools.islice(self._texts(node), _MOST))))
        for one in node.values:
            if isinstance(one, ast.FormattedValue) and isinstance(one.value, ast.Call):
                self.visit(one.value)

    def visit_BinOp(self, node: ast.BinOp) -> None:
        texts = list(itertools.islice(self._texts(node), _MOST))
        if texts == [VALUE]:
            self.generic_visit(node)
        else:
            self.found.append((node, texts))

    def _scope(self, body: list[ast.stmt]) -> None:
        assigned: dict[str, list[ast.expr]] = {}
        for target, value in (pair for statement in body for pair in _assignments(statement)):
            assigned.setdefault(target, []).append(value)
        self._scopes.append(assigned)
        for statement in body:
            self.visit(statement)
        self._scopes.pop()

    def _texts(self, node: ast.expr, inside: tuple[str, ...] = ()) -> Iterator[str]:
        """What an expression may be as a text; `VALUE` where that is not known here."""
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value
        elif isinstance(node, ast.JoinedStr):
            pieces = [list(self._texts(one, inside)) for one in node.values]
            yield from map("".join, itertools.product(*pieces))
        elif isinstance(node, ast.FormattedValue):
            given = self._values.get(_last_name(node.value), VALUE)
            yield from (given if text == VALUE else text for text in self._texts(node.value, inside))
        elif isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
            pieces = [list(self._texts(one, inside)) for one in (node.left, node.right)]
            both = itertools.product(*pieces)
            yield from dict.fromkeys(VALUE if set(one) == {VALUE} else "".join(one) for one in both)
        elif isinstance(node, ast.IfExp):
            yield from (*self._texts(node.body, inside), *self._texts(node.orelse, inside))
        elif isinstance(node, ast.Name) and node.id not in inside:
            yield from self._named(node.id, inside)
        else:
            yield VALUE

    def _named(self, name: str, inside: tuple[str, ...]) -> Iterator[str]:
        """Texts that a name stands for where it is used: in the function, else in the module."""
        values = next((scope[name] for scope in reversed(self._scopes) if name in scope), [])
        texts = [text for value in values for text in self._texts(value, (*inside, name))]
        if set(texts) - {VALUE}:
            self.inner.update(id(one) for value in values for one in ast.walk(value))
        yield from texts or [VALUE]


def _is_a_log(function: ast.expr) -> bool:
    return isinstance(function, ast.Attribute) and "log" in _last_name(function.value).lower()


def _last_name(node: ast.expr) -> str:
    while isinstance(node, ast.Call):
        node = node.func
    return getattr(node, "attr", "") or getattr(node, "id", "")


def _assignments(statement: ast.stmt) -> Iterator[tuple[str, ast.expr]]:
    """Names and what is assigned to them, also in blocks within and of several at once."""
    for one in ast.walk(statement):
        targets = one.targets if isinstance(one, ast.Assign) else [getattr(one, "target", None)]
        value = getattr(one, "value", None)
        for target in targets if isinstance(one, ast.Assign | ast.AnnAssign | ast.NamedExpr) else []:
            if isinstance(target, ast.Name) and isinstance(value, ast.expr):
                yield target.id, value
            elif isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
                pairs = zip(target.elts, value.elts, strict=False)
                yield from ((to.id, part) for to, part in pairs if isinstance(to, ast.Name))
