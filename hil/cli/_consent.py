"""One consent before a series of runs that nobody watches one by one."""

from __future__ import annotations

import sys

from hil.core.errors import BadInputError
from hil.core.printable import printable
from hil.engine import BenchFile
from hil.engine.prediction.envelope import Envelope
from hil.engine.run.preflight import Rehearsal
from test_plans import Plan

NOT_NEEDED = "not required: the bench is simulated"


def refuse_nobody(plan: Plan, bench: BenchFile, confirm: str) -> None:
    """Say before anything is computed that nobody is there to consent.

    Raises:
        BadInputError: no name, and no terminal to ask on.
    """
    if _needed(plan, bench) and not confirm.strip() and not sys.stdin.isatty():
        raise BadInputError(
            f"runs on '{bench.name}' need a person's consent, and there is no terminal to ask on",
            where="--confirm",
            fix="authorise them with --confirm 'YOUR NAME'; the report prints the name",
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
    print("Enter your name to authorise these runs:", file=sys.stderr)
    name = sys.stdin.readline().strip()
    if not name:
        raise BadInputError(
            "no consent was given",
            where=f"bench '{bench.name}'",
            fix="nothing has moved; run the command again to consent",
        )
    return name


def _needed(plan: Plan, bench: BenchFile) -> bool:
    return bench.simulation is None or bool(plan.hazardous)


def _question(plans: tuple[Plan, ...], bench: BenchFile, envelope: Envelope) -> str:
    names = ", ".join(dict.fromkeys(plan.name for plan in plans))
    lines = [f"Runs of {names} on {bench.name}, one after the other: {envelope.told()}."]
    lines.append(
        "Each run is predicted first. It is refused beyond these limits, and trips if it exceeds them."
    )
    for plan in plans:
        if plan.hazardous:
            why = f": {printable(plan.hazardous, 500)}" if isinstance(plan.hazardous, str) else ""
            lines.append(f"The plan {plan.name} is hazardous{why}")
        rehearsal = Rehearsal(bench)
        for step in (*plan.steps, *plan.finally_):
            step.carry_out(rehearsal)
        lines += [f"Confirmed in advance for each run of {plan.name}: {text}" for text in rehearsal.prompts]
    return "\n".join(lines)
