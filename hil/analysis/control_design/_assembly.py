"""A controller put together from what the designer chose and what the model says."""

from __future__ import annotations

import numpy as np

from hil.analysis.control_design._laws import lead
from hil.analysis.control_design._plant import DesignPlant, usable
from hil.analysis.control_design._spec import DesignSpec
from hil.analysis.frequency_response import FrequencyResponse
from hil.analysis.identification import fit_chain
from hil.core.channels import OUTPUTS
from hil.core.controller import Controller, Dfc, Dfo, Lead, Notch, Wsc
from hil.core.controller.bounds import SLOWEST_HZ
from hil.core.controller.shaping import Play
from hil.core.effects import finite_number
from hil.core.errors import BadInputError
from hil.core.model import Model

_LANDING_MARGIN = 0.4  # of half a gap, as in the shipped play_crossing.toml


def refuse_resonance(spec: DesignSpec, resonance_hz: float, where: str) -> None:
    """Refuse a model whose resonance the RMCU cannot act on: neither a lead nor a notch damps it.

    Raises:
        BadInputError: names the resonance and half the sampling rate.
    """
    half_rate = 0.5 / spec.sample_time_s
    if resonance_hz < SLOWEST_HZ:
        raise BadInputError(
            f"the model's resonance at {resonance_hz:.4g} Hz is below {SLOWEST_HZ:g} Hz: no axle has this",
            where=where,
            fix="check the model's units: a stiffness, an inertia, or coefficients of its functions",
        )
    if not resonance_hz < half_rate:
        raise BadInputError(
            f"the model's resonance at {resonance_hz:.4g} Hz lies above {half_rate:g} Hz, half the RMCU's "
            "sampling rate: the controller cannot act on it",
            where=where,
            fix="check the model's units: a stiffness, an inertia, or coefficients of its functions",
        )


@usable()
def speed_controls(spec: DesignSpec, gains: tuple[float, float], resonance_hz: float) -> dict[str, Wsc]:
    """PI alone, with the lead and with the notch, by the names of their loops.

    Raises:
        BadInputError: the gains are none that a controller may have.
    """
    pi = Wsc(
        proportional_gain=gains[0], integral_gain=gains[1], filter_time_constant_s=spec.speed_filter_time_s
    )
    notch = Notch(frequency_hz=spec.notch_hz or resonance_hz, width=spec.notch_width, depth=spec.notch_depth)
    part: Lead = lead(spec.lead_deg, spec.lead_hz, spec.normalisation)
    return {
        "pi": pi,
        "phase": pi.model_copy(update={"lead": part}),
        "gain": pi.model_copy(update={"notch": notch}),
    }


@usable()
def controller_of(
    model: Model,
    spec: DesignSpec,
    plant: DesignPlant,
    wsc: Wsc,
    notes: list[str],
    warnings: tuple[str, ...],
) -> Controller:
    """Everything that the RMCU needs, from what was chosen and what the model says.

    Raises:
        BadInputError: the model does not tell the wheels' inertia, or gives numbers that no controller has.
    """
    return Controller(
        name=spec.name or spec.stabilisation,
        sample_time_s=spec.sample_time_s,
        torque_limit_nm=spec.torque_limit_nm,
        dfc=Dfc(
            integral_gain=spec.dfc_integral_gain,
            feedforward_time_constant_s=spec.feed_forward_time_s,
            wheel_radius_m=spec.wheel_radius_m,
            slip_floor_m_s=spec.slip_floor_m_s,
            slip_limit=spec.slip_limit,
        ),
        wsc=wsc,
        dfo=Dfo(
            time_constant_s=spec.observer_time_s,
            gear_ratio=spec.gear_ratio or plant.gear_ratio,
            wheel_inertia_kg_m2=wheel_inertia_of(model, spec, plant, notes),
        ),
        plant=plant.filters,
        play=_play_of(model, spec, plant),
        meta={"warnings": list(warnings)} if warnings else {},
    )


def wheel_inertia_of(model: Model, spec: DesignSpec, plant: DesignPlant, notes: list[str]) -> float:
    """J_l of (9): wheels and dyno rotors; given, in the model, or read from a chain fitted to it."""
    known = spec.wheel_inertia_kg_m2 or model.parameters.get("wheel_inertia")
    if known is not None:
        return float(known)
    chain = model.meta.get("chain")
    given = finite_number(chain.get("wheel_inertia")) if isinstance(chain, dict) else None
    if given is not None and given > 0:
        return given
    if model.kind != "transfer_function":
        raise BadInputError(
            f"a '{model.kind}' model does not separate the inertia of the wheels from that of the vehicle",
            fix="give --wheel-inertia (wheels and dyno rotors, kg m²)",
        )
    value = chain_of(plant).parameters["wheel_inertia"]
    notes.append(
        f"the observer's wheel inertia {value:.4g} kg m² comes from a three-inertia chain fitted to the model"
    )
    return value


def _play_of(model: Model, spec: DesignSpec, plant: DesignPlant) -> Play | None:
    """A crossing of the play with the model's shafts; of functions, with those of the nearest chain."""
    if spec.half_gap_rad is None:
        return None
    numbers = (chain_of(plant) if model.kind == "transfer_function" else model).parameters
    return Play(
        half_gap_rad=spec.half_gap_rad,
        landing_margin_rad=_LANDING_MARGIN * spec.half_gap_rad,
        motor_inertia_kg_m2=numbers["motor_inertia"],
        shaft_stiffness_nm_rad=numbers["shaft_stiffness"],
        shaft_damping_nms_rad=numbers["shaft_damping"],
        tyre_stiffness_nm_rad=numbers.get("tyre_stiffness"),
        tyre_damping_nms_rad=numbers.get("tyre_damping", 0.0),
        vehicle_inertia_kg_m2=numbers["vehicle_inertia"],
        dead_time_s=plant.delay_s,
    )


def chain_of(plant: DesignPlant) -> Model:
    """The three-inertia chain that is nearest to a plant's functions."""
    frequency = np.geomspace(0.05, 30.0, 200)
    response = np.array([plant.functions[name].response(frequency) for name in OUTPUTS])
    nothing = np.zeros(response.shape)
    exact = FrequencyResponse(
        frequency, OUTPUTS, response, nothing + 1, nothing, nothing, nothing, 1, "model"
    )
    return fit_chain(exact, "three_inertia", torque_delay_s=max(plant.delay_s, 1e-5)).model
