"""The RMCU's blocks against the paper's equations, and its supervision of requests."""

import math
from pathlib import Path

import control
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers import parameters_of
from hil.core.can.dbc import read_dbc
from hil.core.can.frames import crc8
from hil.core.can.symbol_files import read_symbols
from hil.core.controller import load_controller
from hil.plant.controller.driving_force import DrivingForceObserver
from hil.plant.controller.filters import settle, step, tustin
from hil.plant.controller.memory import OBSERVER_SPEED, OBSERVER_TORQUE, SHAFT_STIFFNESS, Memory
from hil.plant.controller.parameters import OPTIONAL
from hil.plant.controller.wheel_speed_control import Notch, PhaseLead
from sim_backend.rmcu import INTERNALS, NEEDED, REQUEST_TIMEOUT_S, RmcuNode

DBC = read_dbc(Path(__file__).parents[3] / "benches" / "rmcu.dbc", NEEDED)
REQUEST = DBC.layouts["RMCU_Request"]
DEN = [1.0, 71.59, 6376.0, 2.399e5, 3.867e6, 0.0]
SHAFT = [212.7, 5.23e4, 1.947e6, 3.14e7, 0.0]
MOTOR = [46.35, 2604.0, 8.768e4, 5.302e4, 8.547e5]
WHEEL = [45.99, 5664.0, 6839.0, 1.049e5]


def run(filter_, inputs):
    state = np.zeros(8)
    return np.array([step(filter_.numerator, filter_.denominator, state, u) for u in inputs])


@pytest.mark.parametrize(
    ("numerator", "denominator"),
    [
        (DEN, np.polymul(SHAFT, [0.05, 1.0])),  # (18)
        (MOTOR, np.polymul(WHEEL, [0.05, 1.0])),  # (17)
        ([1.0], [1 / 125.6, 1.0]),
    ],
)
def test_tustin_agrees_with_python_control(numerator, denominator):
    filter_ = tustin(numerator, denominator, 1e-3)
    above, below = list(numerator), list(denominator)
    while above[-1] == 0 and below[-1] == 0:
        above, below = above[:-1], below[:-1]
    expected = control.c2d(control.ss(control.tf(above, below)), 1e-3, "tustin")
    inputs = np.random.default_rng(1).standard_normal(2000)
    _, response = control.forced_response(expected, np.arange(2000) * 1e-3, inputs)
    np.testing.assert_allclose(
        run(filter_, inputs), response, rtol=1e-6, atol=1e-6 * np.max(np.abs(response))
    )


def response_of(filter_, frequency_hz):
    z = np.exp(2j * np.pi * frequency_hz * 1e-3)
    powers = z ** -np.arange(9)
    return (filter_.numerator @ powers) / (filter_.denominator @ powers)


def test_the_lead_leads_by_what_it_says_at_its_frequency():
    alpha = (1 - math.sin(math.radians(36))) / (1 + math.sin(math.radians(36)))  # (6)
    t = 1 / (2 * math.pi * math.sqrt(alpha) * 40.0)  # (7)
    assert (alpha, t) == (pytest.approx(0.25962, abs=1e-5), pytest.approx(7.8087e-3, abs=5e-7))
    lead = response_of(PhaseLead(alpha, alpha, t, 1e-3).filter, 40.0)
    assert math.degrees(np.angle(lead)) == pytest.approx(36.0, abs=0.5)
    assert abs(lead) == pytest.approx(math.sqrt(alpha), rel=0.01)


def test_the_notch_is_as_deep_as_it_says():
    notch = Notch(10.6, 2.0, 0.08, 1e-3).filter
    assert abs(response_of(notch, 10.6)) == pytest.approx(0.08, rel=0.02)
    assert abs(response_of(notch, 0.01)) == pytest.approx(1.0, abs=1e-3)


def test_the_observer_finds_the_driving_torque_of_a_rigid_axle():
    memory = Memory()
    DrivingForceObserver(1 / 125.6, 8.0, 4.0, 1e-3).load(memory)
    torque = run(_filter(memory, OBSERVER_TORQUE), np.full(2000, 30.0))
    # wheels accelerating at 5 rad/s²: ω_m = N·5·t; (13): rF_d = T_m N - J_l·5
    speed = run(_filter(memory, OBSERVER_SPEED), 8.0 * 5.0 * np.arange(2000) * 1e-3)
    assert (torque - speed)[-1] == pytest.approx(30.0 * 8.0 - 4.0 * 5.0, rel=1e-6)


def _filter(memory, index):
    return type("Filter", (), {
        "numerator": memory.numerators[index], "denominator": memory.denominators[index]})  # fmt: skip


