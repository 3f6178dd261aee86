"""Where results go: numbered folders, nothing overwritten unasked, one command at a time in a folder."""

from __future__ import annotations

import contextlib
import errno
import json
import logging
import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from hil.core.errors import BadInputError
from hil.core.files import make_directory, read_text, refuse_special, replacing
from hil.core.files.locks import HeldError, lock_on

logger = logging.getLogger(__name__)

_MOST_CLAIMS = 100
_OVERWRITE = "add --overwrite to replace it, or name another place with --out"


@dataclass(frozen=True)
class ResultsFolder:
    """A folder that this command alone writes to until it is done."""

    folder: Path
    stale: tuple[Path, ...]
    """Files of earlier results there, which --overwrite lets go."""
    lock: int = -1
    """Descriptor that keeps others from writing here: as long as any process has it open."""

    def write(self, files: Mapping[str, bytes], inputs: Iterable[Path] = ()) -> None:
        """Write all files, or none when one of them cannot be written; earlier results go.

        Raises:
            BadInputError: a file is an input, or the folder cannot be written.
            BenchError: the disk is full.
        """
        refuse_inputs([self.folder / name for name in files], inputs)
        with contextlib.ExitStack() as stack:
            for name, content in files.items():
                stack.enter_context(replacing(self.folder / name)).write_bytes(content)
        self.remove_stale(files)

    def remove_stale(self, kept: Iterable[str] = ()) -> None:
        """Remove the earlier results but those just written."""
        names = set(kept)
        for path in self.stale:
            if path.name not in names:
                path.unlink(missing_ok=True)


@contextlib.contextmanager
def results_in(
    out: Path | None,
    names: Iterable[str],
    *,
    inputs: Iterable[Path] = (),
    overwrite: bool = False,
    default: str = "results",
    summary: str = "",
) -> Iterator[ResultsFolder]:
    """Claim the folder `out` for results called `names`; without `out` a new numbered one, `out/DEFAULT-001`.

    A folder that this process made and that stays empty is removed again.

    Args:
        inputs: files that the command reads; none of them is ever written over.
        summary: JSON file among the results whose `files` name all results of an earlier command.

    Raises:
        BadInputError: `out` holds results already (without `overwrite`), is no folder, cannot be written, or
            another command is writing there.
    """
    with _claimed(out, default) as (folder, lock):
        there = [folder / name for name in dict.fromkeys((*names, *_listed(folder / summary)))]
        for path in there:
            refuse_special(path)
        refuse_inputs(there, inputs)
        there = [path for path in there if path.exists()]
        if there and not overwrite:
            raise BadInputError(f"holds results already: {there[0].name}", where=str(folder), fix=_OVERWRITE)
        logger.info("results go to %s", folder)
        yield ResultsFolder(folder, tuple(there), lock)


@contextlib.contextmanager
def _claimed(out: Path | None, default: str) -> Iterator[tuple[Path, int]]:
    """The folder and its lock; what this process made and no one used goes again while the lock is held."""
    with contextlib.ExitStack() as held:
        for _ in range(_MOST_CLAIMS):
            made: list[Path] = []
            folder = _numbered(default, made) if out is None else _named(out, made)
            try:
                lock = held.enter_context(alone_in(folder))
                if os.path.samestat(os.fstat(lock), folder.stat()):
                    break
            except FileNotFoundError:
                pass
            held.close()  # another command made it, found nothing to keep, and has just removed it
        else:
            raise _unusable(folder, FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT)))
        try:
            yield folder, lock
        finally:
            for path in reversed(made):
                with contextlib.suppress(OSError):  # not empty: the results are there
                    path.rmdir()


def refuse_file(out: Path, inputs: Iterable[Path], *, overwrite: bool) -> None:
    """Refuse a single file as result that is an input, or exists already.

    Raises:
        BadInputError: names the file.
    """
    refuse_special(out)
    refuse_inputs([out], inputs)
    if out.exists() and not overwrite:
        raise BadInputError("exists already", where=str(out), fix=_OVERWRITE)


def refuse_missing(path: Path) -> None:
    """Say that an input is not there before a place is made for the results.

    Raises:
        BadInputError: names the file.
    """
    if not path.exists():
        raise BadInputError("there is no such file", where=str(path), fix="check the path")


def refuse_inputs(outputs: Iterable[Path], inputs: Iterable[Path]) -> None:
    """Refuse to write over what is read.

    Raises:
        BadInputError: names the file.
    """
    read = [path for path in inputs if path.exists()]
    for output in outputs:
        if any(output.exists() and output.samefile(path) for path in read):
            raise BadInputError(
                "is read by this command and would be written over",
                where=str(output),
                fix="name another place with --out",
            )


def _numbered(default: str, made: list[Path]) -> Path:
    base = Path("out")
    _make(base, made)
    while True:
        taken = [int(n) for p in base.glob(f"{default}-*") if (n := p.name[len(default) + 1 :]).isdecimal()]
        folder = base / f"{default}-{max(taken, default=0) + 1:03d}"
        try:
            folder.mkdir()
        except FileExistsError:
            continue  # another run was quicker
        except OSError as error:
            raise _unusable(folder, error) from error
        made.append(folder)
        return folder


def _named(out: Path, made: list[Path]) -> Path:
    _make(out, made)
    if out.exists() and not os.access(out, os.W_OK):
        raise BadInputError("cannot be written", where=str(out), fix="choose another place with --out")
    return out


def _make(folder: Path, made: list[Path]) -> None:
    missing = []
    place = folder
    while not place.exists() and place != place.parent:
        missing.append(place)
        place = place.parent
    if place.exists() and not place.is_dir():
        raise BadInputError("is not a directory", where=str(place), fix="choose another place with --out")
    for path in reversed(missing):
        try:
            path.mkdir()
        except (FileExistsError, FileNotFoundError):
            make_directory(path)  # by another command at this moment, whose it is to remove
        except OSError as error:
            raise _unusable(path, error) from error
        else:
            made.append(path)


@contextlib.contextmanager
def alone_in(folder: Path) -> Iterator[int]:
    """Refuse to work in a folder in which another command is writing.

    Yields:
        the descriptor that holds the lock.

    Raises:
        BadInputError: names the process.
    """
    try:
        with lock_on(folder) as lock:
            yield lock
    except HeldError as error:
        raise BadInputError(
            f"another command is writing here: {error}",
            where=str(folder),
            fix="wait until it has ended, or name another place with --out",
        ) from None


def _listed(summary: Path) -> list[str]:
    """File names that an earlier summary lists, in its own folder only."""
    try:
        files = json.loads(read_text(summary))["files"]
        names = files.values() if isinstance(files, dict) else files
        return [name for name in names if isinstance(name, str) and Path(name).name == name]
    except (BadInputError, ValueError, KeyError, TypeError, AttributeError):
        return []


def _unusable(folder: Path, error: OSError) -> BadInputError:
    reason = error.strerror or str(error)
    return BadInputError(
        f"cannot be made a directory: {reason}", where=str(folder), fix="choose another place with --out"
    )
