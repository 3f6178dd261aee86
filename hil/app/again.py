"""A recorded run once more: its plan, bench, model, controllers and seed as they lie in its recording."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

from hil.app.run_inputs import BENCH, PLAN, inputs_of
from hil.core.errors import BadInputError
from hil.core.files import make_directory, sha256_of, write_atomically
from hil.core.recording import SOURCE, Recording, read_recording, run_of
from hil.core.result import RunResult
from hil.core.runtime.versions import versions
from hil.engine import RECORDING, load_bench

#: Where the files of an earlier run are unpacked: they are gone when the new run has ended.
UNPACKED = "hil-again-"


@dataclass(frozen=True)
class EarlierRun:
    """What a recording says of its run, with its files in a folder.

    Attributes:
        bench: its bench file; None where the bench was hardware, whose file of today counts.
        values: of the plan's variables.
        changes: what differs today, and what is known of the earlier run's files, a sentence each.
        recording: where it was read from.
    """

    recording: Path
    plan: Path
    bench: Path | None
    values: dict[str, float]
    result: RunResult
    changes: tuple[str, ...]


def earlier_run(run: Path, folder: Path) -> EarlierRun:
    """Unpack the inputs of a run into a folder.

    Args:
        run: its folder, or its recording.

    Raises:
        BadInputError: there is no recording, or it does not hold what a run needs.
    """
    if not run.exists():
        raise BadInputError("there is no such run", where=str(run), fix="give a run's folder or recording")
    path = run / RECORDING if run.is_dir() else run
    recording = read_recording(path, least_samples=0, allow_missing=True)
    files = inputs_of(recording)
    result = run_of(recording)
    if result is None:
        raise BadInputError("says nothing of a run", where=str(path), fix="use a recording of hil run")
    make_directory(folder)
    for name, content in files.items():
        write_atomically(folder / name, content)
    simulated = load_bench(str(folder / BENCH)).simulation is not None
    return EarlierRun(
        path,
        folder / PLAN,
        folder / BENCH if simulated else None,
        {one.name: one.value for one in result.variables},
        result,
        (*_of_the_run(recording, result), *_newer_software(recording), *_changed_files(recording)),
    )


def compared_in_words(before: RunResult, now: RunResult) -> str:
    """How far the criteria of the run are from those of the earlier one, in a sentence."""
    values = {one.id: one.value for one in before.criteria}
    both = [
        (one.id, then, one.value)
        for one in now.criteria
        if (then := values.get(one.id)) is not None and one.value is not None
    ]
    if not both:
        return "no criterion has a value in both runs"
    moved = [(id_, then, value) for id_, then, value in both if value != then]
    if not moved:
        fewer = len(now.criteria) - len(both)
        rest = f"; {fewer} more have a value in one of the two alone, or in none" if fewer else ""
        return f"all {len(both)} values are equal to those of the earlier run{rest}"
    id_, then, value = max(moved, key=lambda one: abs(one[2] - one[1]) / abs(one[1]) if one[1] else math.inf)
    share = f" ({100 * abs(value - then) / abs(then):.2g} %)" if then else ""
    return (
        f"{len(moved)} of {len(both)} values differ from the earlier run's, {id_} most: "
        f"{then:.5g} then, {value:.5g} now{share}"
    )


def _of_the_run(recording: Recording, result: RunResult) -> list[str]:
    """What is wrong with the earlier run and its recording."""
    found = [f"the earlier recording: {sentence}" for sentence in recording.damage]
    if result.reason:
        found.append(f"the earlier run did not get to its end: {result.reason}")
    return found


def _newer_software(recording: Recording) -> list[str]:
    now, before = versions(), recording.metadata.get("versions", {})
    return [
        f"{name}: {then} then, {now[name]} now"
        for name, then in before.items()
        if now.get(name) and then and now[name] != then
    ]


def _changed_files(recording: Recording) -> list[str]:
    """Files of the run that lie today with another content where they lay then, or not at all."""
    sources = {
        Path(table["path"]): table.get("sha256")
        for name, table in sorted(recording.metadata.items())
        if name.startswith(SOURCE) and "path" in table
    }
    if not sources:
        return ["where the files of the earlier run lay was not recorded: they are not compared with today's"]
    if any(path.parent.name.startswith(UNPACKED) for path in sources):
        return ["the earlier run was one of --again itself: its files are not compared with today's"]
    return [sentence for path, digest in sources.items() if (sentence := _difference(path, digest))]


def _difference(path: Path, digest: str | None) -> str:
    """What is different of a file that had a SHA-256; '' if nothing is."""
    if not path.is_file():
        return f"{path} is not there any more; the recorded one is used"
    return f"{path} has changed since; the recorded one is used" if sha256_of(path) != digest else ""
