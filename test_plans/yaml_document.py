"""YAML with line numbers, and without YAML's surprises.

Plain scalars are read as YAML 1.2's core schema has them: `1e3` is a number, `1:30` and `off` are text.
Duplicate keys, tags and aliases are refused.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import yaml

from hil.core.errors import BadInputError
from hil.core.files import read_text

KeyPath = tuple[str | int, ...]
#: Some thousand steps; the reader needs 10 s for a megabyte.
LARGEST_BYTES = 500_000

_WORDS = {"": None, "~": None, "null": None, "Null": None, "NULL": None} | {
    "true": True,
    "True": True,
    "TRUE": True,
    "false": False,
    "False": False,
    "FALSE": False,
}
_INTEGER = re.compile(r"[-+]?[0-9]{1,300}")
#: Python's `1_00`, `inf` and digits of other scripts are text.
FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_NOT_FINITE = re.compile(r"([-+]?)\.(inf|nan)", re.IGNORECASE)


@dataclass(frozen=True)
class Document:
    """Plain values (dict, list, str, int, float, bool, None) and the line of each key and item.

    `spans` are the places of scalar values in the text: first character, and the one behind the last.
    """

    where: str
    value: object
    lines: Mapping[KeyPath, int]
    spans: Mapping[KeyPath, tuple[int, int]] = field(default_factory=dict)

    def place(self, path: KeyPath) -> str:
        """File, line and key of `path`, for a message; a key that is not there has its parent's line."""
        known = path
        while known and known not in self.lines:
            known = known[:-1]
        line = f"{self.where}: line {self.lines.get(known, 1)}"
        return f"{line}, key '{_spelled(path)}'" if path else line


def yaml_text(path: Path) -> str:
    """Text of a YAML file as people write them.

    Raises:
        BadInputError: not readable, no regular file, or far too large.
    """
    return read_text(path, LARGEST_BYTES, "give the YAML file of a plan, a sequence or a campaign")


def read_yaml(text: str, where: str) -> Document:
    """Read one YAML document.

    Raises:
        BadInputError: not YAML, a duplicate key, a tag, an alias, nested too deeply, or far too large.
    """
    if len(text) > LARGEST_BYTES:  # of bytes there are more still
        raise BadInputError(f"has more than {LARGEST_BYTES / 1e6:g} MB", where=where, fix="split the file")
    try:
        node = yaml.compose(text, Loader=_PlainLoader)
        lines: dict[KeyPath, int] = {(): 1}
        spans: dict[KeyPath, tuple[int, int]] = {}
        value = _value(node, (), lines, where) if node is not None else None
        _span(node, (), spans)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        place = f"{where}: line {mark.line + 1}" if mark else where
        raise BadInputError(f"not YAML: {error.problem or error.context}", where=place) from error
    except RecursionError as error:
        raise BadInputError("is nested too deeply", where=where) from error
    except (yaml.YAMLError, ValueError, OverflowError) as error:  # escapes beyond Unicode are ValueErrors
        raise BadInputError(f"not YAML: {str(error).splitlines()[0]}", where=where) from error
    return Document(where, value, lines, spans)


class _PlainLoader(yaml.SafeLoader):
    """Composes without tags, and without aliases, which could make a small file endless."""

    def compose_node(self, parent: yaml.Node | None, index: int) -> yaml.Node | None:
        event = self.peek_event()  # type: ignore[no-untyped-call]
        problem = ""
        if isinstance(event, yaml.AliasEvent):
            problem = "aliases (*) are not used in plans: write the values out, or use 'repeat'"
        elif getattr(event, "tag", None) is not None:
            problem = "tags (!) are not used in plans: remove it, or put the text in quotes"
        if problem:
            raise yaml.MarkedYAMLError(problem=problem, problem_mark=event.start_mark)
        return super().compose_node(parent, index)


def _value(node: yaml.Node, path: KeyPath, lines: dict[KeyPath, int], where: str) -> object:
    lines.setdefault(path, node.start_mark.line + 1)
    if isinstance(node, yaml.MappingNode):
        return _mapping(node, path, lines, where)
    if isinstance(node, yaml.SequenceNode):
        return [_value(item, (*path, i), lines, where) for i, item in enumerate(node.value)]
    return _scalar(node, where)


def _span(node: yaml.Node | None, path: KeyPath, spans: dict[KeyPath, tuple[int, int]]) -> None:
    """Where scalar values stand; the document is known to be sound."""
    if isinstance(node, yaml.MappingNode):
        for key, value in node.value:
            _span(value, (*path, key.value), spans)
    elif isinstance(node, yaml.SequenceNode):
        for index, item in enumerate(node.value):
            _span(item, (*path, index), spans)
    elif isinstance(node, yaml.ScalarNode):
        spans[path] = node.start_mark.index, node.end_mark.index


def _mapping(
    node: yaml.MappingNode, path: KeyPath, lines: dict[KeyPath, int], where: str
) -> dict[str, object]:
    values: dict[str, object] = {}
    for key_node, value_node in node.value:
        line = key_node.start_mark.line + 1
        if not isinstance(key_node, yaml.ScalarNode):
            raise BadInputError("a key must be a text", where=f"{where}: line {line}")
        key = _text(key_node, where)
        if key in values:
            raise BadInputError(
                f"the key {key!r} stands twice, first in line {lines[(*path, key)]}",
                where=f"{where}: line {line}",
                fix="remove one of them",
            )
        lines[(*path, key)] = line
        values[key] = _value(value_node, (*path, key), lines, where)
    return values


def _scalar(node: yaml.Node, where: str) -> object:
    text = _text(node, where)
    if isinstance(node, yaml.ScalarNode) and node.style is not None:
        return text
    if text in _WORDS:
        return _WORDS[text]
    if _INTEGER.fullmatch(text):
        return int(text)
    if FLOAT.fullmatch(text):
        return float(text)
    special = _NOT_FINITE.fullmatch(text)
    return float(f"{special[1]}{special[2]}") if special else text


def _text(node: yaml.Node, where: str) -> str:
    try:
        # JSON, which is YAML too, escapes characters beyond 16 bits as two halves.
        return str(node.value).encode("utf-16", "surrogatepass").decode("utf-16")
    except UnicodeDecodeError as error:
        place = f"{where}: line {node.start_mark.line + 1}"
        raise BadInputError("half of a character (a lone surrogate)", where=place) from error


def _spelled(path: KeyPath) -> str:
    spelled = ""
    for part in path:
        if isinstance(part, int):
            spelled += f"[{part + 1}]"
        else:
            word = part if part.isprintable() else repr(part)[1:-1]
            spelled += f".{word}" if spelled else word
    return spelled
