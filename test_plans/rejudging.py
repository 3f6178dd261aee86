"""A recorded run judged once more, by the plan that lies in its recording."""

from __future__ import annotations

from hil.core.recording import Recording, run_of
from hil.core.result import RunResult, verdict_of
from test_plans.judging import judge, not_checked
from test_plans.loading import plan_from_text


def rejudged(recording: Recording) -> RunResult | None:
    """The run's result with its criteria computed again; None for a recording without a run."""
    stored = run_of(recording)
    if stored is None:
        return None
    where = str(recording.source)
    text = recording.attachments.get("plan.yaml", b"").decode(errors="replace")
    plan = plan_from_text(text, f"{where}: plan.yaml", recording.source.parent, files_required=False)
    criteria = judge(plan, recording, stored.segments)
    reason = stored.reason
    if recording.damage:  # what is lost or changed somewhere proves nothing anywhere
        reason = "\n".join(
            [*([reason] if reason else []), f"the recording is damaged: {recording.damage[0]}"]
        )
    tripped = "" if recording.damage else stored.limit_tripped
    unchecked = not_checked(plan, recording, stored.segments)
    verdict = verdict_of(criteria, stopped=reason != "", limit_tripped=tripped)
    changes = {"criteria": criteria, "verdict": verdict, "reason": reason, "not_checked": unchecked}
    return stored.model_copy(update=changes)
