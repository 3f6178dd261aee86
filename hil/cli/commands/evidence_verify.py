"""`hil evidence verify`: that reports belong to their recordings, that nothing changed, and who signed."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from hil.app.results_folder import refuse_missing
from hil.app.verification import (
    RECORDINGS,
    REPORTS,
    Finding,
    of_recording,
    of_report,
    of_run,
    of_signatures,
)
from hil.cli.options.files import EvidenceVerify
from hil.cli.output import console, print_json
from hil.core.errors import BadInputError
from hil.core.files.signatures import public_key


def execute(options: EvidenceVerify) -> int:
    """Execute the command; its exit code."""
    for source in options.sources:
        refuse_missing(source)
        if not source.is_dir() and source.suffix.lower() not in (*RECORDINGS, *REPORTS):
            raise BadInputError(
                f"is not a folder, and its name ends in none of {', '.join((*RECORDINGS, *REPORTS))}",
                where=str(source),
                fix="give a run's folder, a report, a recording, or a service's folder",
            )
    if options.by is not None and not any(source.is_dir() for source in options.sources):
        raise BadInputError("--by goes with a folder", fix="give the folder that was signed")
    key = public_key(options.by) if options.by else None
    findings = list(dict.fromkeys(_findings(options.sources, key)))
    holds = all(finding.holds for finding in findings)
    if options.as_json:
        lines = [{"holds": f.holds, "file": str(f.file), "text": f.text} for f in findings]
        print_json({"verified": holds, "findings": lines})
        return 0 if holds else 1
    page = console()
    for finding in findings:
        text = f"{'ok ' if finding.holds else 'NOT'} {finding.file}: {finding.text}"
        page.print(text, highlight=False, markup=False, soft_wrap=True)
    page.print("\nverified" if holds else "\nNOT verified", highlight=False)
    return 0 if holds else 1


def _is_service(folder: Path) -> bool:
    """Whether it is the folder of a bench service (`hil serve --data`)."""
    return (folder / "service.id").is_file()


def _of_audit_log(folder: Path) -> Finding:
    """A service's folder: its audit log, row by row."""
    from hil.service.audit import checked

    found = checked(folder, os.environ.get("HIL_DATABASE", ""))
    words = found.problem or f"its {found.rows} rows form an unbroken chain up to row {found.head.id}"
    return Finding(not found.problem, folder, f"audit log: {words}")


def _findings(sources: list[Path], key: bytes | None) -> Iterator[Finding]:
    recordings = [path for path in sources if path.suffix.lower() in RECORDINGS and not path.is_dir()]
    for source in sources:
        if source.is_dir() and _is_service(source):
            yield _of_audit_log(source)
        elif source.is_dir():
            yield from of_run(source)
            yield from of_signatures(source, key)
        elif source in recordings:
            yield from of_recording(source)
        else:
            yield of_report(source, recordings)
