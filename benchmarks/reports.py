"""How long the reports of a 96 s acceptance run take: HTML, PDF and JUnit together."""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

from reports import write_reports
from tests.reports import synthetic

TARGET_S = 3.0


def main() -> None:
    """Print times and sizes; the first writing includes the import of Matplotlib, Typst and Jinja2."""
    recording, result = synthetic.recording(), synthetic.result()
    with tempfile.TemporaryDirectory() as directory:
        for name in ("first", "again"):
            wall, cpu = time.perf_counter(), time.process_time()
            written = write_reports(recording, result, Path(directory))
            wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
            print(f"reports, {name}: {wall:.2f} s ({cpu:.2f} s of one core); target {TARGET_S:g} s")
        for path in written.values():
            print(f"  {path.name}: {path.stat().st_size / 1e6:.2f} MB")


if __name__ == "__main__":
    main()
