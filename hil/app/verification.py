"""What of a folder, a report or a recording can be proven, and what does not match."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from hil.app.result_file import RESULT, text_of
from hil.core.errors import BadInputError
from hil.core.files import read_bytes, sha256_of
from hil.core.files.signatures import (
    BrokenSignatureError,
    fingerprint,
    hashes_of,
    read_signature,
    signatures_in,
)
from hil.core.recording import RUN, Recording, read_recording, run_of
from hil.core.result import RunResult
from hil.engine import RECORDING
from reports import HTML, PDF, claim_of
from reports.provenance import stored_files
from test_plans import rejudged

RECORDINGS = (".mcap", ".csv", ".parquet", ".mf4", ".mat")
#: Of a run whose process was lost, what only the command that watched it can say.
_ONLY_THERE = ("bench", "plan", "verdict", "safe_state", "reason", "emergency_stop", "end_steps")
REPORTS = (".html", ".pdf", ".json")


@dataclass(frozen=True)
class Finding:
    """Something about a file that was proven (`holds`), or that does not match or cannot be proven."""

    holds: bool
    file: Path
    text: str


def of_run(folder: Path) -> Iterator[Finding]:
    """A run's folder: its result, every file that it lists, the recording, the reports."""
    result_file = folder / RESULT
    try:
        text = read_bytes(result_file).decode()
        result = RunResult.model_validate_json(text)
    except (BadInputError, ValueError):
        there = "cannot be read: it was changed" if result_file.exists() else "is missing"
        yield Finding(False, result_file, f"{there}; no other file lists the files of the run")
        return
    yield from _listed(folder, result)
    recording = folder / result.files.get("recording", RECORDING)
    if recording.is_file():
        yield from of_recording(recording)
        yield _of_result(result_file, text, result, recording)
        for name in (HTML, PDF):
            if (folder / name).is_file():
                yield of_report(folder / name, [recording])


def _listed(folder: Path, result: RunResult) -> Iterator[Finding]:
    for name in dict.fromkeys((*result.files.values(), *result.sha256)):
        path = folder / name
        wanted = result.sha256.get(name)
        if Path(name).name != name:
            yield Finding(False, folder / RESULT, f"lists a file outside of this folder: {name}")
        elif not path.is_file():
            yield Finding(False, path, "is missing")
        elif wanted is None:
            yield Finding(False, path, f"has no hash in {RESULT}: made by an earlier version?")
        elif sha256_of(path) != wanted:
            yield Finding(False, path, f"does not match its SHA-256 in {RESULT}: one of the two was changed")
        else:
            yield Finding(True, path, f"matches its SHA-256 in {RESULT}")


def _of_result(file: Path, text: str, result: RunResult, path: Path) -> Finding:
    """Whether result.json says what the recording says of the run, to the byte."""
    try:
        recording = _read(path)
        lines = [run for run in (run_of(recording), rejudged(recording)) if run is not None]
    except BadInputError:
        return Finding(False, file, "cannot be compared with the recording")
    if text_of(result) != text:
        return Finding(False, file, "was changed after the run")
    if RUN not in recording.attachments and lines and recording.damage:
        return _of_a_lost_run(file, result, lines)
    if result.of_the_run not in [run.of_the_run for run in lines]:
        return Finding(False, file, "was changed: it contradicts the recording")
    if result.samples_sha256 != recording.samples_sha256:
        return Finding(False, file, "was changed: its hash of the samples is not the recording's")
    return Finding(True, file, "agrees with the recording")


def _of_a_lost_run(file: Path, result: RunResult, recorded: Iterable[RunResult]) -> Finding:
    """Of a run whose process was lost: the rest must be what the recording gives, as far as it goes."""
    only_there = {name: getattr(result, name) for name in _ONLY_THERE}
    if result.verdict != "error" or result.of_the_run not in [
        run.of_the_run.model_copy(update=only_there) for run in recorded
    ]:
        return Finding(
            False, file, "was changed: it contradicts what was recorded before the run was cut off"
        )
    text = "agrees with what was recorded before the run was cut off; how the run ended cannot be verified"
    return Finding(False, file, text)


def of_recording(path: Path) -> Iterator[Finding]:
    """Whether all that is checked in a recording agrees."""
    try:
        recording = _read(path)
    except BadInputError as error:
        yield Finding(False, path, f"cannot be read: {error.what}")
        return
    bad = [*recording.damage, *(note for note in recording.notes if "index" in note)]
    bad += [f"{f.name}: its hash {f.check}" for f in stored_files(recording) if f.state == "bad"]
    if not recording.samples_sha256 and not bad:
        bad = ["has no hash of its samples, so they cannot be verified"]
    for text in bad:
        yield Finding(False, path, text)
    if not bad:
        yield Finding(True, path, f"agrees with its own hashes ({recording.samples} samples)")


def of_report(report: Path, recordings: Iterable[Path]) -> Finding:
    """Whether a report was made from one of the recordings, or without any from the one beside it."""
    claim = claim_of(report)
    if claim is None:
        return Finding(False, report, "cannot be read, or does not name its recording")
    among = list(recordings) or [report.parent / Path(claim.recording).name]
    there = [path for path in among if path.is_file()]
    for path in there:
        if sha256_of(path) == claim.sha256:
            return Finding(True, report, f"was made from {path}")
    for path in there:
        if claim.samples_sha256 and _samples_of(path) == claim.samples_sha256:
            return Finding(
                True, report, f"was made from the samples of {path}, when they were in another file"
            )
    names = ", ".join(str(path) for path in among)
    what = "was made from another recording than" if there else "lacks its recording"
    return Finding(False, report, f"{what} {names}: from {claim.recording}, SHA-256 {claim.sha256}")


def of_signatures(folder: Path, by: bytes | None) -> Iterator[Finding]:
    """Every signature of a folder; with `by`, a raw public key, there must be one of it."""
    manifests = signatures_in(folder)
    files = hashes_of(folder) if manifests else {}
    keys = set()
    for manifest in manifests:
        try:
            signature = read_signature(manifest)
        except BrokenSignatureError as error:
            yield Finding(False, manifest, str(error))
            continue
        if not signature.intact:
            yield Finding(False, manifest, "does not match its signature: one of the two was changed")
            continue
        changed = list(_changes(signature.files, files))
        for name, text in changed:
            yield Finding(False, folder / name, f"{text} after {signature.signed_by} signed")
        if not changed:
            keys.add(signature.key)
            whose = "the given key" if signature.key == by else f"key {signature.fingerprint}"
            words = (
                f"{len(files)} files as {signature.signed_by} signed them at {signature.signed_at}, {whose}"
            )
            yield Finding(True, manifest, words)
    if by is not None and by not in keys:
        yield Finding(False, folder, f"has no valid signature of the key {fingerprint(by)}")


def _changes(signed: Mapping[str, str], now: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    for name in sorted(signed.keys() | now.keys()):
        if name not in now:
            yield name, "was removed"
        elif name not in signed:
            yield name, "was added"
        elif signed[name] != now[name]:
            yield name, "was changed"


def _samples_of(path: Path) -> str:
    try:
        recording = _read(path)
    except BadInputError:
        return ""
    return "" if recording.damage else recording.samples_sha256


def _read(path: Path) -> Recording:
    return read_recording(path, least_samples=0, allow_missing=True, any_replay=True)