@given(st.floats(-100, 100))
def test_a_settled_filter_stays_where_it_is(level):
    filter_ = tustin(MOTOR, np.polymul(WHEEL, [0.05, 1.0]), 1e-3)
    state = np.zeros(8)
    settle(filter_.numerator, filter_.denominator, state, level)
    outputs = [step(filter_.numerator, filter_.denominator, state, level) for _ in range(50)]
    np.testing.assert_allclose(outputs, 8.547e5 / 1.049e5 * level, rtol=1e-5, atol=1e-6)


@pytest.mark.parametrize(
    ("above", "below"),
    [([1.0, 0, 0], [1.0, 1.0]), ([1.0], [1.0, -1.0]), ([1.0], [0.0]), ([1.0], [1.0] * 12)],
)
def test_filters_that_cannot_run_are_refused(above, below):
    with pytest.raises(ValueError, match=r"."):
        tustin(above, below, 1e-3)


def request(counter, mode=1, torque=10.0):
    payload = int(REQUEST.encode(Counter=counter % 16, Mode=mode, TorqueRequest=torque)[0])
    return payload | crc8(REQUEST.id, payload) << 56


class TestRequests:
    def node(self):
        return RmcuNode(DBC, lambda frame_id, data: None)

    def test_good_requests_are_followed(self):
        node = self.node()
        for k in range(40):
            node.receive(REQUEST.id, request(k, torque=k), k * 1e-3)
            node.supervise(k * 1e-3)
            assert (node.mode, node.request) == (1, pytest.approx(k, abs=1e-3))

    def test_an_old_request_counts_as_none(self):
        node = self.node()
        node.receive(REQUEST.id, request(0), 0.0)
        node.supervise(REQUEST_TIMEOUT_S)
        assert node.mode == 1
        node.supervise(REQUEST_TIMEOUT_S + 1e-3)
        assert (node.mode, node.request) == (3, 0.0)

    @given(st.integers(0, 63))
    def test_one_wrong_bit_anywhere_counts_as_none(self, bit):
        node = self.node()
        node.receive(REQUEST.id, request(0, torque=10.0), 0.0)
        node.receive(REQUEST.id, request(1, torque=99.0) ^ (1 << bit), 1e-3)
        assert node.request == pytest.approx(10.0, abs=1e-3)

    def test_a_frozen_sender_counts_as_none(self):
        node = self.node()
        node.receive(REQUEST.id, request(0), 0.0)
        node.receive(REQUEST.id, request(1), 1e-3)
        for k in range(2, 60):
            node.receive(REQUEST.id, request(1), k * 1e-3)
            node.supervise(k * 1e-3)
        assert (node.mode, node.request) == (3, 0.0)

    def test_one_lost_frame_costs_one_frame(self):
        node = self.node()
        for k in (0, 1, 3, 4):
            node.receive(REQUEST.id, request(k, torque=k), k * 1e-3)
        assert node.request == pytest.approx(4.0, abs=1e-3)

    def test_a_fault_stays_until_off_is_asked_for(self):
        node = self.node()
        node.receive(REQUEST.id, request(0), 0.0)
        node.supervise(1.0)
        node.receive(REQUEST.id, request(1), 1.001)
        assert node.mode == 3
        node.receive(REQUEST.id, request(2, mode=0), 1.002)
        node.receive(REQUEST.id, request(3), 1.003)
        assert node.mode == 1

    def test_driving_force_needs_parameters_and_vehicle_speed(self):
        node = self.node()
        node.vehicle_speed_is_fresh(0.0)
        node.receive(REQUEST.id, request(0, mode=2), 0.0)
        assert (node.mode, node.code >> 4 & 15) == (3, 5)


def test_what_is_optional_counts_for_one_apply():
    """A controller that lacks a table switches it off, also for hosts that do not know of it."""
    node = RmcuNode(DBC, lambda frame_id, data: None)
    write, index = DBC.layouts["RMCU_ParameterWrite"], DBC.texts["RMCU_ParameterWrite", "Index"]
    library = Path(__file__).parents[3] / "test_plans/library/controllers"
    crossing = parameters_of(load_controller(library / "play_crossing.toml"))
    lead = parameters_of(load_controller(library / "phase_stabilization.toml"))
    assert set(OPTIONAL) < set(index)
    assert not set(OPTIONAL) & set(lead)
    found = []
    for parameters in (crossing, lead, crossing):
        frames = [
            write.encode(Command=1, Index=index[name], Value=value) for name, value in parameters.items()
        ]
        for frame in (*frames, write.encode(Command=2, Index=0, Value=0.0)):
            node.receive(write.id, int(frame[0]), 0.0)
        found.append(node.memory.gains[SHAFT_STIFFNESS])
    assert found == [6089.0, 0.0, 6089.0]


def test_every_symbol_of_the_shipped_a2l_stands_for_something_in_its_memory():
    symbols = read_symbols(Path(__file__).parents[3] / "benches" / "rmcu.a2l")
    addresses = sorted(symbol.address for symbol in symbols.by_name.values())
    assert len(set(addresses)) == len(addresses) == len(INTERNALS)
