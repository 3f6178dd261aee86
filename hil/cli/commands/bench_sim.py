"""`hil bench sim`: the simulated bench in wall-clock time, until somebody ends it."""

from __future__ import annotations

import sys

from hil.app.interrupts import EXIT_CODE
from hil.app.results_folder import refuse_file
from hil.cli.inputs import named_values
from hil.cli.options.benches import BenchSim
from hil.cli.output import print_json
from hil.core.errors import BadInputError
from hil.core.errors.wording import printable
from hil.core.files import write_atomically
from hil.engine import StopRequest, load_bench
from hil.engine.commissioning.sim_bench import (
    HIDDEN_FORM,
    TRANSPORTS,
    Served,
    Serving,
    SimBenchRequest,
    serve,
)


def execute(options: BenchSim) -> int:
    """Execute the command; its exit code."""
    hide = tuple(options.hide or ())
    transport = options.transport
    interface = tuple(options.interface or ())
    if transport not in TRANSPORTS:
        raise BadInputError(
            f"--transport '{printable(transport)}' is not known", fix=f"one of {', '.join(TRANSPORTS)}"
        )
    checked = load_bench(options.bench)
    if options.bench_file is not None:
        refuse_file(options.bench_file, [checked.source], overwrite=True)
    stop = StopRequest()

    def ready(serving: Serving) -> None:
        if options.bench_file is not None:
            write_atomically(options.bench_file, serving.bench_file)
        if options.as_json:
            print_json(_as_json(checked.name, options.time_scale, serving))
        else:
            _print(checked.name, options.time_scale, serving)
        sys.stdout.flush()

    request = SimBenchRequest(
        bench=checked,
        time_scale=options.time_scale,
        seed=options.seed,
        hidden=named_values(hide, "--hide", form=HIDDEN_FORM),
        for_s=float("inf") if options.for_s is None else options.for_s,
        transport=transport,
        port=options.port,
        interfaces=interface,
        ready=ready,
        stop=stop,
    )
    with stop.by_signals():
        served = serve(request)
    print(_in_words(served), file=sys.stderr)
    return EXIT_CODE if stop.times else 0


def _print(name: str, time_scale: float, serving: Serving) -> None:
    pace = "in real time" if time_scale == 1.0 else f"at {time_scale:g} of real time"
    print(f"# The simulated bench '{name}' {pace}: its RMCU and dynos, served until Ctrl-C.")
    for hidden in serving.hidden:
        print(f"# Hidden effect: {hidden}")
    for device in serving.left_out:
        print(f"# Not served: devices.{device}")
    print("# Save the text below as a bench file for other commands: hil run acceptance --bench FILE.toml\n")
    print(serving.bench_file, end="")


def _as_json(name: str, time_scale: float, serving: Serving) -> dict[str, object]:
    return {
        "bench": name,
        "time_scale": time_scale,
        "buses": {bus: dict(table) for bus, table in serving.buses.items()},
        "hidden": list(serving.hidden),
        "not_served": list(serving.left_out),
        "bench_file": serving.bench_file,
    }


def _in_words(served: Served) -> str:
    pace = served.pace
    stalls = f"{pace.stalls} stalls of more than 5 ms in {pace.turns} turns"
    largest, left_out = 1e3 * pace.largest_stall_s, 1e3 * pace.left_out_s
    lines = [
        f"served {pace.bench_time_s:.1f} s of bench time; {stalls}, the largest {largest:.0f} ms; "
        f"{left_out:.0f} ms left out"
    ]
    for bus, (sent, received) in served.frames.items():
        lost = f", {served.lost[bus]} lost in transfer" if served.lost[bus] else ""
        lines.append(f"bus '{bus}': {sent} frames sent, {received} received{lost}")
    return "\n".join(lines)
