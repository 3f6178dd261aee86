"""What watched over a run: limits and interlocks with what was reached, holds, end steps."""

from __future__ import annotations

from hil.core.result import LimitResult, RunResult
from reports import labels
from reports.provenance import Fact

#: Responses that end or hold a run.
_SERIOUS = ("pause", "ramp_down", "trip", "hold", "emergency_stop")


def limit_facts(result: RunResult | None) -> tuple[Fact, ...]:
    """Each limit: what was reached, what is allowed, and which response was taken."""
    return tuple(
        Fact(limit.name, _reached(limit), _state(limit)) for limit in (result.limits if result else ())
    )


def hold_facts(result: RunResult | None) -> tuple[Fact, ...]:
    """When the run was held, why, what ended it; and what became of its end steps."""
    if result is None:
        return ()
    holds = [
        Fact(
            f"{labels.quantity(hold.start_s, 's', 1)} to {labels.quantity(hold.end_s, 's', 1)}",
            f"held: {hold.cause}; ended by: {hold.ended_by}",
        )
        for hold in result.holds
    ]
    return (*holds, *([Fact("End steps", result.end_steps)] if result.end_steps else []))


def _reached(limit: LimitResult) -> str:
    what = "" if limit.name == limit.channel else f"{limit.channel} "
    what = f"slope of {limit.channel} " if limit.of == "slope" else what
    ends = (limit.lowest, limit.highest)
    if ends == (None, None):
        span = "nothing known"
    else:
        low, high = (labels.DASH if end is None else labels.number(end, significant=4) for end in ends)
        span = f"{low} to {high} {_unit(limit)}"
    within = f"{labels.number(limit.persistence_samples, 0)} samples" if limit.persistence_samples else ""
    within = within or f"{labels.nominal(1e3 * (limit.persistence_s or 0.0))} ms"
    taken = f"; reached {limit.reached} times" if limit.reached else ""
    return f"{what}{span}; {_allowed(limit)}, for {within}: {limit.response.replace('_', ' ')}{taken}"


def _allowed(limit: LimitResult) -> str:
    if limit.below is not None and limit.above is not None and limit.below == -limit.above:
        return f"limit {labels.nominal(limit.above)} {_unit(limit)}"
    ends = [f"at least {labels.nominal(limit.below)}"] if limit.below is not None else []
    ends += [f"at most {labels.nominal(limit.above)}"] if limit.above is not None else []
    return f"{' and '.join(ends)} {_unit(limit)}"


def _unit(limit: LimitResult) -> str:
    """As the rest of a report writes it: DBC files have 'Nm'."""
    return limit.unit.replace("Nm", "N m")


def _state(limit: LimitResult) -> str:
    if not limit.reached:
        return "good"
    return "bad" if limit.response in _SERIOUS else ""
