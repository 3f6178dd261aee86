"""`hil compare`: the same plan on several runs, side by side."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

from hil.analysis.comparison import ComparedRun, Comparison, compare, names_by_variables
from hil.cli._output import Show, console, plain_table, print_json, progress, to_json, warn_of_damage
from hil.cli._results_folder import refuse_missing, results_in
from hil.cli.commands.compare import Compare
from hil.core.errors import BadInputError
from hil.core.recording import read_recording
from hil.engine import RECORDING
from reports.comparison import comparison_html, comparison_pdf, lead, value_text
from test_plans import rejudged

SUMMARY, HTML, PDF = "comparison.json", "report.html", "report.pdf"


def carry_out(options: Compare) -> int:
    """Carry the command out; its exit code."""
    paths = [path / RECORDING if path.is_dir() else path for path in options.runs]
    for path in paths:
        refuse_missing(path)
    _refuse_twice(paths)
    names = (SUMMARY, HTML, PDF)
    with results_in(
        options.out, names, inputs=paths, overwrite=options.overwrite, default="compare", summary=SUMMARY
    ) as place:
        with progress("comparison") as show:
            found = compare(_read(options.runs, paths, show))
            show("writing the report")
            summary = _summary(found, options.runs)
            files = {
                HTML: comparison_html(found).encode(),
                PDF: comparison_pdf(found),
                SUMMARY: (to_json(summary) + "\n").encode(),
            }
        place.write(files, paths)
        if options.as_json:
            print_json(summary)
        else:
            _tell(found, place.folder / HTML)
    return 0


def _refuse_twice(paths: list[Path]) -> None:
    for path, times in Counter(path.resolve() for path in paths).items():
        if times > 1:
            raise BadInputError("is given twice", where=str(path), fix="name each run once")


def _read(runs: list[Path], paths: list[Path], show: Show) -> list[ComparedRun]:
    folders = _folders(runs)
    recordings, results = [], []
    for name, path in zip(folders, paths, strict=True):
        show(f"reading {name}")
        recording = read_recording(path, allow_missing=True)
        warn_of_damage([recording])
        result = rejudged(recording)
        if result is None:
            raise BadInputError(
                "is not a run of a plan: another tool made it",
                where=str(path),
                fix="compare runs of 'hil run'",
            )
        recordings.append(recording)
        results.append(result)
    names = names_by_variables(folders, results)
    return [ComparedRun(*run) for run in zip(names, recordings, results, strict=True)]


def _folders(runs: list[Path]) -> list[str]:
    """The last parts of the paths, as many as tell them apart."""
    resolved = [path.resolve() for path in runs]
    for parts in range(1, max(len(path.parts) for path in resolved) + 1):
        names = ["/".join(path.parts[-parts:]) for path in resolved]
        if len(set(names)) == len(names):
            return names
    return [str(path) for path in resolved]


def _summary(found: Comparison, runs: list[Path]) -> dict[str, Any]:
    return {
        "plan": found.runs[0].result.plan,
        "runs": [
            {
                "name": run.name,
                "path": str(path),
                "bench": run.result.bench,
                "variables": {one.name: one.value for one in run.result.variables},
                "started_at": run.recording.metadata.get("run", {}).get("started_at", ""),
                "verdict": run.result.verdict,
                "mean_distance": distance,
            }
            for run, path, distance in zip(found.runs, runs, found.distances, strict=True)
        ],
        "criteria": [
            {
                "id": row.id,
                "unit": row.unit,
                "values": row.values,
                "relative_difference": row.relative,
                "verdicts": row.verdicts,
            }
            for row in found.criteria
        ],
        "responses": [
            {"segment": row.segment, "channel": row.channel, "gaps": row.gaps, "ripples": row.ripples}
            for row in found.responses
        ],
        "notes": found.notes,
        "files": [SUMMARY, HTML, PDF],
    }


def _tell(found: Comparison, page: Path) -> None:
    table = plain_table()
    table.add_column("criterion", no_wrap=True)
    for run in found.runs:
        table.add_column(run.name, justify="right", no_wrap=True)
    table.add_column("unit", no_wrap=True)
    for row in found.criteria:
        cells = (value_text(row, index) for index in range(len(found.runs)))
        table.add_row(row.id, *cells, row.unit)
    out = console()
    out.print(table)
    for run in found.runs:
        if run.result.variables:
            values = ", ".join(map(str, run.result.variables))
            where = run.recording.source.parent
            out.print(f"{where}: {values}", highlight=False, markup=False, soft_wrap=True)
    out.print(f"\n{lead(found)}", highlight=False, markup=False)
    for note in found.notes:
        out.print(f"note: {note}", highlight=False, markup=False)
    out.print(f"report: {page}", highlight=False, markup=False, soft_wrap=True)
