"""Every refusal of the service that somebody can meet on the page is in the reader's language.

Refusals are read from the code: what is wrong and what to do are its texts, with a figure in the place of
each value. `translated` of the page has to know the form of each.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

import pytest

from tests.hil.service.frontend.sentences import NODE, ROOT, VALUE, unknown

_SERVICE = ROOT / "hil/service"
#: What never reaches the page: commands, agents, providers of sign-ins, notices, what only its log says.
_ELSEWHERE = (
    "agents/run_upload.py",
    "api/_agents.py",
    "api/_page.py",
    "api/_queries.py",  # the page asks with known parameters
    "archive/",
    "audit.py",
    "notices/",
    "serving.py",
    "sign_in/",
    "stop_post/",
    "store/_opening.py",
)
#: The same of single texts.
_NEVER_SHOWN = {
    "it has 7 bytes",  # of a range of a file, which the page never asks for
    "this service has no sign-in",
    "send a token, or start it with --sign-in FILE",
    "no_role",  # a name, for which the page has a sentence
    "subject 7 of 7 has no group with a role",
    "hil serve --add-token NAME=admin",  # a command is one in any language
}
_VALUES = {
    "me.role": "viewer",
    "role": "operator",
    "self._plural": "studies",
    "span(found)": "from 2026-11-28 15:44 UTC to 2026-11-28 17:14 UTC",
    "moment(lease.until)": "2026-11-28 17:14 UTC",
    "lines": "\n  reason is missing",
}


def _texts(node: ast.expr, around: ast.AST) -> Iterator[str]:
    """What an expression may say; nothing where it is not a text of this code."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        yield node.value
    elif isinstance(node, ast.JoinedStr):
        yield "".join(_piece(one, around) for one in node.values)
    elif isinstance(node, ast.IfExp):
        yield from (*_texts(node.body, around), *_texts(node.orelse, around))
    elif isinstance(node, ast.Name):
        for one in ast.walk(around):
            if isinstance(one, ast.Assign) and node.id in [getattr(to, "id", "") for to in one.targets]:
                yield from _texts(one.value, around)


def _piece(node: ast.expr, around: ast.AST) -> str:
    if isinstance(node, ast.FormattedValue):
        said = next(_texts(node.value, around), "") if isinstance(node.value, ast.Name) else ""
        return said or _VALUES.get(ast.unparse(node.value), VALUE)
    assert isinstance(node, ast.Constant)
    return str(node.value)


def _refusals(tree: ast.Module) -> Iterator[str]:
    constants = [one for one in tree.body if isinstance(one, ast.Assign)]
    functions = [one for one in ast.walk(tree) if isinstance(one, ast.FunctionDef | ast.AsyncFunctionDef)]
    for function in functions:
        around = ast.Module([*constants, function], [])
        for call in ast.walk(around):
            name = getattr(call.func, "id", "") if isinstance(call, ast.Call) else ""
            if not isinstance(call, ast.Call) or not name.endswith(("Error", "Problem")):
                continue
            fixes = [one.value for one in call.keywords if one.arg in ("what", "fix")]
            for node in (*call.args, *fixes):
                yield from _texts(node, around)
        for answer in ast.walk(around):  # a status and what is said with it
            if isinstance(answer, ast.Tuple) and _is_a_status(answer.elts[:1]):
                yield from _texts(answer.elts[1], around)


def _is_a_status(nodes: list[ast.expr]) -> bool:
    return [isinstance(one, ast.Constant) and one.value in range(400, 600) for one in nodes] == [True]


def _every_refusal() -> dict[str, str]:
    found: dict[str, str] = {}
    for path in sorted(_SERVICE.rglob("*.py")):
        where = path.relative_to(_SERVICE).as_posix()
        if not where.startswith((*_ELSEWHERE, "frontend/")):
            tree = ast.parse(path.read_text("utf-8"))
            found |= {text: where for text in _refusals(tree) if text and text != VALUE}
    return {text: where for text, where in found.items() if text not in _NEVER_SHOWN}


@pytest.mark.slow
@pytest.mark.skipif(not NODE.is_file(), reason="there is no node: make page")
def test_every_refusal_that_the_page_can_show_has_words() -> None:
    found = _every_refusal()
    assert len(found) > 100
    assert {text: found[text] for text in unknown(list(found))} == {}


@pytest.mark.skipif(not NODE.is_file(), reason="there is no node: make page")
def test_a_refusal_that_the_page_does_not_know_is_found() -> None:
    assert unknown(["a run is under way there", "the moon is full"]) == ["the moon is full"]
