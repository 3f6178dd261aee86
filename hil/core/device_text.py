"""Text of a file that describes a device (DBC, EDS), as other tools wrote it."""

from __future__ import annotations

from pathlib import Path

from hil.core.errors import BadInputError

_LARGEST_BYTES = 20_000_000  # the largest vehicle's DBC has a tenth of this


def read_device_text(path: Path, fix: str) -> str:
    """Text of a file in UTF-8 or in Windows' code page, which most such tools write.

    Raises:
        BadInputError: it is missing, no regular file, cannot be read, or too large to be a description; with
            `fix`.
    """
    try:
        if path.exists() and not path.is_file():
            what = "is a directory, not a file" if path.is_dir() else "is not a regular file"
            raise BadInputError(what, where=str(path), fix=fix)
        if path.stat().st_size > _LARGEST_BYTES:
            raise BadInputError(
                f"has more than {_LARGEST_BYTES / 1e6:.0f} MB, which no description of a device has",
                where=str(path),
                fix=fix,
            )
        content = path.read_bytes()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise BadInputError(str(reason), where=str(path), fix=fix) from error
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("cp1252", errors="replace")
