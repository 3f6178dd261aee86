"""`python -m tests.fuzz [--minutes N] [--only NAME] [--out DIR]`: damaged inputs at every parser, guided.

Each parser has its share of the time, in a process of its own. Inputs that break something are kept.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
from pathlib import Path

from tests.fuzz.targets import TARGETS

_TRIED = re.compile(r"(?:Done|number_of_executed_units:) (\d+)|^#(\d+)\s", re.MULTILINE)
_REACHED = re.compile(r"\bcov: (\d+)")
_STARTS_S = 120.0


def main() -> int:
    """Each parser in turn; 1 if anything was found."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz")
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--only", default="", help="parsers whose names contain this")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=Path("out/fuzz"))
    options = parser.parse_args()
    names = [name for name in TARGETS if options.only in name]
    share_s, found = max(1, int(options.minutes * 60.0 / max(1, len(names)))), 0
    for name in names:
        found += _guided(name, share_s, options.seed, options.out / name)
    print(f"{len(names)} parsers, {found} broken")
    return 1 if found else 0


def _guided(name: str, seconds: int, seed: int, folder: Path) -> int:
    folder.mkdir(parents=True, exist_ok=True)
    words = [sys.executable, "-m", "tests.fuzz.guided", name, str(seconds), str(seed), str(folder)]
    log = folder / "log.txt"
    with log.open("w", encoding="utf-8") as out:
        try:
            code = subprocess.run(
                words, stdout=out, stderr=subprocess.STDOUT, timeout=seconds + _STARTS_S, check=False
            ).returncode
        except subprocess.TimeoutExpired:
            code = -1
    said = log.read_text(encoding="utf-8", errors="replace")
    tried = max((int(a or b) for a, b in _TRIED.findall(said)), default=0)
    reached = max((int(n) for n in _REACHED.findall(said)), default=0)
    verdict = "nothing broken" if code == 0 else f"BROKEN (exit {code}), see {log}"
    print(f"{name:12} {tried:8} inputs in {seconds} s, {reached:5} edges reached: {verdict}", flush=True)
    return int(code != 0)


if __name__ == "__main__":
    sys.exit(main())
