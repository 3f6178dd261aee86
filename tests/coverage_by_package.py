"""`python -m tests.coverage_by_package`: coverage of each package, from what `make coverage` has measured."""

from __future__ import annotations

import sys
from collections import defaultdict
from pathlib import Path

from coverage import Coverage

#: Below hil, each room is a package of its own.
_ROOMS = {"hil": 2}


def package_of(file: str) -> str:
    """`hil.core` for `hil/core/recording/_table.py`; `drivers` for `drivers/rmcu/driver.py`."""
    parts = Path(file).with_suffix("").parts
    return ".".join(parts[: min(_ROOMS.get(parts[0], 1), len(parts) - 1)])


def main() -> int:
    """Print statements and share covered of each package, the least covered first."""
    coverage = Coverage()
    coverage.load()
    counts: dict[str, list[int]] = defaultdict(lambda: [0, 0])
    for file in coverage.get_data().measured_files():
        _, lines, _, missing, _ = coverage.analysis2(file)
        name = package_of(Path(file).relative_to(Path.cwd()).as_posix())
        counts[name][0] += len(lines)
        counts[name][1] += len(lines) - len(missing)
    counts = defaultdict(list, {name: count for name, count in counts.items() if count[0]})
    if not counts:
        print("nothing was measured: make coverage", file=sys.stderr)
        return 1
    counts["all"] = [sum(count[0] for count in counts.values()), sum(count[1] for count in counts.values())]
    rows = sorted((covered / statements, statements, name) for name, (statements, covered) in counts.items())
    print(f"{'package':24} {'statements':>10} {'covered':>8}")
    for share, statements, name in rows:
        print(f"{name:24} {statements:10} {100 * share:7.1f}%")
    return 0


if __name__ == "__main__":
    sys.exit(main())
