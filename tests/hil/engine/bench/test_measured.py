"""What a bench limits it must measure: check, doctor and run say the same of a limit on nothing."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from hil.cli._app import guarded
from hil.core.errors import BadInputError
from hil.engine import load_bench
from hil.engine.bench.bench import open_bench
from hil.engine.bench.measured import refuse_unmeasured
from hil.engine.commissioning.doctor import DoctorRequest, examine_bench

ROOT = Path(__file__).parents[4]
LIMIT = '\n[limits.channels.oil_temperature_k]\nabove = 400.0\nunit = "K"\n'


def written(folder: Path, name: str, added: str) -> Path:
    text = (ROOT / "benches" / f"{name}.toml").read_text("utf-8")
    for file in ("rmcu.dbc", "rcs_dyno.eds", "three_inertia.toml"):
        text = re.sub(f'"{file}"', f'"{ROOT / "benches" / file}"', text)
    (folder / "bench.toml").write_text(text + added)
    return folder / "bench.toml"


def test_check_doctor_and_run_refuse_the_same_limit_in_the_same_words(tmp_path, capsys):
    file = load_bench(written(tmp_path, "sim", LIMIT))
    said = []
    for asked in (refuse_unmeasured, lambda file: open_bench(file).__enter__()):
        with pytest.raises(BadInputError, match="no device provides this channel") as refused:
            asked(file)
        said.append(str(refused.value))
    (fault,) = (one for one in examine_bench(DoctorRequest(file, 0.2)).findings if one.severity == "fault")
    assert {*said, f"{fault.where}: {fault.what}\n  {fault.fix}"} == {said[0]}
    assert guarded(["check", "acceptance", "--bench", str(tmp_path / "bench.toml")]) == 2
    assert "limits.channels.oil_temperature_k" in capsys.readouterr().err


def test_hardware_is_asked_without_being_touched(tmp_path):
    with pytest.raises(BadInputError, match="no device provides this channel"):
        refuse_unmeasured(load_bench(written(tmp_path, "rear_axle_socketcan", LIMIT)))


@pytest.mark.parametrize("name", ["sim", "rear_axle_socketcan"])
def test_shipped_benches_measure_what_they_limit(name):
    refuse_unmeasured(load_bench(ROOT / "benches" / f"{name}.toml"))


def test_what_a_device_on_another_wire_measures_is_not_known(tmp_path):
    panel = '\n[devices.panel]\nkind = "rcs-panel"\nport = "/dev/nowhere"\n'
    refuse_unmeasured(load_bench(written(tmp_path, "rear_axle_socketcan", panel + LIMIT)))
