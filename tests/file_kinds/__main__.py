"""`python -m tests.file_kinds [--write]`: reads every small file; makes docs/reference/file-kinds.md."""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Iterable
from pathlib import Path

from hil.core import can_logs
from hil.core.errors import HilError
from hil.core.recording import NOT_READ, READ, column_map, read_recording
from tests.file_kinds.cases import LOGS, TABLES, Case

PAGE = Path(__file__).parents[2] / "docs/reference/file-kinds.md"
_HEAD = """# Kinds of files

What is read, reported and refused of small files as other tools write them. Made by
`python -m tests.file_kinds --write`, which reads each; a test holds that the page is what it gives.
[Recordings of other tools](../how-to/other-tools.md) explains `--columns`, [replay](../how-to/replay.md)
logs.

"""


def page() -> str:
    """The page as it is now."""
    with tempfile.TemporaryDirectory() as folder:
        tables = [_row(case, Path(folder)) for case in TABLES]
        logs = [_row(case, Path(folder)) for case in LOGS]
    not_read = [f"| `{ending}` | {what} | {fix} |" for ending, (what, fix) in sorted(NOT_READ.items())]
    parts = [
        f"## Recordings\n\nRead are {_listed(READ)}.\n",
        *_table("| file | is | becomes | reported |", tables),
        f"\n## Logs of frames\n\nRead are {_listed(can_logs.READ)}.\n",
        *_table("| file | is | becomes | reported |", logs),
        "\n## Not read\n\nNamed with what would read it.\n",
        *_table("| file | is | what reads it |", not_read),
    ]
    return _HEAD + "\n".join(parts) + "\n"


def _listed(endings: Iterable[str]) -> str:
    return ", ".join(f"`{ending}`" for ending in endings)


def _table(head: str, lines: list[str]) -> list[str]:
    return [head, "|" + "---|" * (head.count("|") - 1), *lines]


def _row(case: Case, folder: Path) -> str:
    path = folder / case.name
    case.make(path)
    try:
        becomes, reported = _logged(path) if case.is_log else _read(path, case.columns)
    except HilError as error:
        becomes = "refused"
        reported = [line.strip() for line in str(error).splitlines()]
    words = "<br>".join(one.replace(f"{folder}/", "").replace("|", "\\|") for one in reported)
    options = "".join(f"<br>`--columns '{option}'`" for option in case.columns)
    return f"| `{case.name}` | {case.what}{options} | {becomes} | {words} |"


def _read(path: Path, columns: tuple[str, ...]) -> tuple[str, list[str]]:
    found = read_recording(path, columns=column_map(columns))
    step_ms = 1e3 * found.sample_time_s
    return f"{found.samples} samples, {step_ms:.4g} ms apart", found.notes


def _logged(path: Path) -> tuple[str, list[str]]:
    log = can_logs.read_can_log(path)
    firsts = [block["time_s"] for block in log.channels.values()]
    spans = max(float(times[-1] - times[0]) for times in firsts)
    frames = "1 frame" if log.count == 1 else f"{log.count} frames in {spans:.4g} s"
    return frames, list(log.remarks)


def main() -> None:
    """Print the page, or write it."""
    parser = argparse.ArgumentParser(prog="python -m tests.file_kinds")
    parser.add_argument("--write", action="store_true", help=f"write {PAGE.name}")
    if parser.parse_args().write:
        PAGE.write_text(page(), encoding="utf-8")
    else:
        print(page())


if __name__ == "__main__":
    main()
