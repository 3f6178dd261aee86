"""The linear system of a model: against python-control, by impedances, and against the stepping kernel."""

import control
import numpy as np
import pytest

from hil.analysis.identification import chain_response
from hil.core.errors import BadInputError
from hil.core.model import EffectUse, Model
from hil.plant import linear_system, simulate
from tests.hil.plant.test_held_linear import THREE, mount

DT = 1e-3
FREQUENCY = np.geomspace(0.1, 100.0, 25)
TWO = Model(
    "two_inertia",
    {name: value for name, value in THREE.parameters.items() if "wheel" not in name and "tyre" not in name},
)
RIGID = Model(
    "rigid",
    {
        "motor_inertia": 0.02,
        "gear_ratio": 8.148,
        "vehicle_inertia": 303.0,
        "viscous_drag": 0.02,
        "torque_delay": 0.0035,
    },
)
LAG = EffectUse("actuator_lag", {"time_constant_s": 0.004})
DRAG = EffectUse("viscous_drag", {"coefficient_nms_rad": 0.05})
MODELS = {
    "rigid": RIGID,
    "rigid with lag": RIGID.with_effects(LAG),
    "two": TWO,
    "two with drag": TWO.with_effects(DRAG, LAG),
    "three": THREE,
    "three on bushes": THREE.with_effects(mount(2e4, 30.0), DRAG, LAG),
}


def by_impedances(p: dict[str, float], s: np.ndarray) -> np.ndarray:
    """Three inertias from the outside in: each part's torque over speed, no state anywhere."""
    vehicle = p["vehicle_inertia"] * s
    tyre = p["tyre_damping"] + p["tyre_stiffness"] / s
    wheel = p["wheel_inertia"] * s + 1.0 / (1.0 / tyre + 1.0 / vehicle)
    shaft = p["shaft_damping"] + p["shaft_stiffness"] / s
    behind_gear = 1.0 / (1.0 / shaft + 1.0 / wheel)
    motor = 1.0 / (p["motor_inertia"] * s + behind_gear / p["gear_ratio"] ** 2)
    torque = behind_gear * motor / p["gear_ratio"]
    return np.stack([motor, torque / wheel, torque]) * np.exp(-p["torque_delay"] * s)


def test_three_inertias_are_their_impedances():
    expected = by_impedances(THREE.parameters, 2j * np.pi * FREQUENCY)
    np.testing.assert_allclose(linear_system(THREE).response(FREQUENCY), expected, rtol=1e-10)


@pytest.mark.parametrize("model", [RIGID, TWO, THREE], ids=lambda model: model.kind)
def test_the_closed_forms_of_identification_are_this_system(model):
    found = chain_response(model.kind, model.parameters, FREQUENCY)
    np.testing.assert_allclose(found, linear_system(model).response(FREQUENCY), rtol=1e-10)


@pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)
@pytest.mark.parametrize("source", linear_system(THREE).inputs)
def test_the_response_is_python_controls(model, source):
    system = linear_system(model)
    column = system.inputs.index(source)
    reference = control.ss(system.a, system.b[:, [column]], system.c, system.d[:, [column]])
    expected = np.array(control.frequency_response(reference, 2 * np.pi * FREQUENCY).frdata)[:, 0, :]
    if source == "motor_torque_nm":
        expected = expected * np.exp(-2j * np.pi * FREQUENCY * system.delay_s)
    np.testing.assert_allclose(system.response(FREQUENCY, source), expected, rtol=1e-8, atol=1e-12)


@pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)
@pytest.mark.parametrize("periods", [4, 16, 40])
def test_the_stepping_kernel_answers_a_sine_like_the_linear_system(model, periods):
    samples = 2000  # the last window of as many: with all transients gone
    frequency = periods / (samples * DT)
    turned = 2 * np.pi * frequency * DT * np.arange(6 * samples)
    channels = simulate(model, 10.0 * np.sin(turned), DT)
    image = np.exp(-1j * turned[-samples:])
    torque = 10.0 * np.sin(turned[-samples:]) @ image
    held = np.sinc(frequency * DT) * np.exp(-1j * np.pi * frequency * DT)
    expected = linear_system(model).response(np.array([frequency]))[:, 0] * held
    found = np.array([(channels[name][-samples:]) @ image / torque for name in linear_system(model).outputs])
    np.testing.assert_allclose(found, expected, rtol=0.01)


def test_names_say_what_the_matrices_hold():
    system = linear_system(THREE)
    shape = (len(system.states), len(system.inputs), len(system.outputs))
    assert shape == (8, 6, 3)
    assert (system.a.shape, system.b.shape) == ((8, 8), (8, 6))
    assert (system.c.shape, system.d.shape) == ((3, 8), (3, 6))
    rotor, twist = system.states.index("rotor_speed"), system.states.index("twist")
    p = THREE.parameters
    assert system.a[twist, rotor] == 1.0 / p["gear_ratio"]
    assert system.b[rotor, system.inputs.index("motor_torque_nm")] == 1.0 / p["motor_inertia"]


def test_a_transfer_function_has_no_states():
    with pytest.raises(BadInputError, match="has no states"):
        linear_system(Model("transfer_function"))
