"""Options of the commands of runs: run, check, compare, report, export, replay."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hil.cli.completion import shipped_model
from hil.cli.options._shared import (
    BenchName,
    Columns,
    Controllers,
    JsonObject,
    Operator,
    OverwriteFile,
    PlanName,
    found_model,
)


@dataclass(frozen=True, kw_only=True)
class Run:
    """Run a test plan on a bench and write recording.mcap, result.json, report.html, report.pdf, junit.xml.

    Exit code: 0 passed, 1 a criterion failed, 2 bad input, 3 the bench failed, 130 interrupted.
    """

    SEVERAL = ("--controller", "--set")

    plan: PlanName = ""
    again: Annotated[
        Path | None,
        typer.Option(
            "--again",
            metavar="RUN",
            help="run directory or recording to run once more, with the plan, bench, model, controllers, "
            "values and seed that are stored in it; other options replace parts of it",
        ),
    ] = None
    bench: BenchName = ""
    out: Annotated[
        Path | None,
        typer.Option(help="directory for recording and reports; default: a new one, out/PLAN-001 and so on"),
    ] = None
    model: Annotated[
        Path | None,
        typer.Option(
            help="model file for the simulated bench, or the name of a shipped model",
            callback=found_model,
            autocompletion=shipped_model(),
        ),
    ] = None
    values: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="NAME=VALUE",
            help="value of a variable of the plan; NAME=VALUE,VALUE,… runs the plan for each value",
        ),
    ] = None
    repeat: Annotated[
        int, typer.Option(min=1, max=1000, help="number of runs, each in its own folder, with the spread")
    ] = 1
    controller: Controllers = None
    operator: Operator = ""
    yes: Annotated[
        str,
        typer.Option(
            "--yes",
            metavar="NAME",
            help="name of the person who confirms all operator prompts; printed in the report",
        ),
    ] = ""
    confirm: Annotated[
        str,
        typer.Option(
            "--confirm",
            metavar="NAME",
            help="name of the person who authorises a hazardous plan; printed in the report",
        ),
    ] = ""
    accept_expired: Annotated[
        str,
        typer.Option(
            metavar="'NAME: reason'",
            help="person who accepts expired sensor calibrations, and why; printed in the report",
        ),
    ] = ""
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace an earlier run in --out")] = False
    server: Annotated[
        str,
        typer.Option(metavar="URL", help="run it on a bench service (hil serve); HIL_TOKEN holds the token"),
    ] = ""
    show: Annotated[
        bool, typer.Option("--open", help="open the report of a single run in a browser, if one is installed")
    ] = False
    as_json: Annotated[bool, typer.Option("--json", help="print result.json on stdout, nothing else")] = False


@dataclass(frozen=True, kw_only=True)
class Check:
    """Validate a plan; predict its duration, peaks and criteria; compare them with the limits.

    Exit code: 0 the plan fits the bench, 1 a predicted peak exceeds a limit, 2 the plan cannot be run. A
    criterion that is predicted to fail is reported and does not change the exit code.
    """

    SEVERAL = ("--controller", "--set")

    plan: PlanName
    bench: BenchName = ""
    values: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="NAME=VALUE",
            help="value of a variable of the plan",
        ),
    ] = None
    controller: Controllers = None
    as_json: JsonObject = False


@dataclass(frozen=True, kw_only=True)
class Compare:
    """Compare runs of a plan or of its copies: criteria, step responses overlaid, spectra.

    Writes comparison.json, report.html and report.pdf, all or none. The first run is the reference. To see
    where an augmented model improves, give the measured run first, then the base model, then the augmented
    one. Criteria are computed again from the recordings.
    """

    runs: Annotated[
        list[Path],
        typer.Argument(metavar="DIR...", help="run directories or recordings; the first is the reference"),
    ]
    out: Annotated[Path | None, typer.Option(help="directory for the results; default: out/compare-NNN")] = (
        None
    )
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace an earlier comparison in --out")] = (
        False
    )
    as_json: Annotated[bool, typer.Option("--json", help="print comparison.json on stdout, nothing else")] = (
        False
    )


@dataclass(frozen=True, kw_only=True)
class Report:
    """Renew a report from its recording; compute the criteria again from the channels.

    Beside its own recording a report is renewed in place. A recording that another tool made gets a report
    of its channels, without verdict.
    """

    source: Annotated[
        Path, typer.Argument(metavar="DIR_OR_RECORDING", help="a run's directory, or a recording")
    ]
    out: Annotated[Path | None, typer.Option(help="where to write; default: beside the recording")] = None
    columns: Columns = None
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="replace the reports of another recording")
    ] = False
    as_json: Annotated[bool, typer.Option("--json", help="print the result on stdout, nothing else")] = False


@dataclass(frozen=True, kw_only=True)
class Export:
    """Write a recording's channels as CSV, Parquet, MDF4 or MAT, or its frames as BLF, ASC, candump or MDF4.

    With --inputs: the files with which the run can be executed again. What was lost is stated.

    A model, with its controller, is written as an FMI 2 co-simulation unit (FMU). The unit computes with this
    package: where it is used, Python with eaxle-hil has to be installed.
    """

    recording: Annotated[
        Path,
        typer.Argument(
            metavar="SOURCE",
            help="recording (.mcap, .csv, .parquet, .mf4, .mat); for an FMU, a model by file or name",
        ),
    ]
    out: Annotated[
        Path,
        typer.Option(
            help="file to write: .csv, .parquet, .mf4 or .mat; raw frames: .blf, .asc or .log (candump); "
            "a model: .fmu"
        ),
    ]
    controller: Annotated[
        Path | None,
        typer.Option(help="controller file for an FMU; without it the FMU's input is motor torque"),
    ] = None
    frames: Annotated[
        bool, typer.Option("--frames", help="write raw frames, not channels, to .mf4 (ASAM bus logging)")
    ] = False
    inputs: Annotated[
        bool,
        typer.Option(
            "--inputs", help="write plan, bench, model and controllers of the run to the folder --out"
        ),
    ] = False
    columns: Columns = None
    overwrite: OverwriteFile = False
    as_json: JsonObject = False


@dataclass(frozen=True, kw_only=True)
class Replay:
    """Decode CAN logs to a recording and report on it: recording.mcap, report.html, report.pdf.

    With --plan the criteria are judged: result.json and junit.xml too. Several logs are put on one clock by
    their absolute stamps. What is left out of a log is stated.
    """

    SEVERAL = ("--dbc", "--bus")

    logs: Annotated[
        list[Path],
        typer.Argument(
            metavar="LOG...", help=".mcap, .asc, .blf, .trc, .log (candump) or .mf4 (bus logging)"
        ),
    ]
    bench: Annotated[
        str | None,
        typer.Option(help="bench file, or the name of a shipped bench: its devices decode the frames"),
    ] = None
    dbc: Annotated[
        list[str] | None,
        typer.Option(
            metavar="[CHANNEL=]FILE",
            help="instead of --bench: DBC whose signals become channels; CHANNEL of the log, default: all",
        ),
    ] = None
    bus: Annotated[
        list[str] | None,
        typer.Option(
            metavar="BUS=CHANNEL", help="assign a channel of the log to a bus, where it is ambiguous"
        ),
    ] = None
    plan: Annotated[
        str | None, typer.Option(help="plan whose criteria are evaluated; needs the times of its segments")
    ] = None
    segments: Annotated[
        Path | None,
        typer.Option(help="the run's recording.mcap, or JSON with segments; default: those of a .mcap LOG"),
    ] = None
    stamps: Annotated[
        str,
        typer.Option(
            help="where stamps of a log go back: append (what follows was recorded later) or sort "
            "(it was written out of order); those of an ASC's trigger blocks: log (they count from the log's "
            "begin) or block (from each block's date); default: a log that leaves it open is refused"
        ),
    ] = ""
    shift: Annotated[
        list[str] | None,
        typer.Option(
            metavar="LOG=SECONDS",
            help="move the clock of one of several logs, as of a tool that wrote another time zone",
        ),
    ] = None
    columns: Columns = None
    operator: Annotated[
        str, typer.Option(help="name of the person who ran the bench; printed in the report")
    ] = ""
    out: Annotated[
        Path | None, typer.Option(help="directory; default: a new one, out/replay-001 and so on")
    ] = None
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace earlier results in --out")] = False
    as_json: Annotated[bool, typer.Option("--json", help="print one JSON object on stdout, nothing else")] = (
        False
    )
