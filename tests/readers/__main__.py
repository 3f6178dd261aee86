"""Every check on a run and on reports of other commands; with --write it renews docs/reference/readers.md."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

from tests.readers.checks import checks, checks_of_reports
from tests.readers.tools import NotHereError

PAGE = Path(__file__).parents[2] / "docs/reference/readers.md"
HIL = Path(sys.executable).parent / "hil"
_HEAD = """# Read by other people's tools

What this software writes, and what others' readers and validators said of it. Made by `make readers`, of an
acceptance run on the simulated bench; the tools are installed by name, outside of the project (the command
line of MCAP is built from its source). `make test-slow` holds a short run against them where they can be had;
reports of other commands are made and held against them here alone.

| output | tool | version | result |
|---|---|---|---|
"""


def made(folder: Path, plan: str | Path) -> None:
    """A run and its exports."""
    commands: list[tuple[str | Path, ...]] = [("run", plan, "--out", folder, "--overwrite")]
    commands += [
        ("export", folder / "recording.mcap", "--out", folder / f"table.{e}")
        for e in ("csv", "parquet", "mf4")
    ]
    commands += [
        ("export", folder / "recording.mcap", "--frames", "--out", folder / f"frames.{e}")
        for e in ("blf", "asc", "log", "mf4")
    ]
    for command in commands:
        done = subprocess.run([HIL, *map(str, command)], capture_output=True, text=True, timeout=600)
        assert done.returncode == 0, done.stderr[-1000:]


def main() -> int:
    """Tell of every check; 1 if one of them failed."""
    rows, failed = [], 0
    with tempfile.TemporaryDirectory() as directory:
        folder = Path(directory)
        made(folder, "acceptance")
        for check in (*checks(), *checks_of_reports()):
            try:
                version, result = check.read(folder)
            except NotHereError as error:
                version, result = "–", f"not tried: {error}"
            except AssertionError as error:
                version, result, failed = "–", f"FAILED: {error}", failed + 1
            rows.append(f"| {check.output} | {check.tool} | {version} | {' '.join(result.split())[:200]} |")
            print(rows[-1], flush=True)
    if "--write" in sys.argv[1:]:
        PAGE.write_text(_HEAD + "\n".join(rows) + "\n", encoding="utf-8")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
