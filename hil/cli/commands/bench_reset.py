"""`hil bench reset`: a bench may be armed again after an emergency stop."""

from __future__ import annotations

from hil.cli.options.benches import BenchReset
from hil.cli.output import console, print_json
from hil.core.errors import BadInputError
from hil.core.errors.wording import is_printable, printable, refuse_long
from hil.engine import load_bench
from hil.engine.bench.bus_settings import within_process
from hil.engine.stop.emergency_stop import reset


def execute(options: BenchReset) -> int:
    """Execute the command; its exit code."""
    refuse_long(options.by, "--by")
    name = options.by.strip()
    if not name or not is_printable(name):
        raise BadInputError("--by is empty", fix="give the name of the person who checked that it is safe")
    file = load_bench(options.bench)
    stops = reset(file, name, options.data.resolve() if options.data is not None else None)
    if options.as_json:
        print_json({"bench": file.name, "reset": [stop.model_dump() for stop in stops]})
        return 0
    page = console()
    for stop in stops:
        text = f"reset by {name}: emergency stop of {stop.at}, by {stop.by}: {stop.why}"
        page.print(printable(text, 500), highlight=False, markup=False, soft_wrap=True)
    if not stops:
        page.print(f"no emergency stop is latched on {file.name}", highlight=False, markup=False)
        if within_process(file) and options.data is None:
            text = "its service keeps a simulated bench's stop: reset it there, or give its --data directory"
            page.print(text, highlight=False, markup=False)
    return 0
