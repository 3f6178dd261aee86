"""The outcome of a run in the words of `result.json` (docs/reference/result.md)."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

Verdict = Literal["pass", "fail", "error"]
SafeState = Literal["confirmed", "not_confirmed", "not_needed"]


class _Frozen(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class CriterionResult(_Frozen):
    """One criterion with its value; `reason` says why there is no value (verdict error)."""

    id: str
    value: float | None
    unit: str
    upper: float | None = None
    lower: float | None = None
    verdict: Verdict
    title: str = ""
    definition: str = ""
    reason: str = ""

    @property
    def margin(self) -> float | None:
        """Distance to the nearest limit, positive inside; None without a value or a limit."""
        if self.value is None:
            return None
        room = [self.upper - self.value] if self.upper is not None else []
        room += [self.value - self.lower] if self.lower is not None else []
        return min(room) if room else None


def verdict_of(criteria: Iterable[CriterionResult], *, stopped: bool) -> Verdict:
    """A run's verdict: error when something stopped it or a criterion has no value, else fail or pass."""
    verdicts = {criterion.verdict for criterion in criteria}
    if stopped or "error" in verdicts:
        return "error"
    return "fail" if "fail" in verdicts else "pass"


class Segment(_Frozen):
    """A named stretch of the recording; times are on the recording's `time_s`."""

    id: str
    kind: str = "step"
    start_s: float
    step_s: float
    end_s: float
    controller: str = ""
    initial_speed_km_h: float = 0.0
    load: Literal["vehicle", "speed"] = Field(
        "vehicle", description="what the dynos did: simulate the vehicle, or hold a speed"
    )
    reference_before: float = Field(0.0, description="value of the stepped quantity before the step")
    reference_after: float = Field(0.0, description="value of the stepped quantity after the step")


class RunResult(_Frozen):
    """What `result.json` holds."""

    verdict: Verdict
    plan: str
    bench: str
    real_time_factor: float
    bench_time_s: float
    safe_state: SafeState
    criteria: tuple[CriterionResult, ...] = ()
    segments: tuple[Segment, ...] = ()
    files: dict[str, str] = {}
    reason: str = ""
