"""Opens MDF files with asammdf."""

from __future__ import annotations

import contextlib
import io
import logging
from pathlib import Path
from types import TracebackType
from typing import Any


def open_mdf(path: Path) -> Any:
    """asammdf's MDF of a file, to be closed by a `with`.

    Raises:
        Exception: of many kinds, for whatever is broken.
    """
    from asammdf import MDF  # slow to import, and seldom needed
    from asammdf.blocks.mdf_v4 import MDF4

    # What it finds odd in a file it also prints, with a traceback; what matters of it is stated here.
    logging.getLogger("asammdf").setLevel(logging.CRITICAL + 1)
    MDF4.__del__ = _close
    try:
        return MDF(path)
    except Exception as error:
        _close_files(error.__traceback__)
        raise


def _close_files(trace: TracebackType | None) -> None:
    """Close what asammdf opened before it found a file broken: it leaves that to the garbage collector."""
    while trace is not None:
        for held in list(trace.tb_frame.f_locals.values()):
            for one in (held, getattr(held, "_file", None)):
                if isinstance(one, io.BufferedReader):
                    one.close()
        trace = trace.tb_next


def _close(mdf: Any) -> None:
    """Close what a broken file kept from being set up: asammdf's own way prints a traceback then."""
    with contextlib.suppress(AttributeError):
        mdf.close()
