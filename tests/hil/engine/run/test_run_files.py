"""What stands in a recording beside the samples: inputs from the start, the result at the end."""

from __future__ import annotations

import json
from collections.abc import Iterator
from hashlib import sha256
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from hil.core.recording import ACCEPTED_EXPIRY, read_recording, recover_recording
from hil.core.result import AcceptedExpiry, RunResult
from hil.engine import RunRequest
from hil.engine.run.recorder import Recorder
from hil.engine.run.run_files import store_expiry, store_inputs, store_result
from tests.benches_for_tests import plan, running, sim_bench

STARTED = "2026-01-02T03:04:05.678+00:00"
RESULT = RunResult(
    verdict="error",
    plan="test",
    bench="files",
    real_time_factor=1.0,
    bench_time_s=0.5,
    safe_state="confirmed",
)


@pytest.fixture(name="stored")
def made_run(tmp_path: Path) -> Iterator[Any]:
    request = RunRequest(
        plan("[{wait: {duration_s: 1}}]"),
        sim_bench("files"),
        tmp_path,
        operator="O. Perator",
        confirmed_by="P.",
    )
    with running("files") as bench:
        recorder = Recorder(tmp_path / "r.mcap", bench.streams, list(bench.file.buses), 0.001)
        inputs = store_inputs(recorder, request, bench, STARTED)
        recorder.begin()

        def take() -> None:
            for source in bench.sources:
                for samples in source.samples():
                    recorder.take(samples)

        bench.loop.on_drained(take)
        bench.loop.run_for(0.3)
        recorder.finish_rows()
        stored = SimpleNamespace(
            recorder=recorder, request=request, inputs=inputs, path=tmp_path / "r.mcap", closed=False
        )
        yield stored
        if not stored.closed:
            recorder.writer.close()


def finish(stored: Any, made: dict[str, bytes], controllers: dict[str, str]) -> Any:
    conductor: Any = SimpleNamespace(made=made, controllers=controllers)
    store_result(stored.recorder, stored.inputs, conductor, RESULT)
    stored.closed = True
    return read_recording(stored.path, allow_missing=True)


def test_inputs_are_there_though_the_run_never_ends(stored: Any, tmp_path: Path) -> None:
    stored.recorder.keep()
    torn = tmp_path / "torn.mcap"
    torn.write_bytes(stored.path.read_bytes())
    recover_recording(torn, tmp_path / "whole.mcap")
    left = read_recording(tmp_path / "whole.mcap", allow_missing=True)
    assert left.attachments["plan.yaml"].decode() == stored.request.plan.text
    assert left.attachments["bench.toml"].decode() == stored.request.bench.text
    assert b"three_inertia" in left.attachments["model.toml"]
    rmcu, dyno = stored.request.bench.rmcu, stored.request.bench.dyno
    assert left.attachments["device/rmcu/rmcu.dbc"] == rmcu.dbc.read_bytes()
    assert left.attachments["device/dyno/rcs_dyno.eds"] == dyno.eds.read_bytes()
    assert "run.json" not in left.attachments
    run = left.metadata["run"]
    assert (run["plan"], run["operator"], run["simulated"]) == ("test", "O. Perator", "true")
    assert run["prompts_confirmed_by"] == "P."
    assert "hazard_confirmed_by" not in run  # no one did
    assert left.metadata["dut"] == stored.request.bench.dut
    assert set(left.metadata["calibration"]) == set(stored.request.bench.calibration)


def test_the_result_is_stored_whole_with_a_hash_of_every_file(stored: Any) -> None:
    recording = finish(stored, {"frf.csv": b"a,b\n"}, {"phase": "kind = 1\n"})
    assert RunResult.model_validate_json(recording.attachments["run.json"]) == RESULT
    assert recording.attachments["made/frf.csv"] == b"a,b\n"
    hashes = recording.metadata["hashes"]
    for name in ("plan.yaml", "bench.toml", "model.toml", "device/rmcu/rmcu.dbc", "run.json", "made/frf.csv"):
        assert hashes[name] == sha256(recording.attachments[name]).hexdigest(), name
    assert hashes["controller/phase.toml"] == sha256(b"kind = 1\n").hexdigest()
    assert set(hashes) == {*recording.attachments, "controller/phase.toml"}
    assert float(recording.metadata["time"]["bench_clock_at_row_0_s"]) > 0


def test_who_accepted_an_expired_calibration_is_kept(stored: Any) -> None:
    expired = AcceptedExpiry(by="A. Tester", reason="same day", sensors={"shaft_torque_left": "2020-01-01"})
    store_expiry(stored.recorder, expired)
    kept = json.loads(finish(stored, {}, {}).metadata[ACCEPTED_EXPIRY]["json"])
    assert kept == expired.model_dump()
