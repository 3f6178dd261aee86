"""What a run stores in its recording beside what was measured."""

from __future__ import annotations

import datetime

from hil.core.model import model_to_toml
from hil.core.recording import ACCEPTED_EXPIRY
from hil.core.result import AcceptedExpiry, RunResult
from hil.engine.bench import Bench
from hil.engine.border import RunRequest
from hil.engine.conductor import BenchConductor
from hil.engine.provenance import hashes, versions
from hil.engine.recorder import Recorder


def store_inputs(recorder: Recorder, request: RunRequest, bench: Bench) -> None:
    """What is known at the start stands at the start: also a recording that is cut off has it."""
    writer = recorder.writer
    for name, content in _inputs(request, bench).items():
        writer.attach(name, content)
    started_at = datetime.datetime.now(datetime.UTC)
    confirmed = {
        "prompts_confirmed_by": request.confirmed_by,
        "hazard_confirmed_by": request.hazard_confirmed_by,
    }
    writer.describe(
        "run",
        {
            "plan": request.plan.name,
            "title": request.plan.title,
            "bench": request.bench.title or request.bench.name,
            "operator": request.operator or request.bench.operator,
            "started_at": started_at.isoformat(timespec="seconds"),
            "simulated": str(bench.simulated).lower(),
            **{key: name for key, name in confirmed.items() if name},
        },
    )
    writer.describe("dut", request.bench.dut)
    writer.describe("versions", versions())
    dates = {name: date.isoformat() for name, date in request.bench.calibration.items()}
    writer.describe("calibration", dates)


def store_expiry(recorder: Recorder, expired: AcceptedExpiry) -> None:
    """Who answers for sensors whose calibration has run out."""
    recorder.writer.describe(ACCEPTED_EXPIRY, {"json": expired.model_dump_json()})


def store_result(
    recorder: Recorder, request: RunRequest, bench: Bench, conductor: BenchConductor, result: RunResult
) -> None:
    """The result, what was made on the way, and hashes of all; closes the recording."""
    writer = recorder.writer
    attachments = {"run.json": result.model_dump_json(indent=1).encode()}
    attachments |= {f"made/{name}": content for name, content in conductor.made.items()}
    for name, content in attachments.items():
        writer.attach(name, content)
    controllers = {f"controller/{name}.toml": text.encode() for name, text in conductor.controllers.items()}
    writer.describe("time", recorder.time_base())
    writer.describe("hashes", hashes(_inputs(request, bench) | controllers | attachments))
    writer.close()


def _inputs(request: RunRequest, bench: Bench) -> dict[str, bytes]:
    inputs = {"plan.yaml": request.plan.text.encode(), "bench.toml": request.bench.text.encode()}
    if bench.model is not None:
        inputs["model.toml"] = model_to_toml(bench.model).encode()
    return inputs
