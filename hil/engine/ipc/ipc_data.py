"""A run's request and outcome as messages between processes, and back."""

from __future__ import annotations

import tomllib
from pathlib import Path

from hil.core.model import model_from_dict, model_to_toml
from hil.engine.bench.bench_file import bench_from_dict
from hil.engine.ipc.ipc import RunOutcome, RunRequest
from hil.engine.ipc.ipc_messages import Ended, ErrorData, RunAsked
from test_plans import plan_from_text


def asked_of(request: RunRequest) -> RunAsked:
    """What passes of a request; its plan and its bench as the texts that they were read from."""
    return RunAsked(
        plan=request.plan.text,
        plan_source=str(request.plan.source),
        bench=request.bench.text,
        bench_source=str(request.bench.source),
        out=str(request.out),
        model=None if request.model is None else model_to_toml(request.model),
        operator=request.operator,
        operator_is_there=request.terminal is not None,
        confirmed_by=request.confirmed_by,
        hazard_confirmed_by=request.hazard_confirmed_by,
        accept_expired=request.accept_expired,
        replaces=tuple(map(str, request.replaces)),
        stops=str(request.stops or ""),
    )


def request_of(asked: RunAsked) -> RunRequest:
    """The request again, without what can be called; plan, bench and model are checked once more.

    Raises:
        BadInputError: one of them, or a file that it names, cannot be used.
    """
    plan_source, bench_source = Path(asked.plan_source), Path(asked.bench_source)
    model = None if asked.model is None else model_from_dict(tomllib.loads(asked.model), "--model")
    return RunRequest(
        plan=plan_from_text(asked.plan, asked.plan_source, plan_source.parent),
        bench=bench_from_dict(tomllib.loads(asked.bench), asked.bench, bench_source),
        out=Path(asked.out),
        model=model,
        operator=asked.operator,
        confirmed_by=asked.confirmed_by,
        hazard_confirmed_by=asked.hazard_confirmed_by,
        accept_expired=asked.accept_expired,
        replaces=tuple(map(Path, asked.replaces)),
        stops=Path(asked.stops) if asked.stops else None,
    )


def ended_of(outcome: RunOutcome) -> Ended:
    """What passes of an outcome: all of it."""
    return Ended(
        result=outcome.result,
        recording=str(outcome.recording),
        error=ErrorData.of(outcome.error) if outcome.error else None,
        largest=outcome.largest,
        made=outcome.made,
    )


def outcome_of(ended: Ended) -> RunOutcome:
    """The outcome again."""
    error = ended.error.as_error() if ended.error else None
    return RunOutcome(ended.result, Path(ended.recording), error, dict(ended.largest), ended.made)
