"""Friction and contact by the laws of other authors, under the registry's names for what they are."""

from __future__ import annotations

import math

import numpy as np

from tests.blind.families import Draw, Family, Hidden, Setting
from tests.blind.reference.contact import HUNT_CROSSLEY, KELVIN_VOIGT

_WIDE_GAP = 0.003  # rad


def _friction(id: str, rng: np.random.Generator, setting: Setting, **laws: float) -> Family:
    """Dry friction that grows with its torque; `laws` give the rest, a Stribeck peak in its shares."""
    del rng
    stribeck = laws.pop("stribeck", 0.0)
    turn = laws.pop("turn", 0.0)

    def of_size(size: float) -> Hidden:
        own = {"coulomb": size, "stribeck": stribeck * size} | laws
        if turn:
            own["bristle_stiffness"] = size / turn
        return Hidden(id, own, (), {"torque_nm": size})

    return Family(id, 0.01 * setting.scale, 6.0 * setting.scale, of_size)


def _lugre(rng: np.random.Generator, setting: Setting) -> Family:
    """Soft bristles with damping of their own, and a Gaussian Stribeck curve (Canudas de Wit et al. 1995)."""
    return _friction(
        "coulomb_friction",
        rng,
        setting,
        stribeck=rng.uniform(0.2, 0.6),
        stribeck_speed=rng.uniform(1.0, 8.0),
        turn=math.exp(rng.uniform(math.log(1e-3), math.log(0.05))),
        bristle_damping=rng.uniform(0.0, 0.5),
    )


def _dahl(rng: np.random.Generator, setting: Setting) -> Family:
    """Friction that turns around over an angle, its hysteresis without a peak (Dahl 1968)."""
    return _friction(
        "coulomb_friction",
        rng,
        setting,
        turn=math.exp(rng.uniform(math.log(0.01), math.log(0.3))),
        bristle_damping=0.0,
        bristle_exponent=float(rng.choice([0.7, 1.0, 1.5])),
    )


def _exponential(rng: np.random.Generator, setting: Setting) -> Family:
    """The peak at rest falls with exp(-|v|/v_s) (Bo and Pavelescu 1982), not with its square."""
    return _friction(
        "coulomb_friction",
        rng,
        setting,
        stribeck=rng.uniform(0.4, 1.2),
        stribeck_speed=rng.uniform(3.0, 20.0),
        stribeck_power=1.0,
    )


def _contact(form: float, id: str = "backlash") -> Draw:
    def draw(rng: np.random.Generator, setting: Setting) -> Family:
        restitution = rng.uniform(0.3, 0.8)
        stiffness, damping = (setting.parameters[n] for n in ("shaft_stiffness", "shaft_damping"))
        speed = rng.uniform(4.0, 20.0)  # rad/s at which flanks meet, for Hunt and Crossley's factor
        ratio = -math.log(restitution) / math.hypot(math.pi, math.log(restitution))

        def of_size(size: float) -> Hidden:
            # the smaller the gap, the less of it: without free play the plant is the base plant
            share = size / (size + _WIDE_GAP)
            added = (
                1.5 * (1.0 - restitution) / speed * stiffness
                if form == HUNT_CROSSLEY
                else 5.0 * ratio * damping
            )
            laws = {"half_gap": size, "contact_form": form, "contact_damping": share * added}
            return Hidden(id, laws, (), {"half_gap_rad": size})

        return Family(id, 1e-4, 0.03, of_size)

    return draw


OTHER_LAWS: dict[str, Draw] = {
    "coulomb_friction:lugre": _lugre,
    "coulomb_friction:dahl": _dahl,
    "coulomb_friction:exponential": _exponential,
    "backlash:kelvin_voigt": _contact(KELVIN_VOIGT),
    "backlash:hunt_crossley": _contact(HUNT_CROSSLEY),
}


def other_law_fits(id: str, kind: str) -> bool:
    """Free play needs shafts."""
    return kind != "rigid" or id.startswith("coulomb_friction")
