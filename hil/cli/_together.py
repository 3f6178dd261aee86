"""Files of a command, written together; and progress for people only."""

from __future__ import annotations

import contextlib
import json
import math
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from rich.console import Console

from hil.core.files import replacing


def write_together(directory: Path, files: Mapping[str, bytes]) -> None:
    """Write all files, or none when one of them cannot be written.

    Raises:
        BadInputError: the directory cannot be written or the disk is full.
    """
    with contextlib.ExitStack() as stack:
        for name, content in files.items():
            stack.enter_context(replacing(directory / name)).write_bytes(content)


def to_json(value: Mapping[str, Any]) -> str:
    """JSON with two spaces of indent; infinities and NaN become null."""
    return json.dumps(_plain(value), indent=2, ensure_ascii=False, allow_nan=False)


@contextlib.contextmanager
def progress() -> Iterator[Callable[[str], None]]:
    """A function that shows what is being done, on a terminal; in a pipe it shows nothing."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield lambda _: None
        return
    with console.status("") as status:
        yield lambda text: status.update(text)


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if hasattr(value, "tolist"):
        return _plain(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
