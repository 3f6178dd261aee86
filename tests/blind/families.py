"""Effects of the registry in the reference plant: from one size to laws, sensors and the sealed values."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from hil.core.channels import OUTPUTS
from tests.blind.reference.contact import DISSIPATIVE, SERIES
from tests.blind.reference.hysteresis import BOUC_WEN, MASING
from tests.blind.sensors import Sensor

_WIDE_GAP = 0.003  # rad


@dataclass(frozen=True)
class Hidden:
    """What an effect of one size is: laws and sensors of the plant, `values` as the registry names them."""

    id: str
    laws: dict[str, float] = field(default_factory=dict)
    sensors: tuple[Sensor, ...] = ()
    values: dict[str, float | str] = field(default_factory=dict)


@dataclass(frozen=True)
class Setting:
    """The plant that an effect is drawn for.

    `scale` is the experiments' torque scale; `deviation` the outputs' standard deviations over the set.
    """

    kind: str
    parameters: dict[str, float]
    scale: float
    deviation: dict[str, float]


@dataclass(frozen=True)
class Family:
    """An effect with everything drawn but its size; it grows with the size between the two ends."""

    id: str
    smallest: float
    largest: float
    of_size: Callable[[float], Hidden]


Draw = Callable[[np.random.Generator, Setting], Family]


def _plain(id: str, law: str, value: str, smallest: float, largest: float) -> Draw:
    """An effect whose one parameter is its size."""

    def draw(rng: np.random.Generator, setting: Setting) -> Family:
        del rng, setting
        return Family(id, smallest, largest, lambda size: Hidden(id, {law: size}, (), {value: size}))

    return draw


def _falling(id: str, law: str, value: str, weakest: float, strongest: float) -> Draw:
    """A limit in N m or N m/s at torque scale 1: the lower, the stronger; size = weakest/limit."""

    def draw(rng: np.random.Generator, setting: Setting) -> Family:
        del rng
        top = weakest * setting.scale

        def of_size(size: float) -> Hidden:
            return Hidden(id, {law: top / size}, (), {value: top / size})

        return Family(id, 1.0, weakest / strongest, of_size)

    return draw


def _deadband(rng: np.random.Generator, setting: Setting) -> Family:
    del rng

    def of_size(size: float) -> Hidden:
        return Hidden("torque_deadband", {"deadband_nm": size}, (), {"half_width_nm": size})

    return Family("torque_deadband", 0.02 * setting.scale, 6.0 * setting.scale, of_size)


def _dead_time(rng: np.random.Generator, setting: Setting) -> Family:
    """Always clearly more than what calibration leaves open in the model's own dead time."""
    del rng

    def of_size(size: float) -> Hidden:
        return Hidden("dead_time", {"extra_delay_s": size}, (), {"extra_delay_s": size})

    return Family("dead_time", 0.06 * setting.parameters["torque_delay"], 0.03, of_size)


def _backlash(rng: np.random.Generator, setting: Setting) -> Family:
    del setting
    dissipative = rng.uniform() < 0.4
    depth = rng.uniform(1e-4, 6e-4)

    def of_size(size: float) -> Hidden:
        # a small gap with flanks that never pull is no longer a small change: damping itself is cut off
        form = DISSIPATIVE if dissipative and size > _WIDE_GAP else SERIES
        laws = {"half_gap": size, "contact_form": form, "contact_depth": depth}
        return Hidden("backlash", laws, (), {"half_gap_rad": size})

    return Family("backlash", 1e-4, 0.03, of_size)


def _cubic(rng: np.random.Generator, setting: Setting) -> Family:
    sign = 1.0 if rng.uniform() < 0.75 else -0.6  # softening shafts are rarer, and must stay stiff
    # at the largest size the cubic part equals the linear one at 0.08 rad
    unit = sign * setting.parameters["shaft_stiffness"] / (0.08 * setting.scale) ** 2

    def of_size(size: float) -> Hidden:
        return Hidden(
            "shaft_cubic_stiffness", {"cubic": size * unit}, (), {"coefficient_nm_rad3": size * unit}
        )

    return Family("shaft_cubic_stiffness", 1e-3, 0.8 if sign > 0 else 0.3, of_size)


