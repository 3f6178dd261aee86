"""A controller file as the RMCU's numbered parameters."""

from __future__ import annotations

from hil.core.controller import LARGEST_ORDER, Controller


def parameters_of(controller: Controller) -> dict[str, float]:
    """Parameter names of the DBC with their values; everything that can be written to the RMCU."""
    dfc, wsc, dfo = controller.dfc, controller.wsc, controller.dfo
    values = {
        "sample_time": controller.sample_time_s,
        "torque_limit": controller.torque_limit_nm,
        "k_i_dfc": dfc.integral_gain,
        "tau_2": dfc.feedforward_time_constant_s,
        "wheel_radius": dfc.wheel_radius_m,
        "sigma": dfc.slip_floor_m_s,
        "slip_limit": dfc.slip_limit,
        "k_p": wsc.proportional_gain,
        "k_i": wsc.integral_gain,
        "tau_1": wsc.filter_time_constant_s,
        "lead_gain": wsc.lead.gain if wsc.lead else 0.0,
        "lead_alpha": wsc.lead.alpha if wsc.lead else 0.0,
        "lead_t": wsc.lead.time_constant_s if wsc.lead else 0.0,
        "notch_frequency": wsc.notch.frequency_hz if wsc.notch else 0.0,
        "notch_width": wsc.notch.width if wsc.notch else 0.0,
        "notch_depth": wsc.notch.depth if wsc.notch else 0.0,
        "tau_dfo": dfo.time_constant_s,
        "gear_ratio": dfo.gear_ratio,
        "wheel_inertia": dfo.wheel_inertia_kg_m2,
    }
    polynomials = {
        "den": controller.plant.denominator,
        "motor": controller.plant.motor_speed,
        "wheel": controller.plant.wheel_speed,
        "shaft": controller.plant.shaft_torque,
    }
    for name, coefficients in polynomials.items():
        ascending = coefficients[::-1]
        for power in range(LARGEST_ORDER + 1):
            values[f"{name}_{power}"] = ascending[power] if power < len(ascending) else 0.0
    return values
