"""Pictures that a plan shows with its prompts."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from test_plans.plan import Plan
from test_plans.steps import OperatorPrompt, Step

#: Of one picture: it is sent whole, and read from a few steps away.
MOST_PICTURE_BYTES = 250_000


def pictures_of(plan: Plan) -> tuple[str, ...]:
    """Names of all files that its prompts show, each once, also those of steps within steps."""
    return tuple(dict.fromkeys(_of((*plan.steps, *plan.finally_))))


def _of(steps: Iterable[Step]) -> Iterator[str]:
    for step in steps:
        if isinstance(step, OperatorPrompt) and step.picture:
            yield step.picture
        for key in step.nested:
            yield from _of(getattr(step, key))
