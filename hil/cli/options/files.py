"""Options of the commands of files and evidence."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hil.cli.completion import one_of
from hil.cli.options._shared import JsonObject, OverwriteFile


@dataclass(frozen=True, kw_only=True)
class Init:
    """Make a folder with a plan, a simulated bench, its model and a controller.

    `hil check`, `hil run` and `pytest` work in it at once; its README.md says how. --samples adds the files
    for the how-to on diagnosis: axle.toml, chirp_high.csv, chirp_low.csv, steps.csv, multisine.csv.
    """

    folder: Annotated[Path, typer.Argument(metavar="DIR", help="a new folder, or an empty one")]
    samples: Annotated[
        bool,
        typer.Option("--samples", help="add recordings of an axle with backlash, to try a diagnosis"),
    ] = False
    as_json: JsonObject = False


@dataclass(frozen=True, kw_only=True)
class List:
    """List built-in plans, benches, models and effects, the steps, metrics and devices for files, or runs.

    Steps, metrics and devices of installed packages stand there too. `hil list runs DIR` finds the runs below
    a folder; the options choose and sort them.
    """

    SEVERAL = ("--plan", "--bench", "--verdict", "--tag")

    what: Annotated[
        str,
        typer.Argument(
            help="plans, benches, models, effects, steps, metrics, devices or runs",
            autocompletion=one_of(
                "plans", "benches", "models", "effects", "steps", "metrics", "devices", "runs"
            ),
        ),
    ]
    folder: Annotated[
        Path | None,
        typer.Argument(metavar="[DIR]", help="with runs: folder that they lie below; default: out"),
    ] = None
    plan: Annotated[list[str] | None, typer.Option(metavar="NAME", help="with runs: of this plan")] = None
    bench: Annotated[list[str] | None, typer.Option(metavar="NAME", help="with runs: on this bench")] = None
    verdict: Annotated[
        list[str] | None,
        typer.Option(metavar="VERDICT", help="with runs: pass, fail, done or error"),
    ] = None
    tag: Annotated[
        list[str] | None, typer.Option(metavar="TAG", help="with runs of a --server: that has this tag")
    ] = None
    since: Annotated[
        str,
        typer.Option(
            metavar="DATE",
            help="with runs: started then or later, such as 2026-11-28T06:00, in local time without a zone",
        ),
    ] = ""
    until: Annotated[str, typer.Option(metavar="DATE", help="with runs: started before")] = ""
    criterion: Annotated[
        str, typer.Option(metavar="ID", help="with runs: that have this criterion, with its value")
    ] = ""
    above: Annotated[
        float | None, typer.Option(metavar="VALUE", help="with runs: the criterion's value is at least this")
    ] = None
    below: Annotated[
        float | None, typer.Option(metavar="VALUE", help="with runs: the criterion's value is at most this")
    ] = None
    sort: Annotated[
        str,
        typer.Option(metavar="KEY", help="with runs: by run, plan, bench, verdict, started, margin or value"),
    ] = "started"
    rising: Annotated[bool, typer.Option("--rising", help="with runs: smallest, first or oldest on top")] = (
        False
    )
    most: Annotated[int | None, typer.Option(min=1, help="with runs: number of runs shown at most")] = None
    server: Annotated[
        str,
        typer.Option(
            metavar="URL", help="with runs: those of a bench service (hil serve); HIL_TOKEN holds the token"
        ),
    ] = ""
    as_json: JsonObject = False


@dataclass(frozen=True, kw_only=True)
class Schema:
    """Print the JSON schema of plan, bench, model, controller or campaign files.

    Editors complete and check with it: yaml-language-server for plans and campaigns, Taplo (Even Better
    TOML) for the rest.
    """

    kind: Annotated[
        str,
        typer.Argument(
            help="kind of file: plan, bench, model, controller or campaign",
            autocompletion=one_of("plan", "bench", "model", "controller", "campaign"),
        ),
    ] = "plan"


@dataclass(frozen=True, kw_only=True)
class EvidenceVerify:
    """Verify that reports match their recording and that no file changed; check signatures.

    In the directory of a bench service (`hil serve --data`) it verifies the audit log: no row was changed,
    inserted or removed.

    A report is compared with the recordings given, or else with the one beside it. Exit code: 0 everything
    is verified, 1 something does not match or cannot be verified.
    """

    sources: Annotated[
        list[Path],
        typer.Argument(
            metavar="DIR|REPORT|RECORDING...", help="files that belong together; or a service's directory"
        ),
    ]
    by: Annotated[
        Path | None,
        typer.Option(metavar="PUBLIC_KEY", help="public key of the required signer: NAME.pub, or PEM"),
    ] = None
    as_json: JsonObject = False


@dataclass(frozen=True, kw_only=True)
class EvidenceSign:
    """Sign every file of a run's directory; write two files there, which hil evidence verify --by checks.

    A directory that does not verify is not signed (exit code 1). Several persons can sign.
    """

    folder: Annotated[Path, typer.Argument(metavar="DIR", help="a run's directory")]
    key: Annotated[
        Path,
        typer.Option(help="your Ed25519 private key, of OpenSSH or PEM; 'ssh-keygen -t ed25519' makes one"),
    ]
    by: Annotated[
        str, typer.Option(metavar="NAME", help="name of the person who signs; default: the user's name")
    ] = ""
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="replace an earlier signature of this key")
    ] = False
    as_json: JsonObject = False


@dataclass(frozen=True, kw_only=True)
class EvidenceRecover:
    """Recover a recording after a crash, a power cut or a disk fault, and list what is missing.

    The input is never written over. A recording that is whole is left as it is. `hil report` makes the report
    of the recovered recording; it says that the run was cut.
    """

    source: Annotated[
        Path, typer.Argument(metavar="RECORDING_OR_DIR", help="a recording (.mcap), or a run's directory")
    ]
    out: Annotated[
        Path | None, typer.Option(help="file to write: .mcap; default: NAME.recovered.mcap beside it")
    ] = None
    overwrite: OverwriteFile = False
    as_json: JsonObject = False
