"""The numbers of a controller that can be tuned, read from a controller and put into one."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from pydantic import BaseModel

from hil.analysis.control_design import lead, pole_assignment
from hil.core.controller import Controller, Notch, Wsc
from hil.core.errors import BadInputError

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Parameter:
    """Symbol, unit, what it may lie between, whether it is searched by its logarithm, and what it is."""

    symbol: str
    unit: str
    least: float
    most: float
    logarithmic: bool
    words: str


PARAMETERS = {
    "lead_deg": Parameter("P_h", "°", 0.0, 85.0, False, "P_h of (6), phase lead"),
    "lead_hz": Parameter("f_ph", "Hz", 0.1, 450.0, True, "f_ph of (7), frequency of the lead"),
    "notch_hz": Parameter("f_n", "Hz", 0.1, 450.0, True, "f_n of (8), frequency of the notch"),
    "notch_width": Parameter("ζ", "", 0.01, 100.0, True, "ζ of (8), width of the notch"),
    "notch_depth": Parameter("d", "", 0.0, 1.0, False, "d of (8), depth of the notch"),
    "pole_rad_s": Parameter("p", "rad/s", 1e-3, 100.0, True, "p of (4)(5), for K_p and K_i together"),
    "proportional_gain": Parameter("K_p", "N m s/rad", 1e-4, 1e4, True, "K_p"),
    "integral_gain": Parameter("K_i", "N m/rad", 1e-6, 1e4, True, "K_i"),
    "dfc_integral_gain": Parameter(
        "K_i(DFC)", "1/(N m s)", 1e-7, 10.0, True, "K_i(DFC), driving force control"
    ),
    "speed_filter_time_s": Parameter("τ_1", "s", 1e-3, 10.0, True, "τ_1 of (17), speed filter"),
    "feed_forward_time_s": Parameter("τ_2", "s", 1e-3, 10.0, True, "τ_2 of (18), feed-forward"),
    "slip_floor_m_s": Parameter(
        "σ", "m/s", 0.01, 100.0, True, "σ of (1), speed below which slip is absolute"
    ),
    "slip_limit": Parameter("y", "", 1e-3, 1.0, True, "largest |y|, the integrator's anti-windup"),
    "observer_time_s": Parameter("τ_DFO", "s", 1e-3, 1.0, True, "τ_DFO, driving force observer"),
    "torque_limit_nm": Parameter(
        "limit", "N m", 1.0, 300.0, True, "largest |T_m*|; both integrators wait at it"
    ),
    "crossing_speed_rad_s": Parameter("v_c", "rad/s", 0.01, 1e3, True, "v_c, crossing of the play"),
    "follow_gradient_nm_s": Parameter("R", "N m/s", 1.0, 1e7, True, "R, largest rate of T_s in contact"),
    "landing_margin_rad": Parameter("margin", "rad", 0.0, 1.0, False, "landing margin before the flank"),
    "request_rise_nm_s": Parameter("rise", "N m/s", 1.0, 1e7, True, "largest gradient of rF_d* upwards"),
    "request_fall_nm_s": Parameter("fall", "N m/s", 1.0, 1e7, True, "largest gradient of rF_d* downwards"),
}
#: Where those stand that belong to a table which a controller may lack.
TABLES = {
    "crossing_speed_rad_s": ("play", "crossing_speed_rad_s"),
    "follow_gradient_nm_s": ("play", "follow_gradient_nm_s"),
    "landing_margin_rad": ("play", "landing_margin_rad"),
    "request_rise_nm_s": ("request", "rise_nm_s"),
    "request_fall_nm_s": ("request", "fall_nm_s"),
}
#: Groups of which only one may be free.
ALTERNATIVES = (
    (("lead_deg", "lead_hz"), ("notch_hz", "notch_width", "notch_depth")),
    (("pole_rad_s",), ("proportional_gain", "integral_gain")),
)
#: A lead or a notch that the start has not: the paper's.
PAPER_LEAD = {"lead_deg": 36.0, "lead_hz": 40.0}
PAPER_NOTCH = {"notch_hz": 10.6, "notch_width": 2.0, "notch_depth": 0.08}


def values_of(controller: Controller) -> dict[str, float]:
    """Every number that can be tuned, as a controller has it; a lead or notch it lacks is the paper's.

    Numbers of a table that it lacks are left out.
    """
    wsc, dfc = controller.wsc, controller.dfc
    found = dict(PAPER_LEAD)
    if wsc.lead is not None:
        alpha = wsc.lead.alpha
        found = {
            "lead_deg": math.degrees(math.asin((1 - alpha) / (1 + alpha))),
            "lead_hz": 1 / (2 * math.pi * math.sqrt(alpha) * wsc.lead.time_constant_s),
        }
    notch = dict(PAPER_NOTCH)
    if wsc.notch is not None:
        notch = {
            "notch_hz": wsc.notch.frequency_hz,
            "notch_width": wsc.notch.width,
            "notch_depth": wsc.notch.depth,
        }
    return {
        **found,
        **notch,
        "pole_rad_s": 2 * wsc.integral_gain / wsc.proportional_gain if wsc.proportional_gain else 0.0,
        "proportional_gain": wsc.proportional_gain,
        "integral_gain": wsc.integral_gain,
        "dfc_integral_gain": dfc.integral_gain,
        "speed_filter_time_s": wsc.filter_time_constant_s,
        "feed_forward_time_s": dfc.feedforward_time_constant_s,
        "slip_floor_m_s": dfc.slip_floor_m_s,
        "slip_limit": dfc.slip_limit,
        "observer_time_s": controller.dfo.time_constant_s,
        "torque_limit_nm": controller.torque_limit_nm,
        **_of_tables(controller),
    }


def _of_tables(controller: Controller) -> dict[str, float]:
    parts = {name: (getattr(controller, table), key) for name, (table, key) in TABLES.items()}
    return {name: float(getattr(part, key)) for name, (part, key) in parts.items() if part is not None}


def refuse_missing_tables(controller: Controller, names: Iterable[str], where: str) -> None:
    """Refuse numbers to be changed of a table that a controller lacks.

    Raises:
        BadInputError: names the number and the table.
    """
    for name in names:
        table = TABLES.get(name, ("", ""))[0]
        if table and getattr(controller, table) is None:
            raise BadInputError(
                f"{name}: controller '{controller.name}' has no table [{table}]",
                where=where,
                fix=f"add [{table}] to its file, or leave {name} out",
            )


def refuse_wide_margin(controller: Controller, free: Mapping[str, tuple[float, float]], where: str) -> None:
    """Refuse a free landing margin that may become wider than the gap: no controller file may hold it.

    Raises:
        BadInputError: names the range and the gap.
    """
    most = free.get("landing_margin_rad", (0.0, 0.0))[1]
    if controller.play is not None and most > 2.0 * controller.play.half_gap_rad:
        raise BadInputError(
            f"landing_margin_rad: up to {most:g} it would be wider than the gap of controller "
            f"'{controller.name}', 2 x half_gap_rad = {2.0 * controller.play.half_gap_rad:g}",
            where=where,
            fix="lower the end of its range",
        )


def with_values(controller: Controller, values: Mapping[str, float], name: str = "") -> Controller:
    """A controller with other numbers; a free lead takes the place of a notch, and the other way round.

    Raises:
        BadInputError: a number of a table that it lacks.
    """
    refuse_missing_tables(controller, values, "controller")
    all_ = values_of(controller) | dict(values)
    dfc = controller.dfc.model_copy(
        update={
            "integral_gain": all_["dfc_integral_gain"],
            "feedforward_time_constant_s": all_["feed_forward_time_s"],
            "slip_floor_m_s": all_["slip_floor_m_s"],
            "slip_limit": all_["slip_limit"],
        }
    )
    return controller.model_copy(
        update={
            "name": name or controller.name,
            "torque_limit_nm": all_["torque_limit_nm"],
            "dfc": dfc,
            "wsc": _speed_control(controller, values, all_),
            "dfo": controller.dfo.model_copy(update={"time_constant_s": all_["observer_time_s"]}),
            **_tables_with(controller, values),
        }
    )


def _tables_with(controller: Controller, values: Mapping[str, float]) -> dict[str, BaseModel]:
    found: dict[str, BaseModel] = {}
    for name in values:
        if name in TABLES:
            table, key = TABLES[name]
            part = found.get(table, getattr(controller, table))
            found[table] = part.model_copy(update={key: values[name]})
    return found


def _speed_control(controller: Controller, values: Mapping[str, float], all_: Mapping[str, float]) -> Wsc:
    wsc = controller.wsc
    gains = all_["proportional_gain"], all_["integral_gain"]
    if "pole_rad_s" in values:
        gains = pole_assignment(inertia_of(controller), values["pole_rad_s"])
    part, notch = wsc.lead, wsc.notch
    if "lead_deg" in values or "lead_hz" in values:
        normalisation = part.normalisation if part is not None else "high_frequency"
        part, notch = lead(all_["lead_deg"], all_["lead_hz"], normalisation), None
    elif any(name in values for name in PAPER_NOTCH):
        part = None
        notch = Notch(frequency_hz=all_["notch_hz"], width=all_["notch_width"], depth=all_["notch_depth"])
    return wsc.model_copy(
        update={
            "proportional_gain": gains[0],
            "integral_gain": gains[1],
            "filter_time_constant_s": all_["speed_filter_time_s"],
            "lead": part,
            "notch": notch,
        }
    )


def inertia_of(controller: Controller) -> float:
    """J_l/N² + J_m in kg m² for which (4) and (5) give a controller's gains."""
    wsc = controller.wsc
    return wsc.proportional_gain**2 / (4 * wsc.integral_gain) if wsc.integral_gain else 0.0


