"""Controllers drafted and designed for a model."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from hil.analysis.control_design import DesignSpec, Draft, Drafts, Margins, design
from hil.core.controller import Controller, controller_to_toml
from hil.core.errors import HilError
from hil.core.model import load_model
from hil.fmu.axle import Axle
from hil.service.worker_pool.drawn_numbers import number, numbers

_KEPT = 4  # models that stay prepared
_SHOWN_HZ = (0.1, 100.0)
_EACH = 3  # of the frequencies that are drawn
SPEEDS_KM_H = (0.0, 20.0)
STEP_NM = 326.0  # of the paper's and the acceptance plan's steps
_BEFORE, _AFTER = 100, 1400  # milliseconds
_EVERY = 4  # of which is drawn: the response is slower by far


def draft(model: str, **chosen: Any) -> dict[str, Any]:
    """Fields of `DraftData` for a model file.

    Raises:
        BadInputError: the model cannot be designed for, or a value is out of range.
    """
    drafts = drafts_of(model)
    found = drafts.draft(spec_of(chosen))
    shown = (drafts.frequency_hz >= _SHOWN_HZ[0]) & (drafts.frequency_hz <= _SHOWN_HZ[1])
    loops = {"pi": found.pi_loop[shown][::_EACH], "chosen": found.loop[shown][::_EACH]}
    steps, why_not = _steps(drafts, found)
    time_s = (np.arange(0, _BEFORE + _AFTER, _EVERY) - _BEFORE) / 1000.0
    return {
        "frequency_hz": numbers(drafts.frequency_hz[shown][::_EACH]),
        "loops": [
            {
                "name": name,
                "real": numbers(loop.real),
                "imaginary": numbers(loop.imag),
                "sensitivity": numbers(1 / np.maximum(np.abs(1 + loop), 1e-9)),
            }
            for name, loop in loops.items()
        ],
        "margins": margin_fields(found.margins),
        "unstable": found.unstable,
        "resonance_hz": drafts.plant.resonance_hz,
        "step_nm": STEP_NM,
        "time_s": time_s.tolist(),
        "steps": steps,
        "steps_why_not": why_not,
        "notes": [*found.notes, *_fitted_note(drafts)],
    }


def designed(model: str, **chosen: Any) -> dict[str, Any]:
    """Fields of `DesignData`: the whole design of `hil design`.

    Raises:
        BadInputError: as of `hil design`; an unstable loop gives no controller.
    """
    found = design(load_model(Path(model)), spec_of(chosen))
    return {
        "controller": controller_to_toml(found.controller),
        "margins": margin_fields(found.loop(found.chosen).margins),
        "stable_share": found.robustness.stable_share,
        "worst_sensitivity_peak": number(found.robustness.sensitivity_peak),
        "source": found.robustness.source,
        "warnings": list(found.warnings),
        "notes": list(found.notes),
    }


@functools.lru_cache(_KEPT)
def drafts_of(model: str) -> Drafts:
    """A model file, prepared for drafts.

    Raises:
        BadInputError: the model cannot be designed for.
    """
    return Drafts(load_model(Path(model)))


def spec_of(chosen: dict[str, Any]) -> DesignSpec:
    """Fields of `DraftWanted` as a design has them."""
    notch_hz, name = chosen.pop("notch_hz", None), chosen.pop("name", None)
    return DesignSpec(**chosen, notch_hz=notch_hz, name=name or "")


def _steps(drafts: Drafts, found: Draft) -> tuple[list[dict[str, Any]], str]:
    try:
        return [_step(drafts, found.controller, speed) for speed in SPEEDS_KM_H], ""
    except HilError as error:  # the loops can be looked at all the same
        return [], error.what


def _step(drafts: Drafts, controller: Controller, speed_km_h: float) -> dict[str, Any]:
    axle = Axle(drafts.chain, controller, drafts.chain.wheel_radius_m, speed_km_h / 3.6)
    given = axle.play(np.r_[np.zeros(_BEFORE), np.full(_AFTER, STEP_NM)])
    torque: npt.NDArray[np.float64] = given["shaft_torque_nm"]
    peak = float(np.max(torque))
    return {
        "speed_km_h": speed_km_h,
        "shaft_torque_nm": numbers(torque[::_EVERY]),
        "peak_shaft_torque_nm": number(peak),
        "overshoot_shaft_torque_nm": number(max(0.0, peak - STEP_NM)),
    }


def _fitted_note(drafts: Drafts) -> list[str]:
    if not drafts.is_fitted:
        return []
    return ["steps are those of the three-inertia chain that is nearest to the model's functions"]


def margin_fields(found: Margins) -> dict[str, Any]:
    """Fields of `MarginData`."""
    names = (
        "gain_margin_db", "gain_margin_hz", "phase_margin_deg", "phase_margin_hz", "delay_margin_s",
        "sensitivity_peak", "sensitivity_peak_hz", "comfort_peak",
    )  # fmt: skip
    return {**{name: number(getattr(found, name)) for name in names}, "stable": found.stable}
