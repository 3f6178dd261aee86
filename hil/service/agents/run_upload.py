"""Uploads of run files by agents: in pieces, checked as wholes, then part of the history.

The recording grows in its place, as that of a run here does, so that it is shown live. Every other file is
hidden until all of the run are what its agent says that they are.
"""

from __future__ import annotations

import os
from functools import partial
from pathlib import Path

from hil.api_schemas.agent import MOST_FILE_BYTES, MOST_FILES, FileMade, RunEnding
from hil.api_schemas.api import RunData
from hil.core.errors import BenchError
from hil.core.files import make_directory, sha256_of
from hil.engine import RECORDING
from hil.execution.background import apart
from hil.execution.data_folder import folder_of
from hil.execution.run_process import result_in
from hil.service.store import RunStore


class RunUploads:
    """Takes files of runs that agents execute.

    Args:
        service: whose the files are from then on, by its name in the database.
        folder: where runs have their folders.
    """

    def __init__(self, service: str, runs: RunStore, folder: Path) -> None:
        self._service, self._runs, self._folder = service, runs, folder

    def run_of(self, run: int, agent: str) -> RunData | None:
        """A run, if it is an agent's and not delivered."""
        found = self._runs.of_service(run, agent)
        return found if found is not None and found.state in ("running", "interrupted") else None

    def add(self, run: int, name: str, at: int, piece: bytes) -> int:
        """Add a piece if it begins where the file ends; how much of the file is there.

        Raises:
            HilError: it cannot be written, or the file is too large.
        """
        path = self._place(run, name)
        try:
            make_directory(path.parent)
            size = path.stat().st_size if path.exists() else 0
            if at != size or not piece:
                return size
            if size + len(piece) > MOST_FILE_BYTES:
                raise BenchError(f"a file of more than {MOST_FILE_BYTES} bytes is not accepted", where=name)
            if not size and len(list(path.parent.iterdir())) > MOST_FILES:
                raise BenchError(f"more than {MOST_FILES} files of a run are not accepted", where=name)
            with path.open("ab") as file:
                file.write(piece)
            return size + len(piece)
        except OSError as error:
            raise BenchError(
                f"cannot be written: {error.strerror}",
                where=str(path),
                fix="free disk space; the agent sends it again",
            ) from error

    async def missing(self, run: int, made: list[FileMade]) -> list[str]:
        """Files that have not come whole; what is there otherwise than it was made is removed."""
        return [one.name for one in made if not await apart(partial(self._is_there, run, one))]

    def are_those(self, run: int, made: list[FileMade]) -> bool:
        """Whether a run that was delivered before left these files."""
        there = folder_of(self._folder, run)
        return bool(made) and all(_as_made(there / one.name, one) for one in made)

    def finish(self, run: RunData, agent: str, ending: RunEnding) -> bool:
        """Write down how a run ended whose files are all there; false if it is not the agent's any more."""
        if ending.state == "queued":
            return self._runs.put_back(run.id)
        for one in ending.files:
            path = self._place(run.id, one.name)
            if path.exists():
                path.replace(folder_of(self._folder, run.id) / one.name)
        return self._runs.delivered(
            run.id,
            agent,
            self._service,
            ending.state,
            exit_code=ending.exit_code,
            result=result_in(folder_of(self._folder, run.id)),
            reason=ending.reason,
            dut=ending.dut,
            ago_s=ending.ago_s,
        )

    def _is_there(self, run: int, made: FileMade) -> bool:
        path = self._place(run, made.name)
        if not path.exists() and _as_made(path.parent / made.name, made):
            return True
        if path.exists() and path.stat().st_size < made.size:
            return False
        if path.exists() and _as_made(path, made):
            with path.open("rb") as file:
                os.fsync(file.fileno())
            return True
        path.unlink(missing_ok=True)
        if not made.size:
            make_directory(path.parent)
            path.touch()
        return not made.size

    def _place(self, run: int, name: str) -> Path:
        return folder_of(self._folder, run) / (name if name == RECORDING else f".arriving-{name}")


def _as_made(path: Path, made: FileMade) -> bool:
    return path.is_file() and path.stat().st_size == made.size and sha256_of(path) == made.sha256
