"""Effects that the registry does not have: the honest answer is that something unknown is there."""

from __future__ import annotations

import math

import numpy as np

from tests.blind.families import Draw, Family, Hidden, Setting


def _one(id: str, law: str, smallest: float, largest: float, **fixed: tuple[float, float]) -> Draw:
    """A law grows with the size; `fixed` constants are drawn from their ranges."""

    def draw(rng: np.random.Generator, setting: Setting) -> Family:
        del setting
        drawn = {name: rng.uniform(*ends) for name, ends in fixed.items()}
        return Family(id, smallest, largest, lambda size: Hidden(id, {law: size, **drawn}))

    return draw


def _absorber(rng: np.random.Generator, setting: Setting) -> Family:
    del setting
    omega, ratio = 2.0 * math.pi * rng.uniform(4.0, 9.0), rng.uniform(0.02, 0.06)

    def of_size(size: float) -> Hidden:
        return Hidden(
            "outside:wheel_absorber",
            {
                "absorber_inertia": size,
                "absorber_stiffness": size * omega**2,
                "absorber_damping": 2.0 * ratio * omega * size,
            },
        )

    return Family("outside:wheel_absorber", 0.02, 60.0, of_size)


def _speed_mount(rng: np.random.Generator, setting: Setting) -> Family:
    """A mount whose bushes stiffen with speed: no fixed mode fits at all speeds."""
    del setting
    omega, ratio = 2.0 * math.pi * rng.uniform(12.0, 18.0), rng.uniform(0.06, 0.12)
    stiffening = rng.uniform(0.1, 0.25)

    def of_size(size: float) -> Hidden:
        inertia = 1.0 / size
        return Hidden(
            "outside:speed_dependent_mount",
            {
                "has_mount": 1.0,
                "housing_inertia": inertia,
                "mount_stiffness": inertia * omega**2,
                "mount_damping": 2.0 * ratio * omega * inertia,
                "mount_speed_stiffening": stiffening,
            },
        )

    return Family("outside:speed_dependent_mount", 1e-3, 1.5, of_size)


OUTSIDERS: dict[str, Draw] = {
    "outside:torque_fade": _one("outside:torque_fade", "torque_fade", 5e-3, 0.5, fade_time_s=(6.0, 15.0)),
    "outside:shaft_asymmetry": _one("outside:shaft_asymmetry", "shaft_asymmetry", 5e-3, 1.5),
    "outside:shaft_drift": _one("outside:shaft_drift", "shaft_drift", 1e-4, 0.03),
    "outside:wheel_absorber": _absorber,
    "outside:fixed_tone": _one("outside:fixed_tone", "tone_nm", 0.1, 300.0, tone_hz=(3.0, 16.0)),
    "outside:speed_dependent_mount": _speed_mount,
}

#: Joined after the first cases were drawn; what an effect of the registry, later ones too, explains of them
#: does not count. Grease that is squeezed out of a joint, or a bush's orifice, damps by the square of the
#: twist rate. No law of the registry can stand in: every other dissipation in the shafts or on the rotor
#: (damping, hysteresis, friction, flanks) loses energy over amplitude with a power of at most two, this one
#: with three, and a stiffness by any power loses none.
LATER_OUTSIDERS: dict[str, Draw] = {
    "outside:squeeze_damping": _one("outside:squeeze_damping", "squeeze_damping", 0.05, 300.0),
}


def outsider_fits(id: str, kind: str) -> bool:
    """An absorber on the wheel needs a wheel of its own; a rigid driveline only shows fading."""
    if kind == "rigid":
        return id == "outside:torque_fade"
    return id != "outside:wheel_absorber" or kind == "three_inertia"
