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
    """List built-in plans, benches, models and effects, or the steps, metrics and devices for files.

    Steps, metrics and devices of installed packages stand there too.
    """

    what: Annotated[
        str,
        typer.Argument(
            help="plans, benches, models, effects, steps, metrics or devices",
            autocompletion=one_of("plans", "benches", "models", "effects", "steps", "metrics", "devices"),
        ),
    ]
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
