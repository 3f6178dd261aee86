"""A recorded run once more: its plan, bench, model, controllers and seed as they lie in its recording."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from hil.app.run_inputs import BENCH, PLAN, inputs_of, stored_paths
from hil.core.errors import BadInputError
from hil.core.files import make_directory, write_atomically
from hil.core.recording import Recording, read_recording, run_of
from hil.core.result import RunResult
from hil.core.runtime.versions import versions
from hil.engine import RECORDING, load_bench


@dataclass(frozen=True)
class EarlierRun:
    """What a recording says of its run, with its files in a folder.

    Attributes:
        bench: its bench file; None where the bench was hardware, whose file of today counts.
        values: of the plan's variables.
        changes: what differs today, a sentence each.
    """

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
        folder / PLAN,
        folder / BENCH if simulated else None,
        {one.name: one.value for one in result.variables},
        result,
        (*_newer_software(recording), *_changed_files(recording, files)),
    )


def compared_in_words(before: RunResult, now: RunResult) -> str:
    """How far the criteria of the run are from those of the earlier one, in a sentence."""
    values = {one.id: one.value for one in before.criteria}
    both = [
        (one, then)
        for one in now.criteria
        if (then := values.get(one.id)) is not None and one.value is not None
    ]
    if not both:
        return "no criterion has a value in both runs"
    moved = [(abs(one.value - then), one, then) for one, then in both if one.value != then]  # type: ignore[operator]
    if not moved:
        return f"all {len(both)} values are equal to those of the earlier run"
    share, (_, one, then) = max(
        ((distance / max(abs(then), 1e-300), (distance, one, then)) for distance, one, then in moved),
        key=lambda entry: entry[0],
    )
    return (
        f"{len(moved)} of {len(both)} values differ from the earlier run's, {one.id} most: "
        f"{then:.5g} then, {one.value:.5g} now ({100 * share:.2g} %)"
    )


def _newer_software(recording: Recording) -> list[str]:
    now, before = versions(), recording.metadata.get("versions", {})
    return [
        f"{name}: {then} then, {now[name]} now"
        for name, then in before.items()
        if now.get(name) and then and now[name] != then
    ]


def _changed_files(recording: Recording, files: dict[str, bytes]) -> list[str]:
    """Files that plan and bench named, where they lie today with another content."""
    found = []
    for path in stored_paths(recording, set(files)):
        try:
            content = Path(path).read_bytes()
        except OSError:
            continue
        if content != files[Path(path).name]:
            found.append(f"{path} has changed since; the recorded one is used")
    return found
