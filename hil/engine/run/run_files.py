"""What a run stores in its recording beside what was measured."""

from __future__ import annotations

import hashlib
from pathlib import Path

from hil.core.channels import CHANNELS
from hil.core.files.toml_file import FORMAT
from hil.core.model import model_to_toml
from hil.core.recording import ACCEPTED_EXPIRY, DEVICE
from hil.core.result import AcceptedExpiry, RunResult
from hil.core.runtime.versions import versions
from hil.engine.bench.bench import Bench
from hil.engine.bench.device_kinds import descriptions_of
from hil.engine.ipc.ipc import RunRequest
from hil.engine.run.recorder import Recorder
from hil.engine.run.step_execution import BenchConductor


def hashes(attachments: dict[str, bytes]) -> dict[str, str]:
    """SHA-256 of each attachment."""
    return {name: hashlib.sha256(content).hexdigest() for name, content in sorted(attachments.items())}


def store_inputs(recorder: Recorder, request: RunRequest, bench: Bench, started_at: str) -> dict[str, bytes]:
    """What is known at the start stands at the start: also a recording that is cut off has it.

    Args:
        started_at: ISO 8601, UTC.

    Returns:
        The files as stored, for their hashes.
    """
    writer = recorder.writer
    inputs = _inputs(request, bench)
    for name, content in inputs.items():
        writer.attach(name, content)
    for name, path in _sources(request, bench).items():
        recorder.store_source(name, path)
    confirmed = {
        "prompts_confirmed_by": request.confirmed_by,
        "hazard_confirmed_by": request.hazard_confirmed_by,
    }
    values = ", ".join(map(str, request.plan.values))
    writer.describe(
        "run",
        {
            "plan": request.plan.name,
            "title": request.plan.title,
            "bench": request.bench.title or request.bench.name,
            "operator": request.operator or request.bench.operator,
            "format": str(FORMAT),
            "started_at": started_at,
            "simulated": str(bench.simulated).lower(),
            **{key: name for key, name in confirmed.items() if name},
            **({"variables": values} if values else {}),
        },
    )
    writer.describe("dut", request.bench.dut)
    writer.describe("report", request.bench.report.model_dump())
    writer.describe("versions", versions())
    dates = {name: date.isoformat() for name, date in request.bench.calibration.items()}
    writer.describe("calibration", dates)
    units = {
        name: unit
        for stream in bench.streams
        for name, unit in zip(stream.channels, stream.units, strict=True)
        if name not in CHANNELS and unit
    }
    if units:
        writer.describe("units", units)
    return inputs


def store_expiry(recorder: Recorder, expired: AcceptedExpiry) -> None:
    """Who answers for sensors whose calibration has run out."""
    recorder.writer.describe(ACCEPTED_EXPIRY, {"json": expired.model_dump_json()})


def store_result(
    recorder: Recorder, inputs: dict[str, bytes], conductor: BenchConductor, result: RunResult
) -> None:
    """The result, what was made on the way, and hashes of all; closes the recording."""
    writer = recorder.writer
    attachments = {"run.json": result.model_dump_json(indent=1).encode()}
    attachments |= {f"made/{name}": content for name, content in conductor.made.items()}
    for name, content in attachments.items():
        writer.attach(name, content)
    controllers = {f"controller/{name}.toml": text.encode() for name, text in conductor.controllers.items()}
    writer.describe("time", recorder.time_base())
    writer.describe("hashes", hashes(inputs | controllers | attachments))
    writer.close()


def _sources(request: RunRequest, bench: Bench) -> dict[str, Path]:
    """The files of `_inputs`, by the attachment's name."""
    found = {"plan.yaml": request.plan.source, "bench.toml": request.bench.source}
    if bench.model is not None and bench.model.source:
        found["model.toml"] = Path(bench.model.source)
    for key, table in bench.file.device_tables.items():
        found |= {f"{DEVICE}{key}/{path.name}": path for path in table.files()}
    return found


def _inputs(request: RunRequest, bench: Bench) -> dict[str, bytes]:
    inputs = {"plan.yaml": request.plan.text.encode(), "bench.toml": request.bench.text.encode()}
    if bench.model is not None:
        inputs["model.toml"] = model_to_toml(bench.model).encode()
    return inputs | _descriptions(bench)


def _descriptions(bench: Bench) -> dict[str, bytes]:
    """DBC, EDS and whatever else says what the devices' frames mean, by device: raw frames need them."""
    found: dict[str, bytes] = {}
    for key, table in bench.file.device_tables.items():
        found |= descriptions_of(key, filter(Path.is_file, table.files()))
    return found
