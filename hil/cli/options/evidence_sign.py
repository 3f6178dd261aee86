"""`hil evidence sign`: who approved a folder."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hil.cli.options._shared import JsonObject


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
