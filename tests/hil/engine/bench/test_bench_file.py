import re
import shutil
import tomllib
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from hil.core.errors import BadInputError
from hil.engine.bench.bench_file import bench_from_dict, load_bench
from hil.engine.bench.bench_tables import NoiseTable, SensorTable, Simulation, Supervision, Vehicle
from tests.benches_for_tests import SIM


@pytest.mark.parametrize("name", ["sim", "rear_axle_socketcan"])
def test_shipped_benches_load_with_files_that_exist(name):
    bench: Any = load_bench(name)
    assert bench.rmcu.dbc.is_file()
    assert bench.dyno.eds.is_file()


def test_an_unknown_bench_lists_those_there_are():
    with pytest.raises(BadInputError, match="sim"):
        load_bench("nowhere")


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("motor_torque_nm = 150.0", "motor_torque_nm = -1.0", "limits.motor_torque_nm"),
        ("motor_torque_nm = 150.0", "", "limits.motor_torque_nm"),
        ("persistence_s = 0.005", "persistance_s = 0.005", "limits.persistance_s"),
        ('bus = "dyno"', 'bus = "dynos"', "'dynos' is not under"),
        ("rear_left = 3", "rear_left = 300", "dyno.rear_left"),
        ("[limits]", "[limits", "not a TOML"),
    ],
)
def test_a_wrong_key_is_named_with_the_file(old, new, said, tmp_path):
    path = tmp_path / "bench.toml"
    path.write_text(SIM.text.replace(old, new))
    with pytest.raises(BadInputError) as caught:
        load_bench(path)
    assert said in str(caught.value)
    assert "bench.toml" in str(caught.value)


HARDWARE = load_bench("rear_axle_socketcan").text
REAL_BUSES = SIM.text.replace('"hil-sim"', '"socketcan"')
LIMIT = "motor_torque_nm = 150.0"


def refused(text, tmp_path):
    for name in ("rmcu.dbc", "rcs_dyno.eds", "three_inertia.toml"):
        shutil.copy(SIM.source.parent / name, tmp_path)
    path = tmp_path / "bench.toml"
    path.write_text(text)
    with pytest.raises(BadInputError) as caught:
        load_bench(path)
    said = str(caught.value)
    assert "bench.toml" in said
    assert all(c.isprintable() for c in said.replace("\n", ""))
    return said


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("rear_right = 4", "rear_right = 3", "dyno.rear_right = 3: is also rear_left"),
        ('"front right" = 2', '"front right" = 4', "dyno.idle.front right = 4: is also rear_right"),
        ("rear_left = 3", "rear_left = 3\nhost_node = 4", "dyno.host_node = 4: is also rear_right"),
        ("rear_left = 3", "rear_left = true", "dyno.rear_left = True"),
        ("[rmcu]", '[buses.b]\ninterface = "hil-sim"\nchannel = "sim/b"\nbit_rate = 500000\n[rmcu]',
         "buses.b: no device uses it"),
        ('"sim/dyno"', '"sim/rmcu"', "buses.dyno.channel = 'sim/rmcu': is also buses.rmcu"),
        ('"sim/dyno"', '"sim/x"', "buses.dyno.channel = 'sim/x'"),
        ('bus = "dyno"', 'bus = "rmcu"', "dyno.bus = 'rmcu': is also rmcu.bus"),
        (LIMIT, "motor_torque_nm = 0.0", "limits.motor_torque_nm = 0.0: must be more than 0"),
        (LIMIT, "motor_torque_nm = nan", "limits.motor_torque_nm = nan: must be a finite number"),
        (LIMIT, "motor_torque_nm = inf", "limits.motor_torque_nm = inf: must be a finite number"),
        (LIMIT, "motor_torque_nm = 1e308", "limits.motor_torque_nm = 1e+308"),
        (LIMIT, f'motor_torque_nm = "{"9" * 5000}"', "limits.motor_torque_nm = '9999"),
        ("persistence_s = 0.005", "persistence_s = 1e308", "limits.persistence_s = 1e+308"),
        ("bit_rate = 1000000", "bit_rate = 0", "buses.rmcu.bit_rate = 0"),
        ('name = "sim"', 'name = "../x"', "name = '../x': is a path"),
        ('name = "sim"', 'name = "a\\u001b[31m"', r"name = 'a\x1b[31m': has control characters"),
        ('operator = "simulation"', 'operator = "a\\u0007"', "operator = 'a"),
        ("[dut]", '[dut]\n"a\\u0007" = "b"', "the key has control characters"),
        ("[simulation]\n", "[calibration]\nx = 20270630\n[simulation]\n", "x = 20270630: is not a date"),
        ("[simulation]\n", '[calibration]\nx = "soon"\n[simulation]\n', "x = 'soon': is not a date"),
        ("[simulation]\n", '[calibration]\nx = "2027-13-01"\n[simulation]\n', "calibration.x = '2027-13-01'"),
        ('"hil-sim"', '"socketcan"', "buses.rmcu.interface = 'socketcan': hardware with [simulation]"),
        ('"hil-sim"', '"hil-sm"', "did you mean 'hil-sim'?"),
        ('title = "Sim', 'text = "x"\ntitle = "Sim', "text: unknown key"),
        ("seed = 1", "seed = -1", "simulation.seed = -1"),
        ("bit_rate = 1000000", "bit_rate = 1000000\noptions = {bitrate = 5}", "buses.rmcu.options.bitrate"),
    ],
)  # fmt: skip
def test_a_contradiction_is_told_with_key_value_and_file(old, new, said, tmp_path):
    assert old in SIM.text
    assert said in refused(SIM.text.replace(old, new, 1), tmp_path)


