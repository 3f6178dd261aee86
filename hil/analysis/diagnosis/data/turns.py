"""How far an axle turned by its speeds, and by what its torque must have done.

Angles from speeds that drift hold slow swings of any shape; here is what can be stated in spite of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.thresholds import AGAINST, DRIFT_S, IN_PROPORTION, LIKE, PUSHED_RAD, TOO_FAST
from hil.analysis.diagnosis.data.trace import Trace
from hil.core.channels import INPUT, OUTPUTS
from hil.core.errors import BadInputError
from hil.core.errors.wording import multiple

Array = npt.NDArray[np.float64]


@dataclass
class Pair:
    """Sums of squares and of products of two things that go together: `y` should equal `x`."""

    xx: float = 0.0
    yy: float = 0.0
    xy: float = 0.0
    count: int = 0

    def add(self, x: Array, y: Array) -> None:
        """Count readings of both."""
        self.xx, self.yy, self.xy = self.xx + float(x @ x), self.yy + float(y @ y), self.xy + float(x @ y)
        self.count += len(x)

    @property
    def correlation(self) -> float:
        """Cosine between the two: 1 for equal, -1 for opposite ones."""
        return self.xy / max(float(np.sqrt(self.xx * self.yy)), 1e-30)

    @property
    def factor(self) -> float:
        """How much larger y is than x; noise in either makes no difference to first order."""
        return float(np.sqrt(self.yy / max(self.xx, 1e-30)))

    @property
    def sizes(self) -> tuple[float, float]:
        """Rms of x and of y."""
        count = max(self.count, 1)
        return float(np.sqrt(self.xx / count)), float(np.sqrt(self.yy / count))


def pushes_of(traces: list[Trace], column: int, gear_ratio: float, per_impulse: float) -> list[Pair]:
    """How far the axle turned by a speed (y), and by the torque's impulse (x), rad wheel side.

    Even turning and an even change of speed are left out: offsets, friction, resistance.

    Args:
        per_impulse: wheel speed for 1 N m s of motor torque.

    Returns:
        The views that no slow drift makes up; none where the torque hardly pushes.
    """
    uneven, brisk = Pair(), Pair()
    ratio = (gear_ratio, 1.0)[column]
    for t in traces:
        if t.has[column]:
            count, step = len(t.measured), t.block * t.dt
            drive = t.torque if t.load is None else t.torque - t.load / gear_ratio
            impulse = np.cumsum(drive)[t.block - 1 : count * t.block : t.block] * t.dt
            pushed = np.cumsum(impulse) * step * per_impulse
            turned = np.cumsum(t.measured[:, column]) * step / ratio
            for pair, degree in ((uneven, 2), (brisk, drift_degree(turned, step))):
                by_torque = around(degree, pushed)
                if np.std(by_torque) > PUSHED_RAD[column]:
                    pair.add(by_torque, around(degree, turned))
    return [uneven, brisk] if brisk.count else []


def refused_push(pushes: dict[str, list[Pair]], fine: list[str]) -> BadInputError | None:
    """Whether torque moves the axle the right way, and no more than it can.

    Args:
        fine: channels that are not rounded coarsely: the turns of others come in steps of any size.
    """
    known = {c: pairs for c, pairs in pushes.items() if pairs}
    against = [
        c
        for c, pairs in known.items()
        if all(p.correlation < AGAINST and LIKE[0] < p.factor < LIKE[1] for p in pairs)
    ]
    if len(against) == len(OUTPUTS[:2]):
        return BadInputError(
            f"{INPUT} looks inverted: both speeds fall when torque pushes",
            fix="invert the sign of the channel",
        )
    if against:
        return BadInputError(
            f"{against[0]} looks inverted: it falls when torque pushes",
            fix=f"invert the sign of the channel, or of {INPUT}",
        )
    for channel, pairs in known.items():
        if channel in fine and all(p.correlation > -AGAINST and p.factor > TOO_FAST for p in pairs):
            return BadInputError(
                f"{channel} changes {multiple(pairs[0].factor)} as fast as the torque can make it",
                fix="check its unit, and that the model belongs to this axle",
            )
    return None


def beyond_drift(uneven: Pair, brisk: Pair) -> list[Pair]:
    """The views of two things that a slow drift of either cannot make up.

    Args:
        uneven: all that is not even motion.
        brisk: what of it is faster than drift.
    """
    if brisk.count:
        return [uneven, brisk]
    return [uneven] if uneven.count and abs(uneven.correlation) > IN_PROPORTION else []


def drift_degree(angle: Array, step: float) -> int:
    """Degree of the polynomial that follows what a slow drift of a speed adds to its angle.

    A sine through x radians either way is followed to a hundredth by a degree two or three above x.
    """
    return 3 + round(np.pi * len(angle) * step / DRIFT_S)


def around(degree: int, values: Array) -> Array:
    """`values` (n,) or (n x channels) without their best polynomial of `degree`."""
    basis = _polynomials(len(values), min(degree, len(values) - 1))
    return np.asarray(values - basis @ (basis.T @ values))


@lru_cache(maxsize=16)
def _polynomials(count: int, degree: int) -> Array:
    """An orthonormal basis of the polynomials up to `degree` at `count` even points, one a column."""
    return np.linalg.qr(np.polynomial.legendre.legvander(np.linspace(-1.0, 1.0, count), degree))[0]
