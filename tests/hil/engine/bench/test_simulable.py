"""What of a bench can be simulated, and that it is simulated with what the bench file says."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from drivers import DeviceTable, LoadTable
from hil.core.errors import BadInputError
from hil.core.model import load_model
from hil.engine.bench.simulable import check_simulable, dyno_of, rmcu_of, simulated
from tests.benches_for_tests import SIM


class OtherMotor(DeviceTable):
    kind: Any = "rmcu-ethernet"


class OtherLoad(LoadTable):
    kind: Any = "eddy-brake"


def test_the_shipped_kinds_can() -> None:
    assert rmcu_of(SIM) is SIM.rmcu
    assert dyno_of(SIM) is SIM.dyno
    check_simulable(SIM)


@pytest.mark.parametrize(
    ("key", "table", "said"),
    [
        ("rmcu", OtherMotor.model_construct(kind="rmcu-ethernet"), "rmcu.kind = 'rmcu-ethernet'"),
        ("dyno", OtherLoad.model_construct(kind="eddy-brake"), "dyno.kind = 'eddy-brake'"),
    ],
)
def test_other_kinds_are_refused_by_name(key: str, table: DeviceTable, said: str) -> None:
    bench = SIM.model_copy(update={key: table})
    with pytest.raises(BadInputError, match=said) as caught:
        check_simulable(bench)
    assert "'rmcu-can'" in caught.value.fix
    assert caught.value.where == str(SIM.source)


def test_the_simulated_bench_has_what_the_bench_file_says() -> None:
    vehicle = SIM.vehicle.model_copy(update={"wheel_radius_m": 0.29})
    simulation = SIM.simulation.model_copy(update={"seed": 77})
    bench = SIM.model_copy(update={"vehicle": vehicle, "simulation": simulation})
    world = simulated(bench, load_model(SIM.simulation.model))
    settings = world.settings
    assert (settings.wheel_radius_m, settings.seed) == (0.29, 77)
    assert (settings.dbc, settings.eds) == (SIM.rmcu.dbc, SIM.dyno.eds)
    assert settings.rmcu_bit_rate == SIM.buses[SIM.rmcu.bus].bit_rate
    assert settings.dyno_bit_rate == SIM.buses[SIM.dyno.bus].bit_rate
    noise = SIM.simulation.noise
    assert settings.noise.shaft_torque_nm == noise.shaft_torque_nm
    assert settings.noise.motor_speed_rad_s == noise.motor_speed_rad_s


def test_a_dbc_that_lacks_a_message_is_refused(tmp_path: Path) -> None:
    (tmp_path / "rmcu.dbc").write_text(
        'VERSION ""\n\nBU_: PC\n\nBO_ 1 Other: 8 PC\n SG_ X : 0|8@1+ (1,0) [0|1] "" PC\n'
    )
    rmcu = SIM.rmcu.model_copy(update={"dbc": tmp_path / "rmcu.dbc"})
    with pytest.raises(BadInputError):
        check_simulable(SIM.model_copy(update={"rmcu": rmcu}))
