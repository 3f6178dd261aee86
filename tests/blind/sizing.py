"""How large an effect is: its share in the outputs that no small change of the base parameters explains."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from tests.blind.experiments import Experiment
from tests.blind.families import Family, Hidden
from tests.blind.plant import COARSE, Truth, read_by_sensors, true_outputs

Array = npt.NDArray[np.float64]

_STRIDE = 5  # every 5 ms: experiments and resonances end at 30 Hz
_CLOSE = 0.04  # relative: a size need not be met more closely
_TRIALS = 9


class Ruler:
    """Measures effects in units of the noise, for one base plant, its experiments and noise levels.

    Residuals are divided by the channels' noise, and the span of the base parameters' sensitivities and of
    the initial speeds is projected out: what is left no refit of the base model can take away.
    """

    def __init__(
        self, base: Truth, experiments: Sequence[Experiment], noise: Array, not_fitted: str = ""
    ) -> None:
        self._base = base
        self._experiments = list(experiments)
        self._noise = noise
        self._plain = [true_outputs(base, e, substeps=COARSE)[1] for e in self._experiments]
        self._span = np.linalg.qr(np.stack(self._sensitivities(not_fitted), axis=1))[0]

    def residual(self, *hidden: Hidden) -> Array:
        """What effects do to the outputs, in units of noise, projected; samples x 3 flattened."""
        laws = {name: value for h in hidden for name, value in h.laws.items()}
        sensors = tuple(s for h in hidden for s in h.sensors)
        truth = Truth(self._base.kind, self._base.parameters, laws, sensors)
        rows = []
        for experiment, plain in zip(self._experiments, self._plain, strict=True):
            outputs = true_outputs(truth, experiment, substeps=COARSE)[1] if laws else plain
            rows.append(self._shown(read_by_sensors(truth, outputs, np.zeros_like(outputs)) - plain))
        return self._projected(np.concatenate(rows))

    def share(self, *hidden: Hidden) -> float:
        """rms of the effect over rms of the noise, on the channel that shows it best."""
        return largest_share(self.residual(*hidden))

    def share_of_truth(self, truth: Truth) -> float:
        """The share of the difference between another plant and the base plant."""
        rows = [
            self._shown(true_outputs(truth, e, substeps=COARSE)[1] - plain)
            for e, plain in zip(self._experiments, self._plain, strict=True)
        ]
        return largest_share(self._projected(np.concatenate(rows)))

    def size_for(self, family: Family, share: float) -> tuple[float, float]:
        """(size, share reached): the size whose share is wanted, or the end of the family's range."""
        low, high = math.log(family.smallest), math.log(family.largest)
        at = 0.5 * (low + high)
        best = (math.exp(at), math.inf)
        for _ in range(_TRIALS):
            reached = self.share(family.of_size(math.exp(at)))
            if not math.isfinite(reached):
                high = at
                at = 0.5 * (low + high)
                continue
            error = abs(math.log(max(reached, 1e-9) / share))
            if error < abs(math.log(best[1] / share)):
                best = (math.exp(at), reached)
            if error < _CLOSE:
                break
            if reached > share:
                high = at
            else:
                low = at
            # most effects grow in proportion to their size: try that first, halve if it leads outside
            guess = at + math.log(share / max(reached, 1e-9))
            at = guess if low + 0.02 < guess < high - 0.02 else 0.5 * (low + high)
        return best

    def _projected(self, change: Array) -> Array:
        return np.asarray(change - self._span @ (self._span.T @ change))

    def _shown(self, outputs: Array) -> Array:
        return np.asarray((outputs[::_STRIDE] / self._noise).ravel())

    def _sensitivities(self, not_fitted: str) -> list[Array]:
        columns = []
        for name, value in self._base.parameters.items():
            if name == not_fitted:
                continue
            # a quarter percent keeps the change linear; drag may be zero
            step = 2.5e-3 * value if value > 0.0 else 1e-4
            other = self._base.with_parameter(name, value + step)
            columns.append(
                np.concatenate(
                    [
                        self._shown(true_outputs(other, e, substeps=COARSE)[1] - plain) / 2.5e-3
                        for e, plain in zip(self._experiments, self._plain, strict=True)
                    ]
                )
            )
        speed = np.array([self._base.parameters["gear_ratio"], 1.0, 0.0])
        for number in range(len(self._plain)):
            rows = [np.tile(speed * (i == number), (len(p), 1)) for i, p in enumerate(self._plain)]
            columns.append(np.concatenate([self._shown(r) for r in rows]))
        return columns

    def unexplained(self, trace: Array, others: Sequence[Hidden]) -> float:
        """What is left of a trace's share when the one of `others` that is most alike explains its part."""
        left = largest_share(trace)
        for other in others:
            direction = self.residual(other)
            length = float(np.linalg.norm(direction))
            if length > 0.0 and np.isfinite(length):
                direction /= length
                left = min(left, largest_share(trace - direction * float(direction @ trace)))
        return left


def largest_share(residual: Array) -> float:
    """Largest rms over the three channels of a residual in units of noise."""
    return float(np.max(np.sqrt(np.mean(residual.reshape(-1, 3) ** 2, axis=0))))


def likeness(first: Array, second: Array) -> float:
    """|cos| of two residuals: near 1, no fit can tell the effects apart."""
    return float(abs(first @ second) / max(np.linalg.norm(first) * np.linalg.norm(second), 1e-12))