def test_simulated_buses_need_a_simulation(tmp_path):
    text = SIM.text[: SIM.text.index("[simulation]")]
    said = refused(text, tmp_path)
    assert "buses.rmcu.interface = 'hil-sim': a simulated bus without [simulation]" in said
    assert "buses.dyno.interface = 'hil-sim': a simulated bus without [simulation]" in said


def test_all_mistakes_of_a_file_are_told_at_once(tmp_path):
    text = SIM.text.replace(LIMIT, "motor_torque_nm = -1").replace("[dut]", "[dutt]")
    said = refused(text, tmp_path)
    assert "2 mistakes" in said
    assert "limits.motor_torque_nm = -1" in said
    assert "dutt: unknown key" in said


def test_a_mistake_in_a_devices_table_does_not_hide_one_in_another(tmp_path):
    text = SIM.text.replace("[rmcu]", '[rmcu]\nkind = "rmcu-cam"').replace("[dyno]", "[dyno]\ncolour = 1")
    said = refused(text.replace("wheel_radius_m = 0.33", "wheel_radius_m = -1.0"), tmp_path)
    for key in ("rmcu.kind = 'rmcu-cam'", "dyno.colour", "vehicle.wheel_radius_m"):
        assert key in said


def test_what_a_bench_file_leaves_out_is_as_documented():
    vehicle, supervision, noise = Vehicle(), Supervision(), NoiseTable()
    assert (vehicle.wheel_radius_m, vehicle.slip, vehicle.inertia_kg_m2) == (0.33, 0.0, None)
    assert (supervision.own_process, supervision.hung_after_s, supervision.alone_after_s) == (None, 2.0, 2.0)
    assert (noise.motor_speed_rad_s, noise.wheel_speed_rad_s, noise.shaft_torque_nm) == (0.02, 0.002, 0.5)
    assert Simulation(model=Path("m.toml")).seed == 1
    assert (SensorTable().gain, SensorTable().offset) == (1.0, 0.0)


@pytest.mark.parametrize(
    ("table", "key", "refused", "taken"),
    [
        (Vehicle, "wheel_radius_m", (0.0, 0.0099, 10.1), (0.01, 10.0)),
        (Vehicle, "slip", (-0.1, 1.0), (0.0, 0.99)),
        (Vehicle, "inertia_kg_m2", (0.0, 1.1e6), (0.5, 1e6)),
        (Vehicle, "rolling_nm", (-0.5, 1.1e6), (0.0, 1e6)),
        (Vehicle, "aero_nms2_rad2", (-0.5, 1.1e6), (0.0, 1e6)),
        (Supervision, "hung_after_s", (0.4, 60.5), (0.5, 60.0)),
        (Supervision, "alone_after_s", (0.4, 60.5), (0.5, 60.0)),
        (NoiseTable, "shaft_torque_nm", (-0.1, 1.1e4, float("nan")), (0.0, 1e4)),
    ],
)
def test_numbers_of_a_bench_file_have_bounds(table, key, refused, taken):
    for value in refused:
        with pytest.raises(ValidationError, match=key):
            table(**{key: value})
    for value in taken:
        assert getattr(table(**{key: value}), key) == value


