"""Files of a recorded run lie beside each other, whatever their folders were."""

from __future__ import annotations

import shlex
from pathlib import Path

import numpy as np
import pytest

from hil.app.run_inputs import command_again, inputs_of
from hil.core.errors import BadInputError
from hil.core.recording import Recording
from hil.core.result import RunResult, VariableValue

PLAN = b"name: p\nsteps:\n  - set_controller: {file: ../controllers/soft.toml}  # ../controllers/soft.toml\n"
BENCH = b"""name = "b"
[rmcu]
dbc = "/data/buses/rmcu.dbc"
[simulation]
model = "models/axle.toml"
"""


def recording(**attachments: bytes) -> Recording:
    named = {name.replace("__", "/").replace("_dot_", "."): content for name, content in attachments.items()}
    return Recording({"time_s": np.arange(3.0)}, Path("r.mcap"), attachments=named)


def test_paths_of_other_folders_become_names_beside_the_plan() -> None:
    stored = {
        "plan_dot_yaml": PLAN,
        "bench_dot_toml": BENCH,
        "model_dot_toml": b"m",
        "controller__soft_dot_toml": b"c",
        "device__rmcu__rmcu_dot_dbc": b"d",
    }
    files = inputs_of(recording(**stored))
    assert set(files) == {"plan.yaml", "bench.toml", "axle.toml", "soft.toml", "rmcu.dbc"}
    assert b"{file: soft.toml}" in files["plan.yaml"]
    assert b'dbc = "rmcu.dbc"' in files["bench.toml"]
    assert b'model = "axle.toml"' in files["bench.toml"]


def test_a_recording_without_a_plan_cannot_be_repeated() -> None:
    with pytest.raises(BadInputError, match=r"has no bench\.toml"):
        inputs_of(recording(plan_dot_yaml=PLAN))


def test_the_command_keeps_every_digit_of_a_variable_and_folders_with_spaces() -> None:
    result = RunResult(
        verdict="pass",
        plan="p",
        bench="b",
        real_time_factor=1.0,
        bench_time_s=1.0,
        safe_state="confirmed",
        variables=(VariableValue(name="torque_nm", value=123.456789012, unit="N m"),),
    )
    told = recording(run_dot_json=result.model_dump_json().encode())
    words = shlex.split(command_again(told, Path("two words")))
    assert words == [
        *("hil", "run", "two words/plan.yaml", "--bench", "two words/bench.toml"),
        *("--set", "torque_nm=123.456789012"),
    ]
