"""`hil tune`: from a plan's criteria to a controller."""

from __future__ import annotations

from pathlib import Path

from hil.analysis.diagnosis import Diagnosis
from hil.analysis.tuning import Tuning
from hil.app.interrupts import EXIT_CODE, INTERRUPTS
from hil.app.requests import SearchRequest, TuneRequest
from hil.app.result_file import Outcome
from hil.app.tuning.refinement import FirstRun, Refined
from hil.app.tuning.tune import Reports, tune_controller
from hil.cli.commands.diagnose import text_of as diagnosis_in_words
from hil.cli.inputs import named_numbers, request_of
from hil.cli.options.controllers import Tune
from hil.cli.output import TERMINAL, console, plain_table, print_json
from hil.cli.run_inputs import bench_or_own
from hil.cli.streams import complain
from hil.core.errors import BadInputError
from hil.core.errors.wording import share
from reports.outputs.tuning import REFINEMENT_HEAD, refinement_rows, refinement_verdict, text_of


def execute(options: Tune) -> int:
    """Execute the command; its exit code."""
    _refuse_together(options)
    bench = options.on_bench or bench_or_own(options.bench, options.plan)
    request = request_of(
        TuneRequest,
        options,
        search=request_of(SearchRequest, options, bench=bench, may_worsen=tuple(options.may_worsen or ())),
        refine=bool(options.on_bench),
        envelope=named_numbers(options.envelope or [], "--envelope"),
    )
    outcome = tune_controller(request, TERMINAL, _Prints(options))
    tuned = outcome.found
    if options.json_:
        print_json(outcome.summary)
    elif tuned.refined is not None:
        if tuned.first_run is not None:
            _print_first_run(tuned.first_run)
        _print_refined(tuned.refined)
    if tuned.stopped or tuned.exit_code == EXIT_CODE:
        INTERRUPTS.tell()
        return EXIT_CODE
    return tuned.exit_code


class _Prints(Reports):
    """Prints each stage when it has ended, unless one JSON object is wanted."""

    def __init__(self, options: Tune) -> None:
        self._options = options

    def found(self, tuning: Tuning, folder: Path, drawn: int) -> None:
        """The search's table."""
        if not self._options.json_:
            print(text_of(tuning, str(folder)))
        tried = len(tuning.trial.draws)
        if tried < drawn:
            text = f"stopped: compared on {tried} of {drawn} vehicles, those that the search had used"
            complain("note", text)

    def diagnosed(self, outcome: Outcome[Diagnosis]) -> None:
        """The diagnosis of the first run."""
        if not self._options.json_:
            print(diagnosis_in_words(outcome.found, outcome.folder))


def _refuse_together(options: Tune) -> None:
    """Raises:
    BadInputError: an option without the one that it goes with, or beside one that it does not go with.
    """
    if options.then_run:
        raise BadInputError(
            "--then-run is now a part of --on-bench",
            where="--then-run",
            fix="use --on-bench BENCH --runs 1, where BENCH is a bench file or its name, such as sim",
        )
    given = {"--runs": options.runs is not None, "--envelope": options.envelope, "--confirm": options.confirm}
    for option, is_given in given.items():
        if is_given and not options.on_bench:
            fix = "add --on-bench BENCH, or leave it out"
            raise BadInputError(f"{option} goes with --on-bench", where=option, fix=fix)
    if options.on_bench and options.bench:
        raise BadInputError("--bench does not go with --on-bench", where="--bench", fix="leave it out")


def _print_refined(refined: Refined) -> None:
    """The runs as a table."""
    page, table = console(), plain_table("\non the bench: worst margins")
    for number, name in enumerate(REFINEMENT_HEAD):
        table.add_column(name, justify="right" if number < 5 else "left", no_wrap=number < 6)
    for row in refinement_rows(refined.found):
        table.add_row(*row)
    page.print(table)
    page.print(refinement_verdict(refined.found), highlight=False, markup=False, soft_wrap=True)


def _print_first_run(ran: FirstRun) -> None:
    """Predicted and measured side by side."""
    page, table = console(), plain_table("\nfirst run: predicted and measured")
    table.add_column("criterion", no_wrap=True)
    for name in ("predicted", "measured", "difference"):
        table.add_column(name, justify="right")
    table.add_column("unit")
    table.add_column("of the limit", justify="right")
    table.add_column("run")
    for one in ran.confirmation.criteria:
        difference = "-" if one.difference is None else f"{one.difference:+.3g}"
        apart = share(one.apart, 2) if one.of_limit and one.apart is not None else "-"
        style = "bold red" if one in ran.confirmation.beyond else ""
        values = ("-" if v is None else f"{v:.5g}" for v in (one.predicted.value, one.measured.value))
        table.add_row(one.id, *values, difference, one.unit, apart, one.measured.verdict, style=style)
    page.print(table)
    page.print(_verdict(ran), highlight=False, markup=False, soft_wrap=True)


def _verdict(ran: FirstRun) -> str:
    allowed = f"{100 * ran.confirmation.allowed:g} % of the limit (of the larger value where there is none)"
    if ran.confirmation.agrees:
        return f"As predicted, within {allowed}."
    names = ", ".join(one.id for one in ran.confirmation.beyond)
    return (
        f"Deviation from the prediction by more than {allowed}: {names}. Diagnosis: {ran.diagnosed or 'none'}"
    )
