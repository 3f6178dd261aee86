"""Options of the commands of models: identify, diagnose, simulate, explain."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hil.cli.completion import shipped_model
from hil.cli.options._shared import (
    Columns,
    JsonObject,
    ModelOption,
    OverwriteFile,
    OverwriteResult,
    SimulatedBenchName,
    found_model,
    found_targets,
)


@dataclass(frozen=True, kw_only=True)
class Identify:
    """Identify frequency responses, transfer functions with dead time, and the driveline chain."""

    recordings: Annotated[
        list[Path], typer.Argument(help="recordings (.mcap, .csv, .parquet, .mf4, .mat); several are merged")
    ]
    out: Annotated[
        Path | None,
        typer.Option("--out", help="directory for the results; default: out/identify-001 and so on"),
    ] = None
    segments: Annotated[
        list[str] | None,
        typer.Option("--segment", help="id of a segment to use; default: every chirp and multisine"),
    ] = None
    input_channel: Annotated[str, typer.Option("--input", help="excitation channel")] = "motor_torque_ref_nm"
    from_hz: Annotated[
        float | None,
        typer.Option(
            "--from-hz", min=1e-4, help="lowest frequency, Hz; default: 0.05 or the lowest one excited"
        ),
    ] = None
    to_hz: Annotated[
        float | None,
        typer.Option(
            "--to-hz", min=1e-3, help="highest frequency, Hz; default: 30 or the highest one excited"
        ),
    ] = None
    order: Annotated[
        int | None,
        typer.Option("--order", min=2, max=7, help="order of the denominator; default: chosen from the data"),
    ] = None
    gear_ratio: Annotated[
        float | None, typer.Option("--gear-ratio", min=1e-3, help="known gear ratio of the chain")
    ] = None
    method: Annotated[str, typer.Option("--method", help="auto, lpm, periodic, h1, h2 or hv")] = "auto"
    hold_ms: Annotated[
        float | None,
        typer.Option(
            "--hold-ms",
            min=0.0,
            help="zero-order hold of the input, ms; default: the sample time, at most 1 ms",
        ),
    ] = None
    columns: Columns = None
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="replace an earlier identification in --out")
    ] = False
    json_: Annotated[
        bool, typer.Option("--json", help="print identification.json on stdout, nothing else")
    ] = False


#: Options that take several values.
@dataclass(frozen=True, kw_only=True)
class Diagnose:
    """Find where a model and recordings disagree, identify the missing effect and add it to the model.

    Writes model.toml, diagnosis.json, report.html and report.pdf, all or none.
    """

    SEVERAL = ("--holdout",)

    recordings: Annotated[
        list[Path], typer.Argument(help="recordings to explain (.mcap, .csv, .parquet, .mf4, .mat)")
    ]
    model: Annotated[
        Path,
        typer.Option(
            "--model",
            help="model file to start from, or the name of a shipped model",
            callback=found_model,
            autocompletion=shipped_model(),
        ),
    ]
    out: Annotated[
        Path | None,
        typer.Option("--out", help="directory for the results; default: out/diagnose-001 and so on"),
    ] = None
    holdout: Annotated[
        list[Path] | None,
        typer.Option(
            "--holdout",
            help="recordings for validation, not used in any fit; all files up to the next option",
        ),
    ] = None
    noise: Annotated[
        list[str] | None,
        typer.Option(
            "--noise",
            metavar="CHANNEL=VALUE",
            help="standard deviation of a channel's samples, from its sensor's data sheet; repeatable",
        ),
    ] = None
    least: Annotated[
        list[str] | None,
        typer.Option(
            "--least",
            metavar="EFFECT=SIZE",
            help="smallest relevant size of an effect, in its own unit; repeatable",
        ),
    ] = None
    at_most: Annotated[
        float,
        typer.Option(
            "--at-most",
            metavar="MINUTES",
            help="processor time of the search; then the result so far is reported as unfinished",
        ),
    ] = 10.0
    columns: Columns = None
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace an earlier diagnosis in --out")] = (
        False
    )
    json_: Annotated[bool, typer.Option("--json", help="print diagnosis.json on stdout, nothing else")] = (
        False
    )


@dataclass(frozen=True, kw_only=True)
class Simulate:
    """Replay a recording's motor_torque_ref_nm through a model, from the recording's initial speeds.

    The model's outputs are written at the recording's time stamps.
    """

    model: ModelOption
    source: Annotated[Path, typer.Option("--input", help="recording with motor_torque_ref_nm")]
    out: Annotated[Path, typer.Option(help="file to write: .csv, .parquet, .mf4 or .mat")]
    columns: Columns = None
    overwrite: OverwriteFile = False
    as_json: JsonObject = False


@dataclass(frozen=True, kw_only=True)
class Explain:
    """Search for model changes, one effect or two, with which a predicted run reproduces target values.

    Writes targets.json, rival_1.toml and further models, separating_plan.yaml, report.html and report.pdf.
    Ctrl-C ends the search and keeps the results so far. Exit code: 0 a rival meets every condition, 1 none
    does.
    """

    targets: Annotated[
        Path | None,
        typer.Argument(
            help="targets file (TOML), or the name of a shipped one: paper_targets", callback=found_targets
        ),
    ] = None
    target: Annotated[
        list[str] | None,
        typer.Option("--target", metavar="ID=VALUE", help="target value of a criterion; may be repeated"),
    ] = None
    plan: Annotated[
        str | None, typer.Option(help="plan file or name; default: the targets file's, or acceptance")
    ] = None
    bench: SimulatedBenchName = ""
    model: Annotated[
        Path | None,
        typer.Option(
            help="model file, or the name of a shipped model; default: the bench's",
            callback=found_model,
            autocompletion=shipped_model(),
        ),
    ] = None
    among: Annotated[
        list[str] | None,
        typer.Option(
            "--among",
            metavar="ID",
            help="search only this effect, or 'controller'; may be repeated",
        ),
    ] = None
    evaluations: Annotated[int, typer.Option(min=20, max=100_000, help="number of predicted runs")] = 2000
    seed: Annotated[int, typer.Option(min=0, help="random seed of the starting points")] = 0
    out: Annotated[Path | None, typer.Option(help="directory for the results; default: out/explain-NNN")] = (
        None
    )
    overwrite: OverwriteResult = False
    as_json: Annotated[bool, typer.Option("--json", help="print targets.json on stdout, nothing else")] = (
        False
    )
