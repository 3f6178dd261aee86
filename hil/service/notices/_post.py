"""What is still to be sent, kept in a file, so that the end of a service loses no notice."""

from __future__ import annotations

import datetime
import json
import logging
import time
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from hil.core.errors import HilError
from hil.core.files import read_text, write_atomically
from hil.service.notices._notice import Notice
from hil.service.notices._senders import send
from hil.service.notices._settings import NoticeSettings, Recipient

_FILE = "notices.json"
_FIRST_S, _LONGEST_S = 2.0, 600.0  # until it is sent again, twice as long each time
_GIVE_UP_S = 86_400.0
_MOST_WAITING = 1000
_MOST_BYTES = 20_000_000

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Seen:
    """What the service had seen of its runs: the last one, those that were open, those asked about."""

    last_run: int
    open_runs: frozenset[int]
    asked: frozenset[int]


@dataclass(frozen=True)
class _Waiting:
    """A notice on its way to one recipient."""

    notice: Notice
    to: Recipient
    since_s: float
    tries: int = 0
    next_s: float = 0.0


class Post:
    """Sends notices to all who want them, again and again for a day where a recipient does not answer.

    Attributes:
        seen: None before anything was kept.
        given_up: of each notice that was given up, the recipient's name and what was wrong.
    """

    def __init__(self, folder: Path, settings: NoticeSettings) -> None:
        self._path, self.settings = folder / _FILE, settings
        self._waiting: list[_Waiting] = []
        self.seen: Seen | None = None
        self.given_up: list[tuple[str, str]] = []
        self._read()

    def add(self, notice: Notice) -> None:
        """Have it sent to all who want it."""
        now = time.time()
        self._waiting += [
            _Waiting(notice, one, now)
            for one in self.settings.recipients
            if any(one.wants(event, notice.bench) for event in notice.events)
        ]
        for lost in self._waiting[:-_MOST_WAITING]:
            self._give_up(lost, "too many notices wait")
        self._waiting = self._waiting[-_MOST_WAITING:]

    def keep(self) -> None:
        """Write down what waits, and what was seen.

        Raises:
            HilError: the disk does not take it.
        """
        content = {
            "format": 1,
            "seen": _seen_as_json(self.seen),
            "waiting": [_as_json(one) for one in self._waiting],
        }
        write_atomically(self._path, json.dumps(content) + "\n")

    def send_due(self) -> bool:
        """Send what is due; whether anything changed."""
        now, left, changed = time.time(), [], False
        for one in self._waiting:
            if now < one.next_s:
                left.append(one)
                continue
            changed = True
            try:
                send(one.notice, one.to)
                logger.info("notice sent to %s: %s", one.to.name, one.notice.subject)
            except HilError as error:
                again = self._again(one, now, str(error))
                if again is not None:
                    left.append(again)
        self._waiting = left
        return changed

    def _again(self, one: _Waiting, now: float, why: str) -> _Waiting | None:
        if now - one.since_s > _GIVE_UP_S:
            self._give_up(one, why)
            return None
        if not one.tries:
            logger.warning("%s; it is sent again", why)
        wait_s = min(_FIRST_S * 2**one.tries, _LONGEST_S)
        return replace(one, tries=one.tries + 1, next_s=now + wait_s)

    def _give_up(self, one: _Waiting, why: str) -> None:
        logger.error("notice to %s given up (%s): %s", one.to.name, why, one.notice.subject)
        self.given_up.append((one.to.name, f"{one.notice.subject}: {why}"))

    def _read(self) -> None:
        if not self._path.is_file():
            return
        to = {one.name: one for one in self.settings.recipients}
        try:
            found = json.loads(read_text(self._path, _MOST_BYTES))
            self.seen = _seen_of(found["seen"])
            kept = [(one["to"], _notice_of(one["notice"]), float(one["since_s"])) for one in found["waiting"]]
        except (HilError, ValueError, KeyError, TypeError) as error:
            logger.error("%s cannot be read, notices in it are lost: %s", self._path, error)
            return
        self._waiting = [_Waiting(notice, to[name], since_s) for name, notice, since_s in kept if name in to]


def _seen_as_json(seen: Seen | None) -> dict[str, Any] | None:
    if seen is None:
        return None
    return {"last_run": seen.last_run, "open_runs": sorted(seen.open_runs), "asked": sorted(seen.asked)}


def _seen_of(kept: dict[str, Any] | None) -> Seen | None:
    if kept is None:
        return None
    return Seen(int(kept["last_run"]), frozenset(kept["open_runs"]), frozenset(kept["asked"]))


def _as_json(one: _Waiting) -> dict[str, Any]:
    notice = asdict(one.notice) | {"at": one.notice.at.isoformat()}
    return {"to": one.to.name, "notice": notice, "since_s": one.since_s}


def _notice_of(kept: dict[str, Any]) -> Notice:
    at = datetime.datetime.fromisoformat(kept["at"])
    return Notice(**{**kept, "events": tuple(kept["events"]), "at": at})
