"""Files that runs, studies and campaigns have left, as browsers are given them."""

from __future__ import annotations

from pathlib import Path
from typing import TypeVar

from fastapi.responses import FileResponse

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
