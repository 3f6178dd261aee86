"""Files that runs, studies and campaigns have left, as browsers are given them.

What the archive has is sent on as it comes, or the part of it that is asked for.
"""

from __future__ import annotations

import re
from collections.abc import AsyncIterator
from pathlib import Path
from typing import TypeVar

from fastapi.responses import FileResponse
from starlette.responses import Response, StreamingResponse

from hil.service.api._problems import RefusedError
from hil.service.archive import Keeper
from hil.service.store import KeptFile

_RANGE = re.compile(r"bytes=(\d{0,15})-(\d{0,15})")


async def from_store(
    keeper: Keeper, run: int, file: KeptFile, media: str, headers: dict[str, str], wanted: str | None
) -> Response:
    """A file, or the range of its bytes that is wanted (RFC 9110, 14.2); a list of ranges gives the whole.

    Raises:
        RefusedError: the file has no such bytes.
        BenchError: the store does not give it.
    """
    part = _part(wanted, file.size)
    start, end = part or (0, file.size)
    pieces = keeper.pieces(run, file.name, start, end)
    first = await anext(
        pieces, b""
    )  # a store that is away is reported while there still is a status to tell it by
    headers = {
        **headers,
        "accept-ranges": "bytes",
        "content-length": str(end - start),
        "etag": f'"{file.sha256}"',
    }
    if part is not None:
        headers["content-range"] = f"bytes {start}-{end - 1}/{file.size}"

    async def sent() -> AsyncIterator[bytes]:
        yield first
        async for piece in pieces:
            yield piece

    return StreamingResponse(sent(), 200 if part is None else 206, headers, media)


def _part(wanted: str | None, size: int) -> tuple[int, int] | None:
    """First byte and the one after the last; None if the whole is sent."""
    found = _RANGE.fullmatch(wanted.strip()) if wanted else None
    if found is None or not any(found.groups()):
        return None
    first, last = found.groups()
    if first:
        start, end = int(first), min(int(last) + 1, size) if last else size
    else:
        start, end = max(0, size - int(last)), size
    if start >= size:
        raise RefusedError(416, f"it has {size} bytes", where=wanted or "")
    return (start, end) if start < end else None


#: Reports bring their own scripts: they may run them, and reach nothing of the service.
_SANDBOX = "sandbox allow-scripts allow-downloads; default-src 'unsafe-inline' data: blob:"
_MEDIA = {".html": "text/html", ".json": "application/json", ".pdf": "application/pdf", ".xml": "text/xml"}
#: A media type, or none where that may be.
M = TypeVar("M", str, str | None)
_SAVED = (".mcap", ".parquet")  # nothing that a browser shows


def media_of(path: Path, other: M) -> M:
    """A file's media type; `other` if its name's ending does not tell."""
    return _MEDIA.get(path.suffix, other)


def headers_of(path: Path) -> dict[str, str]:
    """What keeps a page in its place."""
    return {"content-security-policy": _SANDBOX} if path.suffix == ".html" else {}


def disposition_of(path: Path) -> str:
    """Whether it is shown or saved."""
    return "attachment" if path.suffix in _SAVED else "inline"


def left_file(path: Path, shown: str, media: str | None) -> FileResponse:
    """The file under the name `shown`; `media` is its type if its name's ending does not tell."""
    return FileResponse(
        path,
        media_type=media_of(path, media),
        filename=shown,
        content_disposition_type=disposition_of(path),
        headers=headers_of(path),
    )
