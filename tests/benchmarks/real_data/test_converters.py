"""Files as their authors publish them become recordings with our channels and units."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.io import savemat

from benchmarks.real_data.__main__ import DATA_SETS, main, missing
from hil.core.channels import INPUT, MOTOR_ANGLE, TIME
from hil.core.errors import BadInputError
from hil.core.model import Model
from hil.core.recording import Recording

SPEED = "motor_speed_rad_s"
_SAMPLES = 6001


def _time():
    return np.arange(_SAMPLES) * 1e-3


def _speed():
    """rad/s or m/s, with reversals."""
    return np.sin(2.0 * np.pi * 0.8 * _time())


def _emps(directory):
    position = np.concatenate([[0.0], np.cumsum(0.5e-3 * (_speed()[1:] + _speed()[:-1]))])
    for name, sign in (("DATA_EMPS.mat", 1.0), ("DATA_EMPS_PULSES.mat", -1.0)):
        columns = {
            "t": _time()[:, None],
            "qm": sign * position[:, None],
            "vir": 2.0 * sign * _speed()[:, None],
        }
        savemat(directory / name, columns | {"gtau": [[35.0]], "kp": [[160.18]], "qg": position[:, None]})


def _hsm150(directory):
    for name in DATA_SETS["hsm150"].files:
        data = np.zeros((_SAMPLES, 7))
        data[:, 0], data[:, 3], data[:, 4] = _time(), _speed(), 70.0 * _speed()
        savemat(directory / name, {"data": data, "J": [[1.2e-4]], "B": [[7e-5]]})


def _lorenz(directory):
    for name in DATA_SETS["lorenz"].files:
        data = np.zeros((_SAMPLES, 5))
        data[:, 1], data[:, 4] = _speed(), 70.0 * _speed()
        np.savetxt(directory / name, data, fmt="%f", delimiter="\t")


def _lexium62(directory):
    columns = {
        "Velocity": ("param::Drive:1:16:Velocity", np.degrees(_speed()), 482),
        "Current": ("FrictionEmulation.DRV_Current_with_Friction", 1e3 * _speed(), 483),
    }
    variables = "".join(
        f'<TraceVariable VarName="{name}"><Values>{",".join(map(repr, values.tolist()))}</Values>'
        f"<Timestamps>{','.join(str(late + 1000 * k) for k in range(_SAMPLES))}</Timestamps></TraceVariable>"
        for name, values, late in columns.values()
    )
    text = f"<Trace><TraceData><TraceRecord>{variables}</TraceRecord></TraceData></Trace>"
    (directory / "JLoadWithFriction.trace").write_bytes(text.encode("utf-16"))


def _embir(directory):
    rows = "\n".join(f"{t:.6f},9,{v!r},{0.1 * v!r}" for t, v in zip(_time(), _speed().tolist(), strict=True))
    text = f"# g1 = 1.0\ntime [s],c1 mode,a1 velocity [rad/s],a1 torque [Nm]\n{rows}\n"
    (directory / DATA_SETS["embir"].files[0]).write_text(text)


def _dfki(directory):
    rows = np.column_stack([_time(), np.zeros(_SAMPLES), _speed(), 1.7 * _speed()])
    for name in DATA_SETS["dfki"].files:
        (directory / name).parent.mkdir(exist_ok=True)
        np.savetxt(directory / name, rows, delimiter=",", header="time,position,velocity,torque", comments="")


def _fditools(directory):
    time = np.arange(50_000) / 2500.0
    speed = np.sin(2.0 * np.pi * 0.8 * time)
    angle = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) / 2500.0)])
    columns = {
        "iq_adx": 2.0 * speed,
        "theta_mx": angle,
        "theta_my": -angle,
        "omega_max": speed,
        "omega_may": -speed,
    }
    for letter in "AB":
        savemat(directory / f"MultisineType{letter}.mat", columns)


WRITTEN = {
    "dfki": _dfki,
    "embir": _embir,
    "emps": _emps,
    "hsm150": _hsm150,
    "lorenz": _lorenz,
    "lexium62": _lexium62,
    **dict.fromkeys([name for name in DATA_SETS if name.startswith("fditools")], _fditools),
}
#: Torque in N m (force in N) at a speed of 1, which the files above hold in their own units.
TORQUE = {
    "dfki": 1.7,
    "embir": 0.1,
    "emps": 70.0,
    "hsm150": 70.0,
    "lorenz": 70.0,
    "lexium62": 0.795915429599640 - 0.00559804068576,
    **dict.fromkeys([name for name in DATA_SETS if name.startswith("fditools")], 2.0),
}


@pytest.mark.parametrize("name", sorted(WRITTEN))
def test_torque_and_speed_arrive_in_our_units(name, tmp_path):
    WRITTEN[name](tmp_path)
    one = DATA_SETS[name]
    assert missing(one, tmp_path) == []
    measured = one.read(tmp_path)
    for recording in (*measured.recordings, *measured.holdout):
        assert isinstance(recording, Recording)
        sample_s = 4e-4 if name.startswith("fditools") else 1e-3
        assert recording.sample_time_s == pytest.approx(sample_s, rel=1e-6)
        speed = _moves(recording)
        top = np.argmax(speed)
        assert speed[top] == pytest.approx(1.0, abs=1e-4)
        assert recording[INPUT][top] == pytest.approx(TORQUE[name], rel=1e-4)
    assert measured.recordings[0][TIME][0] == 0.0


def _moves(recording):
    """Its speed, or the slope of the angle that an encoder gave in place of it."""
    return recording[SPEED] if SPEED in recording else np.gradient(recording[MOTOR_ANGLE], recording.time_s)


@pytest.mark.parametrize("name", sorted(WRITTEN))
def test_the_models_to_start_from_have_one_mass_and_viscous_friction_or_two_masses(name, tmp_path):
    WRITTEN[name](tmp_path)
    for start in DATA_SETS[name].read(tmp_path).starts.values():
        if name.startswith("fditools"):
            assert start.kind == "two_inertia"
            continue
        assert start.kind == "rigid"
        assert not start.effects
        assert start.parameters["gear_ratio"] == 1.0
        assert start.parameters["viscous_drag"] > 0.0


def test_a_pulley_whose_counter_sees_no_direction_gets_that_of_the_linear_model(tmp_path):
    """A voltage that turns round: what is measured stays positive, what is read does not."""
    voltage = np.repeat([1.0, -1.0], 250)[:, None]
    speed = np.abs(voltage) / 1.123
    savemat(tmp_path / "DATAUNIF.MAT", {"u11": voltage, "z11": speed, "u12": 2 * voltage, "z12": 2 * speed})
    measured = DATA_SETS["ced"].read(tmp_path)
    first, held = measured.recordings[0], measured.holdout[0]
    assert first.sample_time_s == pytest.approx(0.02)
    assert first["wheel_speed_rad_s"][200] == pytest.approx(1.0 / 1.123)
    assert first["wheel_speed_rad_s"][-1] == pytest.approx(-1.0 / 1.123)
    assert np.all(held[INPUT] == -1.0)


def test_a_model_is_judged_in_the_official_window(tmp_path):
    """A right model leaves a millimetre of its own lag, one without drag runs away."""
    _emps(tmp_path)
    right = Model(
        "rigid",
        {"motor_inertia": 0.06, "gear_ratio": 1.0, "vehicle_inertia": 0.01, "viscous_drag": 70.0}
        | {"torque_delay": 0.0},
    )
    official = DATA_SETS["emps"].official
    assert float(official(tmp_path, right).split()[-2]) < 2.0
    assert float(official(tmp_path, right.with_parameters(viscous_drag=7.0)).split()[-2]) > 100.0


@pytest.mark.parametrize("name", sorted(DATA_SETS))
def test_another_file_under_the_name_is_refused(name, tmp_path):
    for file in DATA_SETS[name].files:
        (tmp_path / file).parent.mkdir(exist_ok=True)
        (tmp_path / file).write_text("<html>not found</html>")
    with pytest.raises(BadInputError, match=DATA_SETS[name].files[0].split(".")[0]):
        DATA_SETS[name].read(tmp_path)


def test_what_is_not_there_is_said_and_nothing_runs(tmp_path, capsys):
    assert main(["--data", str(tmp_path), "emps", "lorenz"]) == 2
    said = capsys.readouterr().out
    assert "emps: not in" in said
    assert "DATA_EMPS.mat" in said
    with pytest.raises(SystemExit):
        main(["--data", str(tmp_path), "unheard_of"])


@pytest.mark.slow
def test_a_data_set_that_is_there_is_diagnosed_and_told(tmp_path, capsys):
    (tmp_path / "emps").mkdir()
    _emps(tmp_path / "emps")
    assert main(["--data", str(tmp_path), "emps"]) == 0
    said = capsys.readouterr().out
    assert "from published:" in said
    assert "from linear:" in said
