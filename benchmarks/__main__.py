"""`make bench`: every figure that the documentation states, printed side by side in one run.

`python -m benchmarks [PART…]` runs some; with `--write` what each prints goes into its page, with date,
commit and load average. A page has no other figures: what is old can be seen and made anew.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

from benchmarks.pages import PAGES, ROOT, heading, with_figures

#: What `make bench` runs; the others of PAGES take longer.
USUAL = ("commands", "plant", "virtual_time", "transports", "check", "reports", "identification")


def main() -> int:
    """Run the parts that are asked for; 1 where one failed, whose page then stays as it is."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks")
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"of {', '.join(PAGES)}")
    parser.add_argument("--write", action="store_true", help="what is printed goes into the part's page, too")
    options = parser.parse_args()
    unknown = [part for part in options.parts if part not in PAGES]
    if unknown:
        parser.error(f"no part {', '.join(unknown)}; there are {', '.join(PAGES)}")
    return max([_run(part, write=options.write) for part in options.parts or USUAL])


def _run(part: str, *, write: bool) -> int:
    print(f"\n== {part.replace('_', ' ')} ==", flush=True)
    first = heading(part)
    with subprocess.Popen(
        [sys.executable, "-m", f"benchmarks.{part}"], cwd=ROOT, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        lines = []
        for line in process.stdout:
            print(line, end="", flush=True)
            lines.append(line)
    if process.returncode == 0 and write:
        page = Path(ROOT, PAGES[part])
        page.write_text(with_figures(page.read_text("utf-8"), part, first, "".join(lines)), "utf-8")
    return 1 if process.returncode else 0


if __name__ == "__main__":
    sys.exit(main())
