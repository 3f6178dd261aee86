"""`hil identify`: from recordings to frequency responses, transfer functions and a driveline chain."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, get_args

import typer

from hil.analysis.frequency_response import Experiment, Method, experiments_of
from hil.analysis.identification import ORDERS, identify
from hil.analysis.outputs.identification import output_files, summary_of, text_of
from hil.analysis.plausible import refuse_same_data
from hil.cli._output import Show, print_json, progress, to_json, warn_of_damage
from hil.cli._place import refuse_missing, results_in
from hil.core.channels import INPUT
from hil.core.errors import BadInputError
from hil.core.recording import read_recording

_LEAST_SAMPLES = 100


def command(
    recordings: Annotated[
        list[Path], typer.Argument(help="Recordings (.mcap, .csv, .parquet, .mf4); several are merged.")
    ],
    out: Annotated[Path, typer.Option("--out", help="Directory for the results.")],
    segment: Annotated[
        list[str] | None,
        typer.Option("--segment", help="Id of a segment to use; default: every chirp and multisine."),
    ] = None,
    input_channel: Annotated[str, typer.Option("--input", help="Channel that excites.")] = INPUT,
    from_hz: Annotated[
        float | None,
        typer.Option("--from-hz", min=1e-4, help="Lowest frequency; default: 0.05 or what is excited."),
    ] = None,
    to_hz: Annotated[
        float | None,
        typer.Option("--to-hz", min=1e-3, help="Highest frequency; default: 30 or what is excited."),
    ] = None,
    order: Annotated[
        int | None,
        typer.Option(
            "--order", min=ORDERS[0], max=ORDERS[-1], help="Order of the denominator; default: by evidence."
        ),
    ] = None,
    gear_ratio: Annotated[
        float | None, typer.Option("--gear-ratio", min=1e-3, help="Known gear ratio of the chain.")
    ] = None,
    method: Annotated[str, typer.Option("--method", help="auto, lpm, periodic, h1, h2 or hv.")] = "auto",
    hold_ms: Annotated[
        float | None,
        typer.Option(
            "--hold-ms",
            min=0.0,
            help="How long the input keeps a value; default: the sample time, at most 1 ms.",
        ),
    ] = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Replace an earlier identification in --out.")
    ] = False,
    json_: Annotated[
        bool, typer.Option("--json", help="Print identification.json and nothing else.")
    ] = False,
) -> int:
    """Frequency responses, transfer functions with dead time, and the driveline chain of recordings."""
    chosen = _method(method)
    for path in recordings:
        refuse_missing(path)
    names = ("identification.json", "model.toml", "physical.toml", "frf.csv")
    with results_in(
        out, names, inputs=recordings, overwrite=overwrite, summary="identification.json"
    ) as place:
        with progress("identification") as show:
            experiments = _experiments(recordings, segment or [], input_channel, to_hz, hold_ms, show)
            found = identify(
                experiments,
                from_hz=from_hz,
                to_hz=to_hz,
                method=chosen,
                order=order,
                gear_ratio=gear_ratio,
                progress=show,
            )
            show("figures")
            files = output_files(found)
            summary = summary_of(found, experiments, sorted(files))
            files["identification.json"] = (to_json(summary) + "\n").encode()
        place.write(files, recordings)
    if json_:
        print_json(summary)
    else:
        print(text_of(found, summary, out))
    return 0


def _method(name: str) -> Method:
    methods: tuple[Method, ...] = get_args(Method)
    for known in methods:
        if name == known:
            return known
    raise BadInputError(f"--method is '{name}'", fix=f"one of: {', '.join(methods)}")


def _experiments(
    paths: list[Path],
    segments: list[str],
    input_channel: str,
    to_hz: float | None,
    hold_ms: float | None,
    show: Show,
) -> list[Experiment]:
    read = []
    for path in paths:
        show(f"reading {path.name}")
        read.append(read_recording(path, least_samples=_LEAST_SAMPLES))
    warn_of_damage(read)
    refuse_same_data(read)
    return [
        experiment
        for recording in read
        for experiment in experiments_of(
            recording,
            segments=segments,
            input_channel=input_channel,
            to_hz=to_hz or 30.0,
            hold_s=None if hold_ms is None else hold_ms / 1000,
        )
    ]
