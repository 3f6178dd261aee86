"""An RMCU whose DBC calls everything otherwise: the bench file says how, and nothing else changes."""

from __future__ import annotations

from pathlib import Path

import cantools
import numpy as np
import pytest

from drivers import RmcuTable
from hil.core.errors import BadInputError
from hil.core.recording import read_recording
from hil.engine import RunRequest, load_bench, run_plan
from tests.benches_for_tests import SIM, plan

STEPS = """
  - set_controller: {file: phase_stabilization.toml}
  - hold_speed: {speed_km_h: 5, duration_s: 0.2}
  - step: {segment: s, quantity: driving_torque, from_nm: 0, to_nm: 100, before_s: 0.2, after_s: 0.5}
"""
STATES = {"off": "Aus", "torque": "Moment", "driving_force": "Zugkraft", "fault": "Fehler"}


def other_names(path: Path) -> str:
    """Write the shipped DBC with other names for messages, signals and states; the bench file's tables."""
    database = cantools.database.load_file(SIM.rmcu.dbc)
    messages, signals = {}, {}
    for number, message in enumerate(database.messages):
        messages[message.name] = f"ECU_{number:02d}"
        signals[message.name] = {s.name: f"Sg{number}x{i}" for i, s in enumerate(message.signals)}
    text = SIM.rmcu.dbc.read_text()
    for ours, theirs in messages.items():
        text = text.replace(f" {ours}:", f" {theirs}:")
        number = next(m.frame_id for m in database.messages if m.name == ours)
        for signal, called in signals[ours].items():
            start = text.index(f"BO_ {number} ")
            end = text.index("\n\n", start)
            text = text[:start] + text[start:end].replace(f"SG_ {signal} ", f"SG_ {called} ") + text[end:]
            for kind in ("VAL_", "CM_ SG_", "SIG_VALTYPE_"):
                text = text.replace(f"{kind} {number} {signal} ", f"{kind} {number} {called} ")
    for ours, theirs in STATES.items():
        text = text.replace(f'"{ours}"', f'"{theirs}"')
    path.write_text(text)
    signals["RMCU_Request"].pop("Spare")
    lines = ["[rmcu.messages]", *(f'{ours} = "{theirs}"' for ours, theirs in messages.items())]
    for message, table in signals.items():
        lines += [f"[rmcu.signals.{message}]", *(f'{ours} = "{theirs}"' for ours, theirs in table.items())]
    lines += ["[rmcu.values.RMCU_Control.State]", *(f'{ours} = "{t}"' for ours, t in STATES.items())]
    return "\n".join(lines)


def bench_file(directory: Path, names: str, dbc: str) -> Path:
    shipped = SIM.source.parent
    text = SIM.text.replace('"rmcu.dbc"', f'"{dbc}"').replace("[dyno]", f"{names}\n[dyno]", 1)
    for name in ("rcs_dyno.eds", "three_inertia.toml"):
        text = text.replace(f'"{name}"', f'"{shipped / name}"')
    path = directory / "bench.toml"
    path.write_text(text)
    return path


def test_a_dbc_with_other_names_gives_the_same_run(tmp_path: Path) -> None:
    names = other_names(tmp_path / "other.dbc")
    there = cantools.database.load_file(SIM.rmcu.dbc)
    other = cantools.database.load_file(tmp_path / "other.dbc")
    assert not {m.name for m in there.messages} & {m.name for m in other.messages}
    assert not {s.name for m in there.messages for s in m.signals} & {
        s.name for m in other.messages for s in m.signals
    }
    bench = load_bench(bench_file(tmp_path, names, "other.dbc"))
    found = run_plan(RunRequest(plan(STEPS), bench, tmp_path / "other"))
    usual = run_plan(RunRequest(plan(STEPS), SIM, tmp_path / "usual"))
    assert (found.error, found.result.safe_state) == (None, "confirmed")
    channels = read_recording(found.recording).channels
    assert np.max(channels["shaft_torque_nm"]) > 50
    for name, values in read_recording(usual.recording).channels.items():
        np.testing.assert_array_equal(channels[name], values, err_msg=name)


def test_without_the_mapping_the_missing_message_is_named(tmp_path: Path) -> None:
    other_names(tmp_path / "other.dbc")
    with pytest.raises(BadInputError, match="rmcu.dbc = 'other.dbc': has no messages 'RMCU_Request', '"):
        load_bench(bench_file(tmp_path, "", "other.dbc"))


@pytest.mark.parametrize(
    ("names", "said"),
    [
        ("[rmcu.messages]\nRMCU_Statuss = 'A'", "rmcu.messages.RMCU_Statuss: is not of the RMCU"),
        ("[rmcu.messages]\nRMCU_Statuss = 'A'", "did you mean 'RMCU_Status'?"),
        ("[rmcu.messages]\nRMCU_Status = 'A'", "has no message 'A'"),
        ("[rmcu.messages]\nRMCU_Status = 'A'\nRMCU_Control = 'A'", "RMCU_Control = 'A': is also RMCU_Status"),
        ("[rmcu.messages]\nRMCU_Status = 3", "rmcu.messages.RMCU_Status = 3"),
        ("[rmcu.signals.RMCU_Status]\nSpeed = 'n'", "rmcu.signals.RMCU_Status.Speed: is not of the RMCU"),
        ("[rmcu.signals.RMCU_Status]\nMotorSpeed = 'n'", "message 'RMCU_Status' has no signal 'n'"),
        ("[rmcu.values.RMCU_Control.State]\noff = 'Aus'", "signal 'State' has no value named 'Aus'"),
    ],
)
def test_a_wrong_name_is_told_with_its_key(names: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(BadInputError) as caught:
        load_bench(bench_file(tmp_path, names, str(SIM.rmcu.dbc)))
    assert said in str(caught.value)


def test_a_table_says_what_is_the_matter_before_a_driver_is_made() -> None:
    table = RmcuTable(
        bus="b", dbc=Path("x.dbc"), signals={"RMCU_Status": {"MotorSpeed": "n", "MotorTorque": "n"}}
    )
    assert list(table.contradictions()) == [
        "signals.RMCU_Status.MotorTorque = 'n': is also MotorSpeed; each has a name of its own"
    ]