def test_the_files_that_a_bench_names_are_looked_at(tmp_path):
    text = SIM.text.replace('"rmcu.dbc"', '"rcs_dyno.eds"').replace(
        'eds = "rcs_dyno.eds"', 'eds = "none.eds"'
    )
    said = refused(text, tmp_path)
    assert "rmcu.dbc = 'rcs_dyno.eds': not a DBC file" in said
    assert "dyno.eds = 'none.eds': No such file" in said


def test_identifiers_that_meet_on_one_bus_are_refused(tmp_path):
    text = HARDWARE.replace('bus = "dyno"', 'bus = "rmcu"')
    text = re.sub(r"\[buses.dyno\][^[]*", "", text)
    same = refused(
        text.replace("host_node", "x").replace("rear_left = 3", "rear_left = 3\nhost_node = 144"), tmp_path
    )
    assert "dyno.host_node = 144" in same  # beyond CANopen's range
    (tmp_path / "taken").mkdir()
    dbc = (SIM.source.parent / "rmcu.dbc").read_text().replace("BO_ 512", "BO_ 515").replace(" 512 ", " 515 ")
    (tmp_path / "taken" / "rmcu.dbc").write_text(dbc)
    said = refused(text.replace('"rmcu.dbc"', '"taken/rmcu.dbc"'), tmp_path)
    assert "0x203 is both 'RCS_Vehicle' and command of rear_left" in said


def test_one_bus_for_all_is_fine_where_identifiers_differ(tmp_path):
    text = HARDWARE.replace('bus = "dyno"', 'bus = "rmcu"')
    for name in ("rmcu.dbc", "rcs_dyno.eds"):
        shutil.copy(SIM.source.parent / name, tmp_path)
    path = tmp_path / "bench.toml"
    path.write_text(re.sub(r"\[buses.dyno\][^[]*", "", text))
    bench: Any = load_bench(path)
    assert bench.dyno.bus == "rmcu"


@pytest.mark.parametrize("name", ["", "x" * 5000, "a\nb", "sim.txt", ".", "/"])
def test_a_name_that_no_bench_has_is_told(name):
    with pytest.raises(BadInputError, match="there is no bench"):
        load_bench(name)


values = st.none() | st.booleans() | st.floats() | st.text(max_size=5) | st.lists(st.integers(), max_size=2)


@given(table=st.sampled_from(["buses", "rmcu", "dyno", "limits", "dut", "simulation", "name"]), value=values)
def test_whatever_stands_in_a_table_it_is_a_bench_or_bad_input(table, value):
    data = tomllib.loads(SIM.text) | {table: value}
    try:
        bench_from_dict(data, "", SIM.source)
    except BadInputError as error:
        assert table in str(error)


def test_kinds_may_be_named_and_are_what_is_meant_without(tmp_path):
    for name in ("rmcu.dbc", "rcs_dyno.eds", "three_inertia.toml"):
        shutil.copy(SIM.source.parent / name, tmp_path)
    named = SIM.text.replace("[rmcu]\n", '[rmcu]\nkind = "rmcu-can"\n')
    named = named.replace("[dyno]\n", '[dyno]\nkind = "rcs-canopen"\n')
    benches = []
    for text in (named, SIM.text):
        (tmp_path / "bench.toml").write_text(text)
        benches.append(load_bench(tmp_path / "bench.toml"))
    assert benches[0].device_tables == benches[1].device_tables


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            "[rmcu]\n",
            '[rmcu]\nkind = "rmcu-cam"\n',
            "rmcu.kind = 'rmcu-cam': no installed package provides it",
        ),
        ("[rmcu]\n", '[rmcu]\nkind = "rmcu-cam"\n', "did you mean 'rmcu-can'?"),
        ("[rmcu]\n", "[rmcu]\nkind = 3\n", "rmcu.kind = 3: is not a kind; known: rmcu-can, rcs-canopen"),
        ("[dyno]\n", '[dyno]\nkind = "rmcu-can"\n', "dyno.eds: unknown key"),
        ('dbc = "rmcu.dbc"', "", "rmcu.dbc: is missing"),
    ],
)
def test_a_kind_that_does_not_fit_is_told(old, new, said, tmp_path):
    assert said in refused(SIM.text.replace(old, new, 1), tmp_path)
