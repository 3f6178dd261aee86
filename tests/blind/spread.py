"""Cases spread over processes or machines as a campaign's simulations are, and gone on with after any end.

Only what hands batches out is shared with `hil campaign`: what a case is, what it is measured on and how
it is judged stays here.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import psutil

import hil
from hil.campaign import Batch, Carriers, Here, Progress, execute
from hil.core.files import make_directory, write_atomically
from hil.engine import StopRequest
from tests.blind.diagnosing import Diagnose
from tests.blind.run_case import run_case
from tests.blind.scoring import Score
from tests.blind.specs import Spec

Row = dict[str, Any]


@dataclass(frozen=True)
class Asked:
    """What is asked of each case, and who answers; `who` says it in words."""

    seed: int
    specs: tuple[Spec, ...]
    diagnose: Diagnose
    who: str
    keep: Path | None = None
    length: float = 1.0

    def rows(self, first: int, last: int) -> list[Row]:
        """Scores of cases, by number; made in whichever process."""
        return [self._row(number) for number in range(first, last + 1)]

    def failed(self, number: int, words: str) -> Row:
        """Of a case that ends whatever process carries it out."""
        spec = self.specs[number]
        score = Score(spec.group, spec.subject, spec.size, spec.turn, "", [], 0.0, "", [], False, words, 0.0)
        return {"simulation": number, "score": score.as_json()}

    def _row(self, number: int) -> Row:
        score = run_case(self.seed, self.specs[number], self.diagnose, self.keep, self.length)
        return {"simulation": number, "score": score.as_json()}

    @property
    def digest(self) -> str:
        """Of what makes a case what it is, but for its spec: other code may answer otherwise."""
        found = hashlib.sha256(f"{self.seed} {self.length!r} {self.who}".encode())
        for place in (Path(hil.__file__).parent, Path(__file__).parent):
            for path in sorted(place.rglob("*.py")):
                found.update(path.read_bytes())
        return found.hexdigest()


class CaseFiles:
    """Scores on disk, one file for each case, which appears whole."""

    def __init__(self, folder: Path, asked: Asked) -> None:
        self._folder, self._specs = folder, asked.specs
        self._digest = asked.digest
        make_directory(folder)

    def __iter__(self) -> Iterator[Batch]:
        yield from (Batch(number, number) for number in range(len(self._specs)))

    def holding(self, batch: Batch) -> Batch:
        """Each case is a batch."""
        return batch

    def missing(self) -> list[Batch]:
        """Cases without a score; one that other code gave, or of another seed, is none."""
        return [batch for batch in self if self.score(batch.first) is None]

    def write(self, batch: Batch, rows: list[Row]) -> None:
        """Put a case's score there."""
        content = {"digest": self._digest, **rows[0]}
        write_atomically(self._path(batch.first), json.dumps(content, indent=1) + "\n")

    def clear(self) -> None:
        """Let go of the scores of these cases, and of nothing else that lies there."""
        for number in range(len(self._specs)):
            self._path(number).unlink(missing_ok=True)

    def score(self, number: int) -> Score | None:
        """Of a case; None if it is not there."""
        with contextlib.suppress(OSError, ValueError, KeyError, TypeError):
            content = json.loads(self._path(number).read_text("utf-8"))
            if content["digest"] == self._digest:
                found = Score(**content["score"])
                found.names_right = [(share, right) for share, right in found.names_right]
                return found
        return None

    def _path(self, number: int) -> Path:
        return self._folder / f"{self._specs[number].key.replace('/', '-').replace(':', '-')}.json"


def spread(
    asked: Asked, folder: Path, jobs: int, scheduler: str, show: Callable[[Score, int], None]
) -> list[Score]:
    """Scores in the order of the specs: those that are in `folder`, and the others, from `jobs` processes.

    Ctrl-C awaits what is under way, a minute at most; a second one does not. What is there then is returned.

    Args:
        jobs: processes of this machine, 0 for this one alone; `scheduler`: address of one whose workers are
            used in their place, which must have this folder to import from.
        show: is told each score as it comes, and how many there are.
    """
    files, stop = CaseFiles(folder, asked), StopRequest()
    shown = {number for number in range(len(asked.specs)) if files.score(number) is not None}

    def tell(progress: Progress) -> None:
        for number in range(len(asked.specs)):
            score = files.score(number) if number not in shown else None
            if score is not None:
                shown.add(number)
                show(score, progress.done)

    begun: list[psutil.Process] = []
    with contextlib.ExitStack() as held:
        held.callback(_end, begun)  # a diagnosis would outlive the worker that began it
        held.enter_context(stop.by_signals())
        carriers = held.enter_context(_carriers(asked, jobs, scheduler))
        held.callback(lambda: begun.extend(psutil.Process().children(recursive=True)))
        held.enter_context(stop.telling(_at_once(stop)))
        execute(files, carriers, asked.failed, show=tell, stopped=lambda: stop.times > 0)
    return [score for number in range(len(asked.specs)) if (score := files.score(number)) is not None]


@contextlib.contextmanager
def _carriers(asked: Asked, jobs: int, scheduler: str) -> Iterator[Carriers]:
    if not scheduler and jobs == 0:
        yield Here(asked.rows)
        return
    from hil.campaign.on_dask import Workers  # half a second

    with Workers(asked.rows, jobs, scheduler) as workers:
        yield workers


def _end(begun: list[psutil.Process]) -> None:
    for process in begun:
        with contextlib.suppress(psutil.NoSuchProcess):
            process.kill()


def _at_once(stop: StopRequest) -> Callable[[], None]:
    def told() -> None:
        if stop.times > 1:
            raise KeyboardInterrupt

    return told
