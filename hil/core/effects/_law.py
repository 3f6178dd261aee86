"""How an effect acts: plain functions on plain numbers, which the kernels of `hil.plant` compile.

Both integrators call the same functions, so that a law is written once. They take

- `motion`: where the driveline is and how it moves, a `Motion`;
- `chain`: its linear numbers, a `Chain`;
- `memory`: the one number that the effect keeps from step to step (0 if it keeps none);
- `values`: the effect's own numbers, a tuple in the order of its parameters.

They may use arithmetic, comparisons, `math`, and other plain functions.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

from hil.core.chain import Chain

Values = tuple[float, ...]


class Motion(NamedTuple):
    """Angles in rad, speeds in rad/s; wheel-side ones are means of both sides."""

    rotor_speed: float  # against the housing
    wheel_speed: float
    vehicle_speed: float  # as a wheel that does not slip
    twist: float  # of shafts and play, wheel side
    twist_rate: float
    stretch: float  # of the shafts alone
    tyre_twist: float
    rotor_angle: float
    wheel_angle: float


Force = Callable[[Motion, Chain, float, Values], float]


@dataclass(frozen=True)
class Law:
    """Where an effect acts and how; what is None it leaves alone. Torques in N m, wheel side unless stated.

    Args:
        chain: changes the linear numbers (a dict of `Chain`'s fields) by the effect's values.
        prepare: the values that the other functions are given, of the chain and the effect's own values.
        shape: the torque that a request becomes, without memory: (torque, values).
        limit: what the motor gives of a torque at the rotor's speed in rad/s: (torque, speed, values). The
            torque of a request is held over a sample, and its limit with it.
        slope: the steepest slope of the acting torque in N m/s: (values).
        stretch: what is left of a twist for the shafts: (twist, chain, memory, values).
        shaft: torque of the shafts beside stiffness and damping.
        loss: torque against positive motion of the rotor, rotor side.
        dry: largest friction that holds the rotor, rotor side; it acts against the motion, and sticks.
        load: torque against positive motion of the vehicle.
        tyre: torque that the tyre takes from the wheel beside stiffness and damping.
        tyre_rate: rate in rad/s that the tyre's twist gains beside wheel speed less vehicle speed.
        begin: the memory at a start with a shaft torque: (torque, chain, values).
        turned: the memory at a start when the rotor has turned at a speed for long: (speed, chain, values).
        leap: what `shaft` is within a step beyond a straight line between its ends, where it sets in or ends
            there: (before, after, chain, memory, values, h), two motions and the seconds between them; torque
            at the beginning, and its rise. Not asked where the memory stays what it was: nothing leaps then.
        remember: the memory after `h` seconds: (before, after, chain, memory, values, h); two motions.
        steps: in how many parts a sample of `dt` seconds is to be cut: (chain, values, dt).
        steady: whether forces are constant for these values: then they are not computed anew.
        follows: the angle that the law follows, and nothing else of the motion; fits use the measured one.
        reads: which number of a sensor the effect changes.
        sides: whether the equations of both sides read its numbers.
    """

    chain: Callable[[dict[str, float], Mapping[str, Any]], None] | None = None
    prepare: Callable[[Chain, Values], Values] | None = None
    shape: Callable[[float, Values], float] | None = None
    limit: Callable[[float, float, Values], float] | None = None
    slope: Callable[[Values], float] | None = None
    stretch: Callable[[float, Chain, float, Values], float] | None = None
    shaft: Force | None = None
    leap: Callable[[Motion, Motion, Chain, float, Values, float], tuple[float, float]] | None = None
    loss: Force | None = None
    dry: Force | None = None
    load: Force | None = None
    tyre: Force | None = None
    tyre_rate: Force | None = None
    begin: Callable[[float, Chain, Values], float] | None = None
    turned: Callable[[float, Chain, Values], float] | None = None
    remember: Callable[[Motion, Motion, Chain, float, Values, float], float] | None = None
    steps: Callable[[Chain, Values, float], int] | None = None
    steady: Callable[[Any], Any] | None = None
    follows: Literal["wheel", "rotor"] | None = None
    reads: Literal["gain", "offset", "delay_s", "step", "lag_s"] | None = None
    sides: bool = False

    @property
    def compiled(self) -> bool:
        """Whether the kernels execute it, rather than the chain or a sensor."""
        return self.sides or any(
            function is not None
            for function in (
                self.shape,
                self.limit,
                self.slope,
                self.shaft,
                self.loss,
                self.dry,
                self.load,
                self.tyre,
                self.tyre_rate,
            )
        )
