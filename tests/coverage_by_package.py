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
        _, statements, _, missing, _ = coverage.analysis2(file)
        name = package_of(Path(file).relative_to(Path.cwd()).as_posix())
        counts[name][0] += len(statements)
        counts[name][1] += len(statements) - len(missing)
    counts = {name: count for name, count in counts.items() if count[0]}
    if not counts:
        print("nothing was measured: make coverage", file=sys.stderr)
        return 1
    counts["all"] = [sum(column) for column in zip(*counts.values(), strict=True)]
    print(f"{'package':24} {'statements':>10} {'covered':>8}")
    for name, (statements, covered) in sorted(
        counts.items(), key=lambda item: item[1][1] / max(item[1][0], 1)
    ):
        print(f"{name:24} {statements:10} {100 * covered / max(statements, 1):7.1f}%")
    return 0


if __name__ == "__main__":
    sys.exit(main())
