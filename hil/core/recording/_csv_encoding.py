"""Text of a CSV as UTF-8, whatever Unicode it came in."""

from __future__ import annotations

import codecs
from typing import BinaryIO, cast

_MARKS = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)


def as_utf8(file: BinaryIO) -> BinaryIO:
    """The file, or what reads it as UTF-8 where its first bytes say that it is UTF-16.

    Reading it raises UnicodeError where it is not what its first bytes say.
    """
    mark = file.read(2)
    file.seek(0)
    if mark not in _MARKS:
        return file
    return cast(BinaryIO, codecs.EncodedFile(cast("codecs._Stream", file), "utf-8", "utf-16"))
