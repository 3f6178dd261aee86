"""Which runs can be compared: those that carried out the same plan."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import yaml

from hil.core.errors import BadInputError
from hil.core.recording import Recording
from hil.core.result import RunResult

PLAN = "plan.yaml"
_CONTROLLERS = "controller/"
#: What makes two plans the same: what is done and what is judged, not what it is called.
_PARTS = ("steps", "finally", "criteria")


@dataclass(frozen=True)
class ComparedRun:
    """A run under the name that tables and figures give it; `result` has its criteria."""

    name: str
    recording: Recording
    result: RunResult


def refuse_other_plans(runs: Sequence[ComparedRun]) -> None:
    """Refuse runs of different plans: their criteria and segments are not of one kind.

    Raises:
        BadInputError: names both recordings, and whether steps or criteria differ.
    """
    first = _parts(runs[0].recording)
    for run in runs[1:]:
        other = _parts(run.recording)
        different = [part for part in _PARTS if other[part] != first[part]]
        if different:
            raise BadInputError(
                f"carried out another plan than {runs[0].recording.source}: "
                f"'{run.result.plan}', not '{runs[0].result.plan}' ({' and '.join(different)} differ)",
                where=str(run.recording.source),
                fix="compare runs of one plan",
            )


def controllers_that_differ(runs: Sequence[ComparedRun]) -> tuple[str, ...]:
    """Names of controllers that some run was given in another version than the first run."""
    first = _controllers(runs[0].recording)
    others = (_controllers(run.recording) for run in runs[1:])
    return tuple(
        sorted({name for other in others for name in first | other if first.get(name) != other.get(name)})
    )


def _controllers(recording: Recording) -> dict[str, bytes]:
    return {
        name.removeprefix(_CONTROLLERS): content
        for name, content in recording.attachments.items()
        if name.startswith(_CONTROLLERS)
    }


def _parts(recording: Recording) -> dict[str, Any]:
    try:
        content = yaml.safe_load(recording.attachments.get(PLAN, b"").decode())
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise BadInputError(
            f"its {PLAN} cannot be read", where=str(recording.source), fix="use another copy"
        ) from error
    if not isinstance(content, dict):
        raise BadInputError(
            f"has no {PLAN}", where=str(recording.source), fix="compare recordings of hil run"
        )
    return {part: content.get(part) for part in _PARTS}
