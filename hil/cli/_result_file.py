"""`result.json`: the result with the files that exist and what proves them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from hil.core.files import sha256_of, write_atomically
from hil.core.recording import Recording
from hil.core.result import RunResult

RESULT = "result.json"


def write_result(
    result: RunResult, recording: Recording, files: Mapping[str, str], folder: Path
) -> RunResult:
    """Write the result with the SHA-256 of each file; as it is written.

    Args:
        files: names of files in the folder by kind; one that does not exist has no hash.

    Raises:
        HilError: it cannot be written.
    """
    there = [name for name in dict.fromkeys(files.values()) if (folder / name).is_file()]
    proven = result.model_copy(
        update={
            "files": dict(files),
            "sha256": {name: sha256_of(folder / name) for name in there},
            "samples_sha256": recording.samples_sha256,
        }
    )
    write_atomically(folder / RESULT, text_of(proven))
    return proven


def text_of(result: RunResult) -> str:
    """The file's text."""
    return result.model_dump_json(indent=2) + "\n"