def _hysteresis(rng: np.random.Generator, setting: Setting) -> Family:
    slip = rng.uniform(0.006, 0.03) * setting.scale
    form = BOUC_WEN if rng.uniform() < 0.5 else MASING
    sharpness = rng.uniform(1.5, 4.0)

    def of_size(size: float) -> Hidden:
        stiffness = size * setting.parameters["shaft_stiffness"]
        laws = {
            "hysteresis": form,
            "hysteresis_stiffness": stiffness,
            "hysteresis_slip": slip,
            "hysteresis_sharpness": sharpness,
        }
        return Hidden("shaft_hysteresis", laws, (), {"stiffness_nm_rad": stiffness, "slip_rad": slip})

    return Family("shaft_hysteresis", 5e-3, 1.0, of_size)


def _coulomb(rng: np.random.Generator, setting: Setting) -> Family:
    form = rng.choice(["plain", "stribeck", "asymmetric"], p=[0.6, 0.2, 0.2])
    stribeck = rng.uniform(0.3, 0.6) if form == "stribeck" else 0.0
    offset = rng.choice([-1.0, 1.0]) * rng.uniform(0.2, 0.4) if form == "asymmetric" else 0.0
    bristles = {"bristle_stiffness": rng.uniform(1000.0, 4000.0), "stribeck_speed": rng.uniform(2.0, 6.0)}

    def of_size(size: float) -> Hidden:
        laws = {"coulomb": size, "stribeck": stribeck * size, "friction_offset": offset * size} | bristles
        values: dict[str, float | str] = {"torque_nm": size}
        if stribeck:
            values["stribeck_torque_nm"] = stribeck * size
        if offset:
            values["offset_nm"] = offset * size
        return Hidden("coulomb_friction", laws, (), values)

    return Family("coulomb_friction", 0.01 * setting.scale, 6.0 * setting.scale, of_size)


def _mount(rng: np.random.Generator, setting: Setting) -> Family:
    del setting
    omega = 2.0 * math.pi * rng.uniform(12.0, 26.0)
    ratio = rng.uniform(0.04, 0.1)

    def of_size(size: float) -> Hidden:
        inertia = 1.0 / size
        stiffness, damping = inertia * omega**2, 2.0 * ratio * omega * inertia
        laws = {
            "has_mount": 1.0,
            "housing_inertia": inertia,
            "mount_stiffness": stiffness,
            "mount_damping": damping,
        }
        values: dict[str, float | str] = {
            "housing_inertia_kg_m2": inertia,
            "mount_stiffness_nm_rad": stiffness,
            "mount_damping_nms_rad": damping,
        }
        return Hidden("mount_mode", laws, (), values)

    return Family("mount_mode", 1e-3, 1.5, of_size)


def _tyre(rng: np.random.Generator, setting: Setting) -> Family:
    del setting
    wheel, stiffness, damping = (
        rng.uniform(3.0, 6.0),
        rng.uniform(4500.0, 8000.0),
        rng.uniform(250.0, 500.0),
    )

    def of_size(size: float) -> Hidden:
        values = {
            "wheel_inertia": wheel,
            "tyre_stiffness": stiffness / size**2,
            "tyre_damping": damping / size,
        }
        return Hidden("tyre_compliance", {"has_tyre": 1.0, **values}, (), {**values})

    return Family("tyre_compliance", 0.1, 1.5, of_size)


