"""`hil run`: a plan on a bench, with its recording and reports."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hil.cli.completion import shipped_model
from hil.cli.options._shared import BenchName, Controllers, Operator, PlanName, found_model

SEVERAL = ("--controller", "--set")


@dataclass(frozen=True, kw_only=True)
class Run:
    """Run a test plan on a bench and write recording.mcap, result.json, report.html, report.pdf, junit.xml.

    Exit code: 0 passed, 1 a criterion failed, 2 bad input, 3 the bench failed, 130 interrupted.
    """

    plan: PlanName
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
