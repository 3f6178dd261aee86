"""Importing python-can without asammdf, which takes half a second and is for log files that no command reads.

python-can has no setting for it: `can.io.mf4` imports asammdf, and pandas with it, whenever it is installed.
It does without where the import fails, so it is made to fail, for the length of this one import.
"""

from __future__ import annotations

import sys


def import_python_can() -> None:
    """Import `can` so that its MDF4 reader and writer say that asammdf is missing; ours do not ask it."""
    if "can" in sys.modules or "asammdf" in sys.modules:
        return
    sys.modules["asammdf"] = None  # type: ignore[assignment]
    try:
        import can  # noqa: F401
    finally:
        del sys.modules["asammdf"]