def _ripple(id: str, law: str, orders: tuple[float, ...], smallest: float, largest: float) -> Draw:
    def draw(rng: np.random.Generator, setting: Setting) -> Family:
        order, phase = float(rng.choice(orders)), rng.uniform(-math.pi, math.pi)

        def of_size(size: float) -> Hidden:
            laws = {f"{law}_order": order, f"{law}_amplitude": size, f"{law}_phase": phase}
            return Hidden(id, laws, (), {"order": order, "amplitude_nm": size, "phase_rad": phase})

        return Family(id, smallest * setting.scale, largest * setting.scale, of_size)

    return draw


def _resistance(rng: np.random.Generator, setting: Setting) -> Family:
    aero = rng.uniform(5e-4, 2e-3)  # of the rolling part per (rad/s)²: equal at 22 to 45 rad/s

    def of_size(size: float) -> Hidden:
        values = {"rolling_nm": size, "aero_nms2_rad2": aero * size}
        return Hidden("running_resistance", {"rolling": size, "aero": aero * size}, (), {**values})

    return Family("running_resistance", 0.05 * setting.scale, 80.0 * setting.scale, of_size)


def _sensor(id: str, value: str, smallest: float, largest: float) -> Draw:
    """A sensor's error; sizes of offsets and steps count in standard deviations of the channel."""

    def draw(rng: np.random.Generator, setting: Setting) -> Family:
        channel = str(rng.choice(OUTPUTS))
        sign = rng.choice([-1.0, 1.0])
        deviation = setting.deviation[channel]

        def of_size(size: float) -> Hidden:
            number = {
                "gain": 1.0 + sign * size,
                "offset": sign * size * deviation,
                "delay_s": size,
                "step": size * deviation,
            }[value]
            sensor = Sensor(channel, **{value: number})
            return Hidden(id, {}, (sensor,), {"channel": channel, value: number})

        return Family(id, smallest, largest, of_size)

    return draw


FAMILIES: dict[str, Draw] = {
    "dead_time": _dead_time,
    "actuator_lag": _plain("actuator_lag", "lag_s", "time_constant_s", 1e-4, 0.05),
    "torque_saturation": _falling("torque_saturation", "limit_nm", "limit_nm", 42.0, 6.0),
    "torque_rate_limit": _falling("torque_rate_limit", "rate_nm_s", "limit_nm_s", 2e4, 60.0),
    "torque_deadband": _deadband,
    "backlash": _backlash,
    "shaft_cubic_stiffness": _cubic,
    "shaft_hysteresis": _hysteresis,
    "coulomb_friction": _coulomb,
    "viscous_drag": _plain("viscous_drag", "viscous_drag", "coefficient_nms_rad", 1e-5, 0.1),
    "mount_mode": _mount,
    "tyre_compliance": _tyre,
    "wheel_order_disturbance": _ripple("wheel_order_disturbance", "wheel", (1, 2, 3, 6), 0.1, 120.0),
    "motor_order_ripple": _ripple("motor_order_ripple", "motor", (1, 2, 3, 4, 6), 0.01, 15.0),
    "running_resistance": _resistance,
    "sensor_gain": _sensor("sensor_gain", "gain", 1e-3, 0.3),
    "sensor_offset": _sensor("sensor_offset", "offset", 1e-3, 0.5),
    "channel_skew": _sensor("channel_skew", "delay_s", 1e-4, 0.05),
    "sensor_quantization": _sensor("sensor_quantization", "step", 1e-3, 1.0),
}

#: Those that have a place in a rigid driveline; drag is a parameter of its model file already.
RIGID = (
    "dead_time",
    "actuator_lag",
    "torque_saturation",
    "torque_rate_limit",
    "torque_deadband",
    "coulomb_friction",
    "motor_order_ripple",
    "running_resistance",
    "sensor_gain",
    "sensor_offset",
    "channel_skew",
    "sensor_quantization",
)


def fits(id: str, kind: str) -> bool:
    """Whether the effect can be hidden behind a model of `kind`."""
    if kind == "rigid":
        return id in RIGID
    return id != "tyre_compliance" or kind == "two_inertia"
