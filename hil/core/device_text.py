"""Text of a file that describes a device (DBC, EDS), as other tools wrote it."""

from __future__ import annotations

from pathlib import Path

from hil.core.files import read_bytes

_LARGEST_BYTES = 20_000_000  # the largest vehicle's DBC has a tenth of this


def read_device_text(path: Path, fix: str) -> str:
    """Text of a file in UTF-8 or in Windows' code page, which most such tools write.

    Raises:
        BadInputError: it is missing, no regular file, cannot be read, or too large to be a description; with
            `fix`.
    """
    content = read_bytes(path, _LARGEST_BYTES, fix)
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("cp1252", errors="replace")
