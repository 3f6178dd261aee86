"""A tyre that slides: against an integrator of others, closed forms, and on patches of the road."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from benchmarks.low_friction import ride
from hil.core.effects import EFFECTS
from hil.core.errors import BadInputError
from hil.core.model import EffectUse, Model, model_from_dict
from hil.plant import LONGEST_STEP_S, Start, pack, simulate
from hil.plant import kernel as K
from tests.hil.plant.test_effects import DT, THREE, many, stepped

P = THREE.parameters
PEAK, SLIDING, FADES = 300.0, 220.0, 3.0
START = Start(0.0, 0.0, 0.0)


def slippery(**more: float) -> Model:
    values = {"peak_nm": PEAK, "sliding_nm": SLIDING, **more}
    return THREE.with_effects(EffectUse("tyre_friction", EFFECTS["tyre_friction"].check(values, "here")))


def run(model: Model, torque: np.ndarray) -> dict[str, np.ndarray]:
    return simulate(model, torque, DT, START)


def speeds(model: Model, torque: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Wheel and vehicle in rad/s."""
    out = K.empty_output(len(torque))
    K.run(
        torque, np.zeros(len(torque)), True, DT, pack(model), np.zeros(K.START_COLUMNS), LONGEST_STEP_S, out
    )
    return out[:, K.OUT_WHEEL_SPEED], out[:, K.OUT_VEHICLE_SPEED]


def expected(torque: np.ndarray, friction: float = 1.0, length: float = 1.0) -> np.ndarray:
    """Motor, wheel and vehicle speed (rad/s) by scipy; the sixth state is the vehicle's travel."""

    def slope(_, x, u):
        rate = x[0] / P["gear_ratio"] - x[2]
        shaft = P["shaft_stiffness"] * x[1] + P["shaft_damping"] * rate
        slip = x[2] - x[4]
        held = SLIDING + (PEAK - SLIDING) * math.exp(-((slip / FADES) ** 2))
        if math.floor(x[5] * 0.33 / length) % 2:
            held *= friction
        twisting = slip - abs(slip) * P["tyre_stiffness"] * x[3] / held
        road = P["tyre_stiffness"] * x[3] + P["tyre_damping"] * twisting
        return [
            (u - shaft / P["gear_ratio"]) / P["motor_inertia"],
            rate,
            (shaft - road) / P["wheel_inertia"],
            twisting,
            road / P["vehicle_inertia"],
            x[4],
        ]

    x, rows = np.zeros(6), []
    for u in torque:
        rows.append([x[0], x[2], x[4]])
        x = solve_ivp(slope, (0, DT), x, "DOP853", rtol=1e-9, atol=1e-10, args=(u,), t_eval=[DT]).y[:, -1]
    return np.array(rows)


def test_it_slides_as_another_integrator_says():
    torque = np.where(np.arange(1500) < 300, 0.0, 60.0)
    torque[1000:] = -30.0
    out = run(slippery(), torque)
    found = np.column_stack([out["motor_speed_rad_s"], out["wheel_speed_rad_s"]])
    assert np.abs(found - expected(torque)[:, :2]).max() < 1e-4 * np.abs(found).max()


def test_the_kernel_of_many_models_slides_alike():
    model = slippery(peak_nm=100.0, sliding_nm=80.0)
    a, b, plain = stepped(model), many(model), stepped(THREE)
    assert np.all(np.sqrt(np.mean((a - b) ** 2, 0)) < 0.02 * np.sqrt(np.mean((a - plain) ** 2, 0)))


def test_a_tyre_that_slides_for_long_holds_what_it_holds_sliding():
    """T tends to g(v): the vehicle's acceleration is the sliding torque over its inertia."""
    wheel, vehicle = speeds(slippery(), np.full(4000, 100.0))
    assert wheel[-1] - vehicle[-1] > 10.0 * FADES
    acceleration = (vehicle[-1] - vehicle[-501]) / (500 * DT)
    assert acceleration == pytest.approx(SLIDING / P["vehicle_inertia"], rel=1e-4)


def test_below_the_bound_it_is_a_tyre_that_does_not_slide():
    gentle = 4.0 * np.sin(2 * np.pi * 0.5 * np.arange(4000) * DT)
    with_bound, without = run(slippery(peak_nm=1e6, sliding_nm=1e6), gentle), run(THREE, gentle)
    for name, values in without.items():
        assert with_bound[name] == pytest.approx(values, abs=2e-3 * max(1.0, np.abs(values).max())), name


def test_patches_are_where_the_vehicle_is():
    torque = np.full(5000, 40.0)  # 326 N m at the wheels: more than patches hold, less than the road does
    model = slippery(peak_nm=600.0, sliding_nm=500.0, patch_friction=0.2, patch_length_m=2.0)
    wheel, vehicle = speeds(model, torque)
    travel, slip = 0.33 * np.cumsum(vehicle) * DT, wheel - vehicle
    on_patch = (np.floor(travel / 2.0) % 2 == 1) & (travel > 0.5)
    first = int(np.argmax(on_patch))
    assert slip[on_patch].max() > 5.0
    assert slip[first - 200 : first].max() < 0.05


def test_it_is_off_at_a_peak_of_zero():
    torque = np.full(500, 50.0)
    off, plain = run(slippery(peak_nm=0.0), torque), run(THREE, torque)
    assert all(np.array_equal(off[name], plain[name]) for name in plain)


def test_control_calms_the_shafts_on_a_road_with_patches():
    """Against no control: 60 % less at least, by lead and notch alike (docs/how-to/low-friction.md)."""
    free = ride("").range_nm
    assert all(ride(f"{name}_stabilization").range_nm < 0.4 * free for name in ("phase", "gain"))


@pytest.mark.parametrize(
    ("effects", "said"),
    [
        ([{"id": "tyre_friction", "peak_nm": 1000.0, "sliding_nm": 2400.0}], "above peak_nm"),
        ([{"id": "separate_wheels", "friction_left": 0.05}], "the model has none"),
        (
            [
                {"id": "tyre_friction", "peak_nm": 0.0, "sliding_nm": 1.0},
                {"id": "separate_wheels", "friction_right": 0.05},
            ],
            "the model has none",
        ),
    ],
)
def test_values_that_make_no_sense_together_are_refused(effects: list[dict[str, object]], said: str) -> None:
    with pytest.raises(BadInputError, match=said):
        model_from_dict({"kind": "three_inertia", "parameters": dict(P), "effects": effects}, "here")
