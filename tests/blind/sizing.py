"""How large an effect is: its share in the outputs that no small change of the base parameters explains."""

from __future__ import annotations

import math
from collections.abc import Sequence
from copy import copy

import numpy as np
import numpy.typing as npt

from tests.blind.experiments import Experiment
from tests.blind.families import Family, Hidden
from tests.blind.plant import COARSE, Truth, read_by_sensors, true_outputs

Array = npt.NDArray[np.float64]

_STRIDE = 5  # every 5 ms: experiments and resonances end at 30 Hz
_CLOSE = 0.04  # relative: a size need not be met more closely
_TRIALS = 9


class Bench:
    """A base plant and its experiments, simulated once however many rulers measure on them."""

    def __init__(self, base: Truth, experiments: Sequence[Experiment]) -> None:
        self.base = base
        self.experiments = list(experiments)
        self.plain = self.outputs(base)
        self._slopes: dict[str, list[Array]] = {}

    def outputs(self, truth: Truth) -> list[Array]:
        """Samples x outputs of every experiment on `truth`."""
        return [true_outputs(truth, e, substeps=COARSE)[1] for e in self.experiments]

    def slopes(self, name: str) -> list[Array]:
        """What a small step of a base parameter does to every experiment's outputs, every `_STRIDE`th."""
        if name not in self._slopes:
            # a quarter percent keeps the change linear; drag may be zero
            value = self.base.parameters[name]
            other = self.base.with_parameter(name, value + (2.5e-3 * value if value > 0.0 else 1e-4))
            changed = zip(self.outputs(other), self.plain, strict=True)
            self._slopes[name] = [(outputs - plain)[::_STRIDE] for outputs, plain in changed]
        return self._slopes[name]

    def only(self, number: int) -> Bench:
        """The same with one of the experiments alone."""
        one = copy(self)
        one.experiments, one.plain = [self.experiments[number]], [self.plain[number]]
        one._slopes = {name: [slopes[number]] for name, slopes in self._slopes.items()}
        return one


class Ruler:
    """Measures effects in units of the noise, for one base plant, its experiments and noise levels.

    Residuals are divided by the channels' noise, and the span of the base parameters' sensitivities and of
    the initial speeds is projected out: what is left no refit of the base model can take away. A refit has no
    bounds here. Without `refit` all that an effect does is measured.
    """

    def __init__(self, bench: Bench, noise: Array, not_fitted: str = "", *, refit: bool = True) -> None:
        self._bench = bench
        self._noise = noise
        columns = self._sensitivities(not_fitted) if refit else []
        self._span = np.linalg.qr(np.stack(columns, axis=1))[0] if columns else None

    def residual(self, *hidden: Hidden) -> Array:
        """What effects do to the outputs, in units of noise, projected; samples x 3 flattened."""
        laws = {name: value for h in hidden for name, value in h.laws.items()}
        sensors = tuple(s for h in hidden for s in h.sensors)
        base = self._bench.base
        truth = Truth(base.kind, base.parameters, laws, sensors)
        rows = []
        all_outputs = self._bench.outputs(truth) if laws else self._bench.plain
        for outputs, plain in zip(all_outputs, self._bench.plain, strict=True):
            change = read_by_sensors(truth, outputs, np.zeros_like(outputs)) - plain
            rows.append(self._shown(change[::_STRIDE]))
        return self._projected(np.concatenate(rows))

    def share(self, *hidden: Hidden) -> float:
        """rms of the effect over rms of the noise, on the channel that shows it best."""
        return largest_share(self.residual(*hidden))

    def share_of_truth(self, truth: Truth) -> float:
        """The share of the difference between another plant and the base plant."""
        changed = zip(self._bench.outputs(truth), self._bench.plain, strict=True)
        rows = [self._shown((outputs - plain)[::_STRIDE]) for outputs, plain in changed]
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
            if error < abs(math.log(max(best[1], 1e-9) / share)):
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
        if self._span is None:
            return change
        return np.asarray(change - self._span @ (self._span.T @ change))

    def _shown(self, change: Array) -> Array:
        return np.asarray((change / self._noise).ravel())

    def _sensitivities(self, not_fitted: str) -> list[Array]:
        bench = self._bench
        columns = [
            np.concatenate([self._shown(slope) / 2.5e-3 for slope in bench.slopes(name)])
            for name in bench.base.parameters
            if name != not_fitted
        ]
        speed = np.array([bench.base.parameters["gear_ratio"], 1.0, 0.0])
        lengths = [len(plain[::_STRIDE]) for plain in bench.plain]
        for number in range(len(lengths)):
            rows = [np.tile(speed * (i == number), (length, 1)) for i, length in enumerate(lengths)]
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
    return float(abs(first @ second) / max(float(np.linalg.norm(first) * np.linalg.norm(second)), 1e-12))
