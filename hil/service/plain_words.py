"""Errors of the commands, for people at the page: they see names of runs and files, and have no options.

The commands say where a file lies and which option mends what is wrong. At the page a file is called as it
is listed there, places of the service's machine are left out, and an option is the field that it is there.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from pathlib import Path

#: Options that are fields of the page, or of a request.
_FIELDS = {
    "--columns": "the columns",
    "--holdout": "the held-out recordings",
    "--at-most": "the time limit",
    "--model": "the model",
    "--confirm": "the name of who consents",
    "--may-worsen": "may_worsen",
    "--start": "the controller to begin with",
    "--controller": "the controller",
    "--draws": "draws",
    "--out": "another name",
    "--resume": "“Resume”",
}
#: A command with its option says where it is entered; an option alone does not.
_OPTION = re.compile(r"(?P<command>\bhil(?: [a-z]+)+ )?(?<![\w-])(?P<option>--[a-z][a-z-]*[a-z])")
#: A place on the machine: from the root, with a folder at least.
_PLACE = re.compile(r"(?<![\w./:])/(?:[^\s/:;,'\"]+/)+(?P<name>[^\s/:;,'\"]*)")
#: A way out that needs an option, where another way out follows.
_AVOIDABLE = re.compile(
    r"(?<![^\s])(?:choose|give|name) (?:[^;:,()]*? )?(?P<option>--[a-z][a-z-]*[a-z])[^;:,()]*, or "
)
_ELSEWHERE = "options with -- are those of the command at a terminal: this page has none for it"


def in_plain_words(text: str, names: Mapping[str, str], *, hide_places: bool = True) -> str:
    """A message of a command for whoever has no terminal.

    Args:
        names: what files are called, by their paths.
        hide_places: whether other paths keep their last part alone; not where people write paths.
    """
    for path in sorted(names, key=len, reverse=True):
        text = text.replace(path, names[path])
    if hide_places:
        text = _PLACE.sub(lambda found: found["name"] or "a folder of the service", text)
    text = _AVOIDABLE.sub(lambda found: found[0] if found["option"] in _FIELDS else "", text)
    left: list[str] = []

    def field(found: re.Match[str]) -> str:
        if found["command"]:
            return found[0]
        if found["option"] not in _FIELDS:
            left.append(found["option"])
        return _FIELDS.get(found["option"], found["option"])

    text = _OPTION.sub(field, text)
    return f"{text} ({_ELSEWHERE})" if left else text


def without_folders(text: str, folders: Iterable[Path]) -> str:
    """A message in which files below some folders are called by their names alone."""
    for folder in folders:
        text = re.sub(re.escape(str(folder.resolve())) + r"/(?:[^\s/:,'\"]+/)*", "", text)
    return text


def names_in(asked: object) -> dict[str, str]:
    """Names of files by the paths that stand in what was asked, however deep."""
    if isinstance(asked, Mapping):
        return {path: name for one in asked.values() for path, name in names_in(one).items()}
    if isinstance(asked, list | tuple):
        return {path: name for one in asked for path, name in names_in(one).items()}
    if isinstance(asked, str) and asked.startswith("/") and "\n" not in asked:
        return {asked: Path(asked).name}
    return {}
