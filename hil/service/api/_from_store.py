"""Files that the store has, sent on as they come, or the part of them that is asked for."""

from __future__ import annotations

import re
from collections.abc import AsyncIterator

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
