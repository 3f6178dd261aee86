"""`hil identify`: from recordings to frequency responses, transfer functions and a driveline chain."""

from __future__ import annotations

from pathlib import Path
from typing import get_args

from hil.analysis.frequency_response import Experiment, Method, experiments_of
from hil.analysis.identification import identify
from hil.analysis.plausible import refuse_same_data
from hil.cli._output import Show, print_json, progress, to_json, warn, warn_of_damage
from hil.cli._results_folder import refuse_missing, results_in
from hil.cli.commands.identify import Identify
from hil.core.errors import BadInputError
from hil.core.recording import read_recording
from reports import HTML, PDF
from reports.identification_report import identification_page
from reports.origin import origin_of
from reports.outputs.identification import output_files, summary_of, text_of
from reports.parts import documents

_LEAST_SAMPLES = 100


def carry_out(options: Identify) -> int:
    """Carry the command out; its exit code."""
    from_hz = options.from_hz
    to_hz = options.to_hz
    chosen = _method(options.method)
    if from_hz is not None and to_hz is not None and from_hz >= to_hz:
        raise BadInputError(
            f"--from-hz {from_hz:g} is not below --to-hz {to_hz:g}", fix="give the lower frequency first"
        )
    for path in options.recordings:
        refuse_missing(path)
    names = ("identification.json", "model.toml", "physical.toml", "frf.csv", HTML, PDF)
    with results_in(
        options.out,
        names,
        inputs=options.recordings,
        overwrite=options.overwrite,
        default="identify",
        summary="identification.json",
    ) as place:
        with progress("identification") as show:
            experiments = _experiments(
                options.recordings, options.segment or [], options.input_channel, to_hz, options.hold_ms, show
            )
            found = identify(
                experiments,
                from_hz=from_hz,
                to_hz=to_hz,
                method=chosen,
                order=options.order,
                gear_ratio=options.gear_ratio,
                progress=show,
            )
            show("figures")
            files = output_files(found)
            summary = summary_of(found, experiments, sorted([*files, HTML, PDF]))
            title = ", ".join(path.name for path in options.recordings)
            page = identification_page(found, summary, title, origin_of({"recording": options.recordings}))
            files |= documents(page)
            files["identification.json"] = (to_json(summary) + "\n").encode()
        place.write(files, options.recordings)
    for doubt in found.doubts:
        warn(doubt)
    if options.json_:
        print_json(summary)
    else:
        print(text_of(found, summary, place.folder))
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
