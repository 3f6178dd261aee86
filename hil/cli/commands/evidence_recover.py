"""`hil evidence recover`: a whole recording from what a crash left."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from hil.app.results_folder import alone_in, refuse_file, refuse_missing
from hil.app.run import NAMES
from hil.cli.options.files import EvidenceRecover
from hil.cli.output import console, print_json
from hil.core.errors import BadInputError
from hil.core.recording import Missing, Recording, missing_of, read_recording, recover_recording, run_of
from hil.core.result import RunResult
from hil.engine import RECORDING

_RECOVERED = ".recovered.mcap"


def execute(options: EvidenceRecover) -> int:
    """Execute the command; its exit code."""
    path = options.source / RECORDING if options.source.is_dir() else options.source
    refuse_missing(path)
    if path.suffix.lower() != ".mcap":
        raise BadInputError(
            "only recordings in MCAP can be recovered",
            where=str(path),
            fix="give the run's recording.mcap; other formats have no blocks to recover from",
        )
    target = options.out or path.with_name(path.stem + _RECOVERED)
    if target.suffix.lower() != ".mcap":
        raise BadInputError(
            "a recovered recording ends in .mcap",
            where=str(target),
            fix="give --out a name that ends in .mcap",
        )
    with alone_in(path.parent):
        found = read_recording(path, least_samples=0, allow_missing=True)
        if found.damage:
            refuse_file(target, [path], overwrite=options.overwrite)
            found = recover_recording(path, target)
    absent = [name for name in NAMES if not (path.parent / name).exists()] if options.source.is_dir() else []
    recovered = target if found.source == target else None
    if options.as_json:
        print_json(_as_data(path, recovered, found, absent))
    else:
        _tell(path, recovered, found, absent)
    return 0


def _as_data(path: Path, out: Path | None, found: Recording, absent: list[str]) -> dict[str, Any]:
    missing, run = missing_of(found), run_of(found)
    return {
        "recording": str(path),
        "recovered": str(out) if out else None,
        "samples": found.samples,
        "until_s": missing.until_s,
        "missing": {
            "seconds": missing.seconds,
            "gaps_s": [list(gap) for gap in missing.gaps_s],
            "channels": missing.channels,
            "files_inside": list(missing.files),
            "files_beside": absent,
            "segments": _cut_segments(run),
        },
        "damage": found.damage,
    }


def _tell(path: Path, out: Path | None, found: Recording, absent: list[str]) -> None:
    page = console()

    def say(text: str) -> None:
        page.print(text, highlight=False, markup=False, soft_wrap=True)

    missing = missing_of(found)
    if out is None:
        say(f"{path} is complete: {found.samples} samples, nothing to recover")
    else:
        say(f"{found.samples} samples until {missing.until_s:.3f} s: {out}")
    for sentence in (*found.damage, *_sentences(missing, run_of(found), absent)):
        say(f"  {sentence}")
    if out is not None or absent:
        say(f"hil report {out or path} makes the report")


def _sentences(missing: Missing, run: RunResult | None, absent: list[str]) -> list[str]:
    lines = [f"missing: {before:.3f} s to {after:.3f} s" for before, after in missing.gaps_s]
    lines += [f"missing: {share:.1%} of '{name}'" for name, share in missing.channels.items()]
    if missing.files:
        lines.append(f"missing in the recording: {', '.join(missing.files)}")
    if absent:
        lines.append(f"missing in the folder: {', '.join(absent)}")
    lines += [f"segment '{name}' is incomplete: it is not evaluated" for name in _cut_segments(run)]
    return lines if math.isfinite(missing.until_s) else ["no sample", *lines]


def _cut_segments(run: RunResult | None) -> list[str]:
    return [segment.id for segment in (run.segments if run else ()) if not segment.complete]
