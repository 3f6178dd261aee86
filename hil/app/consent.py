"""One consent before a series of runs that no one watches one by one."""

from __future__ import annotations

from hil.app.feedback import Feedback
from hil.core.errors import BadInputError
from hil.core.errors.wording import printable
from hil.engine import BenchFile
from hil.engine.prediction.forecast import Envelope
from hil.engine.run.preflight import Rehearsal
from test_plans import Plan

_ENTER = "Enter your name to authorise these runs:"


def refuse_nobody(plan: Plan, bench: BenchFile, confirm: str, feedback: Feedback) -> None:
    """Refuse before anything is computed if no one is there to consent.

    Raises:
        BadInputError: no name, and no one to ask.
    """
    if _needed(plan, bench) and not confirm.strip() and not feedback.can_ask:
        raise BadInputError(
            f"runs on '{bench.name}' need a person's consent, and there is no terminal to ask on",
            where="--confirm",
            fix="authorise them with --confirm 'YOUR NAME'; the report prints the name",
        )


def consent(
    plans: tuple[Plan, ...], bench: BenchFile, envelope: Envelope, confirm: str, feedback: Feedback
) -> str:
    """Who takes the runs within the envelope upon them, prompts of the plans included; '' if no one has to.

    Raises:
        BadInputError: no one does.
    """
    if not any(_needed(plan, bench) for plan in plans):
        return ""
    given = confirm.strip()
    question = _question(plans, bench, envelope)
    name = feedback.ask_name(question if given else f"{question}\n{_ENTER}", given)
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
    lines = [f"Runs of {names} on {bench.name}, one after the other: {envelope.in_words()}."]
    lines.append(
        "Each run is predicted first. It is refused beyond these limits, and trips if it exceeds them."
    )
    for plan in plans:
        if plan.hazardous:
            why = f": {printable(plan.hazardous, 500)}" if isinstance(plan.hazardous, str) else ""
            lines.append(f"The plan {plan.name} is hazardous{why}")
        rehearsal = Rehearsal(bench)
        for step in (*plan.steps, *plan.finally_):
            step.execute(rehearsal)
        lines += [f"Confirmed in advance for each run of {plan.name}: {text}" for text in rehearsal.prompts]
    return "\n".join(lines)
