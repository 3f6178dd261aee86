"""`hil evidence verify`: that report, recording and signature belong together, and that nothing changed."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hil.cli.options._shared import JsonObject


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