class Space:
    """Free parameters as points of the unit cube."""

    def __init__(self, bounds: Mapping[str, tuple[float, float]]) -> None:
        self.names = tuple(bounds)
        self._logarithmic = np.array([PARAMETERS[n].logarithmic and bounds[n][0] > 0 for n in self.names])
        self._low, self._high = (
            np.array([math.log(bounds[n][i]) if log else bounds[n][i] for n, log in self._by_name()])
            for i in (0, 1)
        )

    def _by_name(self) -> list[tuple[str, bool]]:
        return list(zip(self.names, self._logarithmic.tolist(), strict=True))

    @property
    def size(self) -> int:
        """How many are free."""
        return len(self.names)

    def values(self, point: Array) -> dict[str, float]:
        """Parameters at a point; what lies outside of the cube is brought to its border."""
        raw = self._low + np.clip(point, 0.0, 1.0) * (self._high - self._low)
        return {
            name: float(np.exp(value)) if log else float(value)
            for (name, log), value in zip(self._by_name(), raw, strict=True)
        }

    def point(self, values: Mapping[str, float]) -> Array:
        """Where parameters lie, brought into the cube."""
        raw = np.array([_log(values[name]) if log else values[name] for name, log in self._by_name()])
        return np.asarray(np.clip((raw - self._low) / (self._high - self._low), 0.0, 1.0))


def _log(value: float) -> float:
    return math.log(max(value, 1e-300))
