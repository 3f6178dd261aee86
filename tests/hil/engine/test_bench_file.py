import tomllib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hil.core.errors import BadInputError
from hil.engine.bench_file import bench_from_dict, load_bench
from tests.benches_for_tests import SIM


@pytest.mark.parametrize("name", ["sim", "rear_axle_socketcan"])
def test_shipped_benches_load_with_files_that_exist(name):
    bench = load_bench(name)
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


values = st.none() | st.booleans() | st.floats() | st.text(max_size=5) | st.lists(st.integers(), max_size=2)


@given(table=st.sampled_from(["buses", "rmcu", "dyno", "limits", "dut", "simulation", "name"]), value=values)
def test_whatever_stands_in_a_table_it_is_a_bench_or_bad_input(table, value):
    data = tomllib.loads(SIM.text) | {table: value}
    try:
        bench_from_dict(data, "", SIM.source)
    except BadInputError as error:
        assert table in str(error)
