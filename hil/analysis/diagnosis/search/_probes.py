"""Where to look first: for every effect of the registry a few sizes that it may have."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.fit._coordinates import Hypothesis, key_of
from hil.analysis.diagnosis.fit._fit import Fit
from hil.analysis.diagnosis.fit._problem import Problem
from hil.analysis.diagnosis.search._orders import order_lines
from hil.analysis.diagnosis.search._probe import Direction, Probe, Scene, Values
from hil.analysis.diagnosis.search._thresholds import LATE_S, STRETCH
from hil.core.channels import OUTPUTS
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse, parameter_names

Array = npt.NDArray[np.float64]


def probes(problem: Problem, fit: Fit) -> list[Probe]:
    """Probes of every effect that can still be added to the hypothesis of `fit`."""
    scene = Scene(problem, fit)
    taken = set(fit.hypothesis.keys) | {key_of(use) for use in fit.hypothesis.base.effects}
    kind = fit.hypothesis.base.kind
    found = []
    for id_, make in _MAKERS.items():
        if kind not in EFFECTS[id_].needs or (id_, "") in taken:
            continue
        for probe in make(scene):
            name = str(probe.directions[0].values.get("channel", ""))
            if (id_, name) not in taken:
                found.append(probe)
    return found


def mismatches(hypothesis: Hypothesis) -> list[EffectUse]:
    """One candidate for each parameter of the base model that may be wrong."""
    taken = set(hypothesis.keys)
    return [
        EffectUse("parameter_mismatch", {"parameter": name, "value": hypothesis.base.parameters[name]})
        for name in parameter_names(hypothesis.base.kind)
        if hypothesis.base.parameters[name] > 0.0
        and ("parameter_mismatch", name) not in taken
        and name != "torque_delay"
    ]


def _scaled(id_: str, name: str, unit: float, lower: float, upper: float, **others: float | str) -> Probe:
    """An effect that is linear in `name`, around zero."""
    direction = Direction({**others, name: unit}, lower, upper)
    return Probe(id_, (direction,), lambda a: {**others, name: float(a[0]) * unit})


def _fixed(id_: str, **values: float | str) -> Probe:
    """An effect of one size; neighbouring sizes look alike, whatever their numbers are."""
    return Probe(id_, (Direction(dict(values), *STRETCH),), lambda _: dict(values))


def _sized(id_: str, name: str, size: float, lower: float = STRETCH[0]) -> Probe:
    """An effect whose response goes about with its one number near `size`."""
    return _scaled(id_, name, size, lower, STRETCH[1])


def _dead_time(scene: Scene) -> Iterator[Probe]:
    del scene
    yield _scaled("dead_time", "extra_delay_s", 5e-4, 0.0, 8.0)
    for delay in (0.003, 0.008, 0.016, 0.03):
        yield _sized("dead_time", "extra_delay_s", delay)


def _lag(scene: Scene) -> Iterator[Probe]:
    del scene
    yield _sized("actuator_lag", "time_constant_s", 0.001, 0.02)
    for constant in (0.002, 0.004, 0.008, 0.016, 0.032, 0.064):
        yield _sized("actuator_lag", "time_constant_s", constant)


def _saturation(scene: Scene) -> Iterator[Probe]:
    for share in (0.97, 0.92, 0.85, 0.75, 0.65, 0.55, 0.45, 0.35, 0.25):
        yield _clipped(scene.torque, share)


def _clipped(torque: float, share: float) -> Probe:
    """A saturation; its response goes about with what it cuts off."""
    direction = Direction({"limit_nm": share * torque}, *STRETCH)
    return Probe(
        "torque_saturation",
        (direction,),
        lambda a: {"limit_nm": max(1.0 - float(a[0]) * (1.0 - share), 0.05) * torque},
    )


def _rate_limit(scene: Scene) -> Iterator[Probe]:
    for slope in np.geomspace(1.0, 300.0, 11):
        yield _fixed("torque_rate_limit", limit_nm_s=float(slope) * scene.torque)


def _deadband(scene: Scene) -> Iterator[Probe]:
    for share in (0.004, 0.012, 0.03, 0.07, 0.15):
        yield _sized("torque_deadband", "half_width_nm", share * scene.torque, 0.2)


def _backlash(scene: Scene) -> Iterator[Probe]:
    del scene
    for gap in np.geomspace(2e-4, 0.12, 12):
        yield _sized("backlash", "half_gap_rad", float(gap), 0.2)


def _cubic(scene: Scene) -> Iterator[Probe]:
    stiffness = scene.model.parameters["shaft_stiffness"]
    twist = scene.shaft_torque / stiffness
    unit = stiffness / twist**2
    yield _scaled("shaft_cubic_stiffness", "coefficient_nm_rad3", 0.01 * unit, -20.0, 20.0)
    for share in (-0.3, -0.15, 0.15, 0.4, 1.0):
        yield _sized("shaft_cubic_stiffness", "coefficient_nm_rad3", share * unit)


def _hysteresis(scene: Scene) -> Iterator[Probe]:
    stiffness = scene.model.parameters["shaft_stiffness"]
    twist = scene.shaft_torque / stiffness
    for share in (0.005, 0.02, 0.06, 0.15, 0.35, 0.7):
        yield _scaled(
            "shaft_hysteresis", "stiffness_nm_rad", 0.08 * stiffness, 0.0, 8.0, slip_rad=share * twist
        )


def _coulomb(scene: Scene) -> Iterator[Probe]:
    rest: Values = {"stribeck_torque_nm": 0.0, "offset_nm": 0.0}
    for share in (0.005, 0.03, 0.1, 0.2):
        unit = share * scene.torque
        yield Probe(
            "coulomb_friction",
            (Direction({"torque_nm": unit, **rest}, 0.3, 2.0),),
            lambda a, unit=unit: {"torque_nm": float(a[0]) * unit, **rest},  # type: ignore[misc]
        )


def _drag(scene: Scene) -> Iterator[Probe]:
    del scene
    for unit in (1e-3, 1e-2):
        yield _scaled("viscous_drag", "coefficient_nms_rad", unit, 0.0, 6.0)


def _mount(scene: Scene) -> Iterator[Probe]:
    del scene
    for frequency in np.geomspace(2.5, 40.0, 16):
        for damping in (0.04, 0.12, 0.35):
            for inertia in (3.0, 30.0):
                yield _bushes(2 * np.pi * float(frequency), damping, inertia)


def _bushes(omega: float, damping: float, inertia: float) -> Probe:
    """A mount mode; its response goes about with the inverse of its inertia at the same frequency."""

    def values(share: float) -> Values:
        heavy = inertia / share
        return {
            "housing_inertia_kg_m2": heavy,
            "mount_stiffness_nm_rad": heavy * omega**2,
            "mount_damping_nms_rad": 2 * damping * omega * heavy,
        }

    return Probe("mount_mode", (Direction(values(1.0), 0.05, 3.0),), lambda a: values(float(a[0])))


def _tyre(scene: Scene) -> Iterator[Probe]:
    vehicle = scene.model.parameters["vehicle_inertia"]
    for share in (0.007, 0.014, 0.03, 0.06):
        for frequency in (2.0, 4.0, 8.0, 16.0):
            for damping in (0.15, 0.6, 1.5):
                wheel = share * vehicle
                omega = 2 * np.pi * frequency
                yield _fixed(
                    "tyre_compliance",
                    wheel_inertia=wheel,
                    tyre_stiffness=wheel * omega**2,
                    tyre_damping=2 * damping * omega * wheel,
                )


def _ripple(id_: str, order: float, unit: float) -> Probe:
    sine: Values = {"order": order, "amplitude_nm": unit, "phase_rad": 0.0}
    cosine: Values = {"order": order, "amplitude_nm": unit, "phase_rad": 0.5 * np.pi}

    def start(a: Array) -> Values:
        amplitude = max(float(np.hypot(a[0], a[1])), 1e-3) * unit
        return {"order": order, "amplitude_nm": amplitude, "phase_rad": float(np.arctan2(a[1], a[0]))}

    return Probe(id_, (Direction(sine, -1e4, 1e4), Direction(cosine, -1e4, 1e4)), start)


def _wheel_order(scene: Scene) -> Iterator[Probe]:
    for line in order_lines(scene.problem, scene.fit, "wheel"):
        yield _ripple("wheel_order_disturbance", line.order, 0.5)


def _motor_order(scene: Scene) -> Iterator[Probe]:
    for line in order_lines(scene.problem, scene.fit, "motor"):
        yield _ripple("motor_order_ripple", line.order, 0.05)


def _resistance(scene: Scene) -> Iterator[Probe]:
    del scene
    rolling = Direction({"rolling_nm": 5.0, "aero_nms2_rad2": 0.0}, 0.0, 60.0)
    aero = Direction({"rolling_nm": 0.0, "aero_nms2_rad2": 0.01}, 0.0, 300.0)
    yield Probe(
        "running_resistance",
        (rolling, aero),
        lambda a: {"rolling_nm": 5.0 * float(a[0]), "aero_nms2_rad2": 0.01 * float(a[1])},
    )


def _sensors(id_: str) -> Callable[[Scene], Iterator[Probe]]:
    name = EFFECTS[id_].parameters[0].name
    units = {"sensor_gain": 0.01, "sensor_offset": 1.0, "channel_skew": 1e-3}

    def make(scene: Scene) -> Iterator[Probe]:
        for column, channel in enumerate(OUTPUTS):
            if not any(t.has[column] for t in scene.problem.traces):
                continue
            yield _reading(id_, name, channel, units[id_])
            if id_ == "channel_skew":
                yield from (_late(channel, delay) for delay in LATE_S)

    return make


def _late(channel: str, delay: float) -> Probe:
    """A channel so late that its error is no longer like its slope."""

    def start(a: Array) -> Values:
        return {"channel": channel, "delay_s": delay * float(a[0])}

    return Probe("channel_skew", (Direction({"channel": channel, "delay_s": delay}, 0.0, 2.0),), start)


def _reading(id_: str, name: str, channel: str, unit: float) -> Probe:
    """A sensor effect of one channel, linear around a true reading."""
    rest = 1.0 if id_ == "sensor_gain" else 0.0
    lower = -60.0 if id_ != "channel_skew" else -20.0

    def start(a: Array) -> Values:
        return {"channel": channel, name: rest + unit * float(a[0])}

    return Probe(id_, (Direction({"channel": channel, name: rest + unit}, lower, -lower * 3),), start)


_MAKERS: dict[str, Callable[[Scene], Iterator[Probe]]] = {
    "dead_time": _dead_time,
    "actuator_lag": _lag,
    "torque_saturation": _saturation,
    "torque_rate_limit": _rate_limit,
    "torque_deadband": _deadband,
    "backlash": _backlash,
    "shaft_cubic_stiffness": _cubic,
    "shaft_hysteresis": _hysteresis,
    "coulomb_friction": _coulomb,
    "viscous_drag": _drag,
    "mount_mode": _mount,
    "tyre_compliance": _tyre,
    "wheel_order_disturbance": _wheel_order,
    "motor_order_ripple": _motor_order,
    "running_resistance": _resistance,
    "sensor_gain": _sensors("sensor_gain"),
    "sensor_offset": _sensors("sensor_offset"),
    "channel_skew": _sensors("channel_skew"),
}
