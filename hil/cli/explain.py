"""`hil explain`: what would bring a predicted run to target figures."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from hil.analysis.target_search import (
    SEPARATING,
    CarryOut,
    Explanation,
    Predicted,
    explain,
    files_of,
    model_name,
    read_targets,
)
from hil.cli._default_bench import bench_or_own
from hil.cli._interrupts import EXIT_CODE, INTERRUPTS
from hil.cli._named_values import named_numbers
from hil.cli._output import console, plain_table, print_json, progress, to_json
from hil.cli._results_folder import results_in
from hil.cli.commands.explain import Explain
from hil.core.errors import BadInputError
from hil.core.file_format import FORMAT
from hil.core.model import Model, load_model
from hil.engine import BenchFile, StopRequest, load_bench
from hil.engine.prediction.prediction import predict
from hil.plant import refuse_too_stiff
from reports.target_search import caution, explanation_html, explanation_pdf
from test_plans import Plan

SUMMARY, HTML, PDF = "targets.json", "report.html", "report.pdf"


def carry_out(options: Explain) -> int:
    """Carry the command out; its exit code."""
    target = options.target or []
    among = options.among or []
    wanted, file = (
        read_targets(options.targets, options.plan, named_numbers(target, "--target")),
        load_bench(bench_or_own(options.bench, options.plan)),
    )
    if file.simulation is None:
        raise BadInputError(
            "is not a simulated bench", where=str(file.source), fix="give a bench file with [simulation]"
        )
    source = options.model or file.simulation.model
    base = load_model(source)
    refuse_too_stiff(base)
    inputs = [path for path in (options.targets, source, file.source) if path is not None]
    names = (SUMMARY, HTML, PDF, SEPARATING, model_name(1))
    stop = StopRequest()
    with results_in(
        options.out, names, inputs=inputs, overwrite=options.overwrite, default="explain", summary=SUMMARY
    ) as place:
        with progress("explain") as show, stop.by_signals():
            found = explain(
                base,
                _predicted_on(file),
                wanted,
                evaluations=options.evaluations,
                among=among,
                seed=options.seed,
                show=lambda text, share: show(text, share),
                stopped=lambda: stop.times > 0,
            )
        files = files_of(found)
        summary = _summary(found, options.seed, sorted({*files, SUMMARY, HTML, PDF}))
        files |= {
            HTML: explanation_html(found).encode(),
            PDF: explanation_pdf(found),
            SUMMARY: (to_json(summary) + "\n").encode(),
        }
        place.write(files, inputs)
        if options.as_json:
            print_json(summary)
        else:
            _tell(found, place.folder)
    if found.interrupted:
        INTERRUPTS.tell()
        return EXIT_CODE
    return 0 if found.reached else 1


def _predicted_on(file: BenchFile) -> CarryOut:
    """Predictions on a bench whose RMCU keeps some parameters more."""
    assert file.simulation is not None
    simulation = file.simulation

    def carry_out(plan: Plan, model: Model, held: Mapping[str, float]) -> Predicted:
        kept = simulation.model_copy(update={"rmcu": {**simulation.rmcu, **held}})
        return predict(plan, file.model_copy(update={"simulation": kept}), model)

    return carry_out


def _summary(found: Explanation, seed: int, files: list[str]) -> dict[str, Any]:
    return {
        "plan": found.targets.plan.name,
        "targets": dict(found.targets.values),
        "tolerance": found.targets.tolerance,
        "reached": found.reached,
        "format": FORMAT,
        "verdict": found.verdict,
        "caution": caution(found),
        "rivals": [rival.as_json(model_name(n)) for n, rival in enumerate(found.rivals, 1)],
        "base": found.base.as_json(""),
        "separating": None
        if found.separating is None
        else {"plan": SEPARATING, "words": found.separating.words, "noise_levels": found.separating.level},
        "searched": found.searched,
        "evaluations": found.evaluations,
        "seed": seed,
        "interrupted": found.interrupted,
        "files": files,
    }


def _tell(found: Explanation, folder: Path) -> None:
    out = console()
    table = plain_table()
    table.add_column("rival")
    for name in found.targets.values:
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column("missed", justify="right", no_wrap=True)
    table.add_row("target", *(f"{value:.4g}" for value in found.targets.values.values()), "")
    for name, rival in (("base model", found.base), *((r.name, r) for r in found.rivals)):
        figures = (rival.outcome.figures[n] for n in found.targets.values)
        cells = ("-" if figure is None else f"{figure:.4g}" for figure in figures)
        table.add_row(name, *cells, f"{len(rival.missed)} of {len(rival.conditions)}")
    out.print(table)
    for text in ("", found.verdict, caution(found)):
        out.print(text, highlight=False, markup=False)
    out.print(f"report: {folder / HTML}", highlight=False, markup=False, soft_wrap=True)
