"""One consent before a series of runs that nobody watches one by one."""

from __future__ import annotations

import sys

from hil.core.errors import BadInputError
from hil.core.printable import printable
from hil.engine import BenchFile
from hil.engine.envelope import Envelope
from hil.engine.preflight import Rehearsal
from test_plans import Plan

NOT_NEEDED = "none asked for: the bench is simulated"


def refuse_nobody(plan: Plan, bench: BenchFile, confirm: str) -> None:
    """Say before anything is computed that nobody is there to consent.

    Raises:
        BadInputError: no name, and no terminal to ask on.
    """
    if _needed(plan, bench) and not confirm.strip() and not sys.stdin.isatty():
        raise BadInputError(
            f"runs on '{bench.name}' need somebody's consent, and there is no terminal to ask on",
            where="--confirm",
            fix="who takes them upon them says so with --confirm 'their name'; the report prints it",
        )


def consent(plans: tuple[Plan, ...], bench: BenchFile, envelope: Envelope, confirm: str) -> str:
    """Who takes the runs within the envelope upon them, prompts of the plans included.

    Raises:
        BadInputError: nobody does.
    """
    if not any(_needed(plan, bench) for plan in plans):
        return ""
    print(_question(plans, bench, envelope), file=sys.stderr)
    if confirm.strip():
        return confirm.strip()
    print("Your name, to carry this out:", file=sys.stderr)
    name = sys.stdin.readline().strip()
    if not name:
        raise BadInputError("nobody consented", where=f"bench '{bench.name}'", fix="nothing was moved")
    return name


def _needed(plan: Plan, bench: BenchFile) -> bool:
    return bench.simulation is None or bool(plan.hazardous)


def _question(plans: tuple[Plan, ...], bench: BenchFile, envelope: Envelope) -> str:
    names = ", ".join(dict.fromkeys(plan.name for plan in plans))
    lines = [f"Runs of {names} on {bench.name}, one after the other: {envelope.told()}."]
    lines.append("Each is predicted first and refused beyond these; a run that leaves them trips.")
    for plan in plans:
        if plan.hazardous:
            why = f": {printable(plan.hazardous, 500)}" if isinstance(plan.hazardous, str) else ""
            lines.append(f"The plan {plan.name} is hazardous{why}")
        rehearsal = Rehearsal(bench)
        for step in (*plan.steps, *plan.finally_):
            step.carry_out(rehearsal)
        lines += [f"Taken for confirmed in each run of {plan.name}: {text}" for text in rehearsal.prompts]
    return "\n".join(lines)
