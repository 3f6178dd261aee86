"""Recordings given to a service: sent in pieces, gone on with where an earlier try ended."""

from __future__ import annotations

import hashlib
import re
import time
import urllib.parse
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeVar

from pydantic import ValidationError

from hil.api_schemas.agent import MOST_PIECE_BYTES, FileThere
from hil.api_schemas.api import Me
from hil.api_schemas.recording import (
    RecordingColumns,
    RecordingCurves,
    RecordingData,
    RecordingWanted,
    RecordingWhole,
)
from hil.client._requests import WITHIN_S, RefusedError, Requests, part
from hil.core.errors import BadInputError
from hil.core.files import open_regular

W = TypeVar("W", RecordingWanted, RecordingColumns)
_LOOK_S = 0.2
_AGAIN_S = 1.0
_GONE_S = 60.0
_SHOWN_WITHIN_S = 300.0
_READ = ("ready", "refused")


class RecordingRequests(Requests):
    """What can be asked of recordings that people give."""

    def recordings(self) -> list[RecordingData]:
        """All of them, newest first."""
        return self._several(RecordingData, "/recordings")

    def recording(self, recording: int) -> RecordingData:
        """One of them."""
        return self._one(RecordingData, "GET", f"/recordings/{recording}")

    def give_recording(
        self,
        path: Path,
        columns: Sequence[str] = (),
        progress: Callable[[float], None] = lambda share: None,
    ) -> RecordingData:
        """Give a recording, so that it can be identified and diagnosed; it is read by the service then.

        What has arrived of the same file in an earlier try is not sent again.

        Args:
            columns: which column of another tool's file is which channel: 'motor_speed_rad_s=n_EM, unit=rpm'.
            progress: called with the share that has arrived, 0 to 1.

        Raises:
            BadInputError: the file cannot be read, or the service cannot read it as a recording.
            BenchError: the service has not answered for a minute.
        """
        with open_regular(path) as file:
            size = path.stat().st_size
            one = self._begun(_wanted(path, size, columns))
            whole, at = hashlib.sha256(), 0
            while piece := file.read(MOST_PIECE_BYTES):
                whole.update(piece)
                if at + len(piece) > one.received:
                    self._send_piece(one.id, at, piece)
                at += len(piece)
                progress(at / size)
        ended = RecordingWhole(sha256=whole.hexdigest())
        found = self._one(RecordingData, "POST", f"/recordings/{one.id}/ending", ended)
        return self._read_there(found)

    def read_recording_anew(self, recording: int, columns: Sequence[str]) -> RecordingData:
        """Have one read with other columns as its channels.

        Raises:
            BadInputError: the service cannot read it so.
        """
        wanted = _valid(lambda: RecordingColumns(columns=list(columns)), f"recording {recording}")
        return self._read_there(self._one(RecordingData, "POST", f"/recordings/{recording}/check", wanted))

    def recording_curves(self, recording: int, channels: Sequence[str], most: int = 600) -> RecordingCurves:
        """Channels of one, each as lowest and highest value in `most` buckets."""
        query = urllib.parse.urlencode({"channel": list(channels), "most": most}, doseq=True)
        path = f"/recordings/{recording}/curves?{query}"
        return self._one(RecordingCurves, "GET", path, within_s=_SHOWN_WITHIN_S)

    def simulate_recording(self, recording: int, model: str, most: int = 600) -> RecordingCurves:
        """Outputs of a model that is driven by a recording's torque, with their gaps."""
        query = urllib.parse.urlencode({"model": model, "most": most})
        path = f"/recordings/{recording}/simulation?{query}"
        return self._one(RecordingCurves, "GET", path, within_s=_SHOWN_WITHIN_S)

    def remove_recording(self, recording: int) -> None:
        """Remove one with its files; studies of it stay."""
        self._done("DELETE", f"/recordings/{recording}")

    def download_of_recording(self, recording: int, name: str, path: Path) -> None:
        """Write a file of one, whole or not at all.

        Raises:
            BadInputError: the place cannot be written.
        """
        self._download(f"/recordings/{recording}/files/{part(name)}", path)

    def _begun(self, wanted: RecordingWanted) -> RecordingData:
        """One that an earlier try started, if it is the same as far as its name and size tell."""
        for one in self.recordings():
            same = (one.name, one.size, one.columns) == (wanted.name, wanted.size, wanted.columns)
            if same and one.state == "arriving" and not one.place and one.given_by == self._me():
                return one
        return self._one(RecordingData, "POST", "/recordings", wanted)

    def _me(self) -> str:
        with self._opened("GET", "/me", None, WITHIN_S) as answer:
            return Me.model_validate_json(answer.read()).name

    def _send_piece(self, recording: int, at: int, piece: bytes) -> None:
        """Send it until it is there; of one that is there in part, the rest."""
        until_s = time.monotonic() + _GONE_S
        there = at
        while there < at + len(piece):
            rest = piece[there - at :]
            query = f"at={there}&sha256={hashlib.sha256(rest).hexdigest()}"
            try:
                sent = self._one(FileThere, "PUT", f"/recordings/{recording}/content?{query}", rest)
                there = sent.size
                if there < at:
                    raise BadInputError("the service has lost what was sent", fix="give it again")
            except RefusedError as error:
                if error.status not in (429, 503) or time.monotonic() > until_s:
                    raise
                time.sleep(_AGAIN_S)

    def _read_there(self, one: RecordingData) -> RecordingData:
        while one.state not in _READ:
            time.sleep(_LOOK_S)
            one = self.recording(one.id)
        if one.state == "refused":
            raise BadInputError(one.reason, where=f"recording {one.id}")
        return one


def _wanted(path: Path, size: int, columns: Sequence[str]) -> RecordingWanted:
    """What is asked for a file, under a name that the service takes.

    Raises:
        BadInputError: the file is empty or too large, or a column is none that the service takes.
    """
    name = re.sub(r"^[^A-Za-z0-9]+", "", re.sub(r"[^A-Za-z0-9_.-]+", "-", path.name))[-100:]
    return _valid(
        lambda: RecordingWanted(name=name or "recording", size=size, columns=list(columns)), str(path)
    )


def _valid(made: Callable[[], W], where: str) -> W:
    try:
        return made()
    except ValidationError as error:
        first = error.errors()[0]
        what = f"{'.'.join(str(part) for part in first['loc'])}: {first['msg']}"
        fix = "give a file of 1 byte to 16 GB, and columns as 'CHANNEL=COLUMN'"
        raise BadInputError(what, where=where, fix=fix) from error
