"""A controller file as the RMCU's numbered parameters."""

from __future__ import annotations

from hil.core.controller import LARGEST_ORDER, Controller
from hil.core.controller.shaping import Play, Schedule


def parameters_of(controller: Controller) -> dict[str, float]:
    """Parameter names of the DBC with their values; everything that can be written to the RMCU.

    What is off in the controller is left out: the RMCU takes it for off, and older DBCs do not know it.
    """
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
    return values | _limits(controller) | _play(controller.play) | _schedule(controller.schedule)


def _limits(controller: Controller) -> dict[str, float]:
    found: dict[str, float] = {}
    if (request := controller.request) is not None:
        found |= {
            "request_rise": request.rise_nm_s,
            "request_fall": request.fall_nm_s,
            "zero_band": request.zero_band_nm,
            "zero_gradient": request.zero_gradient_nm_s,
        }
    if (slip := controller.slip) is not None:
        found |= {"slip_allowed": slip.allowed, "slip_recovery": slip.recovery_nm_s}
    return found


def _play(play: Play | None) -> dict[str, float]:
    if play is None:
        return {}
    return {
        "play_half_gap": play.half_gap_rad,
        "play_crossing_speed": play.crossing_speed_rad_s,
        "play_crossing_torque": play.crossing_torque_nm,
        "play_follow_gradient": play.follow_gradient_nm_s,
        "play_follow_time": play.follow_time_constant_s,
        "play_release_gradient": play.release_gradient_nm_s,
        "play_landing_margin": play.landing_margin_rad,
        "play_correction": play.correction,
        "play_gain_factor": play.gain_factor,
        "play_motor_inertia": play.motor_inertia_kg_m2,
        "play_shaft_stiffness": play.shaft_stiffness_nm_rad,
        "play_shaft_damping": play.shaft_damping_nms_rad,
        "play_tyre_stiffness": play.tyre_stiffness_nm_rad or 0.0,
        "play_tyre_damping": play.tyre_damping_nms_rad,
        "play_vehicle_inertia": play.vehicle_inertia_kg_m2,
        "play_dead_time": play.dead_time_s,
    }


def _schedule(schedule: Schedule | None) -> dict[str, float]:
    if schedule is None:
        return {}
    points = len(schedule.speed_m_s)
    tables = {
        "speed": schedule.speed_m_s,
        "wsc": schedule.wsc_factor,
        "dfc": schedule.dfc_factor or (1.0,) * points,
    }
    return {
        "schedule_points": float(points),
        **{
            f"schedule_{part}_{i}": value for part, values in tables.items() for i, value in enumerate(values)
        },
    }
