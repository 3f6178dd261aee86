"""Files in a store that fsspec reaches. Every call waits for a network: for threads of their own."""

from __future__ import annotations

import contextlib
import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar
from urllib.parse import urlsplit

from fsspec.core import url_to_fs

from hil.core.errors import BadInputError, BenchError
from hil.core.errors.wording import shortened
from hil.core.files import read_bytes, replacing, sha256_of

T = TypeVar("T")
#: What is asked for at once, and so how much of a file is in memory.
PIECE_BYTES = 4_000_000
_CONNECT_WITHIN_S, _ANSWER_WITHIN_S = 5, 30
#: The keeper tries again itself, later: a thread shall know soon.
_S3 = {
    "config_kwargs": {
        "connect_timeout": _CONNECT_WITHIN_S,
        "read_timeout": _ANSWER_WITHIN_S,
        "retries": {"max_attempts": 1},
        # not every server of S3 knows these; what lies there is read back and compared here
        "request_checksum_calculation": "when_required",
        "response_checksum_validation": "when_required",
    },
    "max_concurrency": 1,
    "skip_instance_cache": True,
    "use_listings_cache": False,
}
_LONGEST = 300


class ArchiveAwayError(BenchError):
    """The store does not answer, or does not take or give what is asked for."""


@dataclass(frozen=True)
class Kept:
    """A file that the store has, as it was read back: its size and its SHA-256, hexadecimal."""

    size: int
    sha256: str


class Archive:
    """A store of files by name.

    Args:
        url: as fsspec has it: `s3://bucket/prefix`, `/mnt/archive`. Where S3 is and who asks stand in the
            environment or in the files of AWS, never here.

    Raises:
        BadInputError: no such kind of store, or one with a password.
    """

    def __init__(self, url: str) -> None:
        if urlsplit(url).username is not None and url.startswith("s3"):
            raise BadInputError(
                "contains a key, which others could read",
                where="--store",
                fix="set AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY, or a profile",
            )
        self.shown = url
        try:
            self._s3 = url.startswith(("s3://", "s3a://"))
            self._files, root = url_to_fs(url, **(_S3 if self._s3 else {}))
        except (ImportError, ValueError) as error:
            raise BadInputError(
                f"no store can be opened by this URL: {shortened(str(error), _LONGEST)}",
                where="--store",
                fix="s3://bucket/prefix (pip install 'eaxle-hil[s3]'), or a folder",
            ) from error
        self._root = root.rstrip("/")
        if hasattr(self._files, "retries"):
            self._files.retries = 1

    def put(self, path: Path, name: str) -> Kept:
        """Bring a file there and read it back: what is reported is what lies there.

        Raises:
            BadInputError: the file cannot be read.
            ArchiveAwayError: the store does not take it, or gave back something else.
        """
        wanted = Kept(path.stat().st_size, sha256_of(path))
        place = self._place(name)

        def bring() -> None:
            if not self._s3:  # it has no folders, and its bucket is not ours to make
                self._files.makedirs(place.rpartition("/")[0], exist_ok=True)
            if wanted.size:
                self._files.put_file(str(path), place)
            else:
                self._files.pipe_file(place, read_bytes(path))

        self._ask(bring, name)
        if self._read_back(name, wanted.size) != wanted:
            raise ArchiveAwayError(
                "the store returned a different file from the one written",
                where=self._where(name),
                fix=_LATER,
            )
        return wanted

    def read(self, name: str, start: int, end: int) -> bytes:
        """Bytes of a file from `start` to before `end`.

        Raises:
            ArchiveAwayError: the store does not give them.
        """
        place = self._place(name)
        if start >= end:
            return b""
        found: Any = self._ask(lambda: self._files.cat_file(place, start=start, end=end), name)
        if len(found) != end - start:
            raise ArchiveAwayError("the store's file is too short", where=self._where(name))
        return bytes(found)

    def get(self, name: str, path: Path, wanted: Kept) -> None:
        """Bring a file back, as it was when it was kept.

        Raises:
            BadInputError: it cannot be written there.
            ArchiveAwayError: the store does not give it, or not as it was.
        """
        with replacing(path) as temporary:
            with temporary.open("wb") as file:
                for at in range(0, wanted.size, PIECE_BYTES):
                    file.write(self.read(name, at, min(wanted.size, at + PIECE_BYTES)))
            if sha256_of(temporary) != wanted.sha256:
                raise ArchiveAwayError("the store's file differs from the one written", where=name)

    def remove(self, name: str) -> None:
        """Remove a file; one that is not there is no mistake.

        Raises:
            ArchiveAwayError: the store does not answer, or does not remove it.
        """

        def drop() -> None:
            with contextlib.suppress(FileNotFoundError):
                self._files.rm_file(self._place(name))

        self._ask(drop, name)

    def _read_back(self, name: str, size: int) -> Kept:
        found = hashlib.sha256()
        for start in range(0, size, PIECE_BYTES):
            found.update(self.read(name, start, min(size, start + PIECE_BYTES)))
        info: Any = self._ask(lambda: self._files.info(self._place(name)), name)
        return Kept(int(info["size"]), found.hexdigest())

    def _place(self, name: str) -> str:
        return f"{self._root}/{name}"

    def _where(self, name: str) -> str:
        return f"{self.shown.rstrip('/')}/{name}"

    def _ask(self, ask: Callable[[], T], name: str) -> T:
        try:
            return ask()
        except Exception as error:  # each kind of store has errors of its own
            text = shortened((str(error).strip() or type(error).__name__).splitlines()[0], _LONGEST)
            raise ArchiveAwayError(
                f"the store cannot be reached: {text}", where=self._where(name), fix=_LATER
            ) from error


_LATER = "the service retries; files that are not in the store stay here"
