"""Opens MDF files with asammdf."""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import Any


def open_mdf(path: Path) -> Any:
    """asammdf's MDF of a file, to be closed by a `with`.

    Raises:
        Exception: of many kinds, for whatever is broken.
    """
    from asammdf import MDF  # slow to import, and seldom needed
    from asammdf.blocks.mdf_v4 import MDF4

    MDF4.__del__ = _close
    return MDF(path)


def _close(mdf: Any) -> None:
    """Close what a broken file kept from being set up: asammdf's own way prints a traceback then."""
    with contextlib.suppress(AttributeError):
        mdf.close()
