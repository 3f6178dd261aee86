"""`hil evidence sign`: who approved a folder."""

from __future__ import annotations

import datetime
import getpass
import sys

from hil.app.result_file import RESULT
from hil.app.results_folder import alone_in, refuse_missing
from hil.app.verification import of_run
from hil.cli.options.files import EvidenceSign
from hil.cli.output import console, print_json
from hil.cli.streams import complain
from hil.core.errors import BadInputError
from hil.core.errors.wording import refuse_long
from hil.core.files.signatures import fingerprint, private_key, sign_folder


def execute(options: EvidenceSign) -> int:
    """Execute the command; its exit code."""
    refuse_long(options.by, "--by")
    refuse_missing(options.folder)
    if not options.folder.is_dir():
        raise BadInputError("is not a directory", where=str(options.folder), fix="name a run's folder")
    if options.folder.resolve() in options.key.resolve().parents:
        raise BadInputError(
            "the private key is in the folder to be signed",
            where=str(options.key),
            fix="move the key to another folder",
        )
    signer = private_key(options.key, _passphrase)
    with alone_in(options.folder):
        wrong = (
            [f for f in of_run(options.folder) if not f.holds] if (options.folder / RESULT).exists() else []
        )
        if wrong:
            text = "\n  ".join(f"{finding.file}: {finding.text}" for finding in wrong)
            complain("error", f"not signed, because something does not match:\n  {text}")
            return 1
        name = options.by or getpass.getuser()
        at = datetime.datetime.now().astimezone().isoformat(timespec="seconds")
        manifest, signature = sign_folder(options.folder, signer, by=name, at=at, overwrite=options.overwrite)
    shown = fingerprint(signer.public_key().public_bytes_raw())
    if options.as_json:
        files = {"manifest": str(manifest), "signature": str(signature)}
        print_json({**files, "signed_by": name, "signed_at": at, "key": shown})
    else:
        text = f"signed by {name} with key {shown}: {manifest}, {signature.name}"
        console().print(text, highlight=False, markup=False, soft_wrap=True)
    return 0


def _passphrase() -> bytes:
    if not sys.stdin.isatty():
        raise BadInputError(
            "the key has a passphrase, and there is no terminal to ask on",
            where="--key",
            fix="run it from a terminal",
        )
    return getpass.getpass("Passphrase of the key: ").encode()
