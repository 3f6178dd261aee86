"""A diagnosis tells the same on however many threads it computes."""

import os
import subprocess

import pytest

from hil.core.model import EffectUse, save_model
from hil.core.recording import write_recording
from tests.hil.analysis.diagnosis.one_recording import MODEL, recorded
from tests.hil.cli.test_commands import HIL

FRICTION = EffectUse("coulomb_friction", {"torque_nm": 2.0})


@pytest.mark.slow
def test_a_diagnosis_is_the_same_file_on_one_and_on_several_threads(tmp_path):
    for seed in (1, 2):
        write_recording(recorded(FRICTION, seconds=8.0, seed=seed), tmp_path / f"{seed}.csv")
    off = MODEL.with_parameters(shaft_stiffness=1.01 * MODEL.parameters["shaft_stiffness"])
    save_model(off, tmp_path / "model.toml")
    told = []
    for threads in ("1", "3"):
        out = tmp_path / threads
        command = [HIL, "diagnose", "--model", "model.toml", "1.csv", "2.csv", "--out", out]
        environment = {**os.environ, "NUMBA_NUM_THREADS": threads}
        subprocess.run(command, cwd=tmp_path, env=environment, check=True, timeout=600, capture_output=True)
        told.append([(out / name).read_bytes() for name in ("diagnosis.json", "model.toml")])
    assert told[0] == told[1]
    assert b'"coulomb_friction"' in told[0][0]
