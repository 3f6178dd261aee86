"""`python -m tests.wrong_controllers [--write] [--only TEXT] [PLAN…]`: tries wrong controllers."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable
from pathlib import Path

from tests.wrong_controllers.mutants import FACTORS
from tests.wrong_controllers.trying import MOVED_SHARE, Stage, Tried

PAGE = Path(__file__).parents[2] / "docs/reference/wrong-controllers.md"
PLANS = ("acceptance", "slip")
_HEAD = f"""# Wrong controllers

Made by `python -m tests.wrong_controllers --write`: each number of a shipped controller file times and
by 2, 5, 10 and 100, each path off, the files swapped, through the shipped plans that drive with a
controller, predicted on the simulated bench's model without noise. A mutant is *noticed* when a
criterion of the plan, a check of what any device must do, a limit of the bench or the file's own bounds
refuses it.

A mutant that nothing notices, and that moves T_s by more than {100 * MOVED_SHARE:.0f} % of the step
somewhere, stands in the second table of its plan, with the argument: T_s still reaches 90 % of the step
in time, ends within 10 % of it, and no line lasts. *Below 4 Hz* is the largest change of T_s without the
ripple of the wheel's third order, whose phase alone moves T_s by up to a third of the step.
"""


def main() -> int:
    """Try them, and write the page if asked to."""
    parser = argparse.ArgumentParser(prog="python -m tests.wrong_controllers")
    parser.add_argument("plans", nargs="*", default=list(PLANS))
    parser.add_argument("--write", action="store_true", help="write docs/reference/wrong-controllers.md")
    parser.add_argument("--only", default="", help="numbers whose path has this text")
    options = parser.parse_args()
    text = _HEAD
    for plan in options.plans:
        found = list(Stage.of(plan).all_mutants(options.only))
        text += "\n".join(
            ["", f"## {plan}", "", *_summary(found), "", *_noticed(found), "", *_argued(found), ""]
        )
        print("\n".join(_summary(found)), flush=True)
    if options.write and not options.only:
        PAGE.write_text(text, "utf-8")
    return 0


def _summary(found: list[Tried]) -> list[str]:
    moving = [one for one in found if one.moved > MOVED_SHARE]
    noticed = sum(bool(one.noticed) for one in moving)
    return [
        f"{len(found)} mutants; {len(moving)} move T_s by more than {100 * MOVED_SHARE:.0f} % of the step, "
        f"{noticed} of them are noticed, {len(moving) - noticed} are argued below."
    ]


def _noticed(found: Iterable[Tried]) -> list[str]:
    """A row a number: what notices it at each factor."""
    rows: dict[tuple[str, str], dict[str, str]] = {}
    for one in found:
        cell = f"✗ {_by(one.noticed[0])}" if one.noticed else f"{100 * one.moved:.0f} %"
        rows.setdefault((one.file, one.mutant.what), {})[one.mutant.change] = cell
    factors = [f"× {factor:g}" for factor in FACTORS]
    lines = [
        "✗: noticed, and by what first; else by how much it moves T_s.",
        "",
        f"| file | number | {' | '.join(factors)} | other |",
        f"|---|---|{'---|' * (len(factors) + 1)}",
    ]
    for (file, what), cells in rows.items():
        other = "; ".join(f"{change}: {cell}" for change, cell in cells.items() if change not in factors)
        lines.append(f"| {file} | `{what}` | {' | '.join(cells.get(f, '') for f in factors)} | {other} |")
    return lines


def _by(noticed: str) -> str:
    """What noticed it, without the segment."""
    if noticed.startswith("refused"):
        return "refused"
    return (
        noticed.split(".")[1] + (" (compared)" if ".below." in noticed else "") if "." in noticed else noticed
    )


def _argued(found: Iterable[Tried]) -> list[str]:
    lines = [
        "| file | number | change | moves T_s by | below 4 Hz | 90 % after, s | arrival, % | line, N m |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for one in found:
        if one.escapes:
            lines.append(
                f"| {one.file} | `{one.mutant.what}` | {one.mutant.change} | {100 * one.moved:.0f} % | "
                f"{100 * one.lasting:.0f} % | {one.response_s:.2f} | {one.arrival_percent:.1f} | "
                f"{one.line_nm:.1f} |"
            )
    return lines


if __name__ == "__main__":
    sys.exit(main())
