"""What was found."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import numpy.typing as npt

from hil.analysis.missing_effects._series import Series
from hil.core.channels import OUTPUTS
from hil.core.model import EffectUse, Model
from hil.plant import angle_of, as_read, replayed

Array = npt.NDArray[np.float64]
Verdict = Literal["named", "none", "unknown"]


@dataclass(frozen=True)
class Named:
    """A name with the probability that it is right; `alike` are names that the data cannot tell from it.

    `model` is the hypothesis that a name is taken from; None where it is that of the outcome.
    """

    use: EffectUse
    confidence: float
    standard_error: dict[str, float]
    alike: tuple[str, ...] = ()
    separating_test: str = ""
    model: Model | None = None

    @property
    def id(self) -> str:
        """The effect's id."""
        return self.use.id


@dataclass(frozen=True)
class Curve:
    """A torque in N m that a balance measures, over what it follows; means of bins.

    `effect` is the name whose torque it is, `law_nm` its law there; '' and None of what stays without one.
    `share` of the torque's variance is explained so.
    """

    effect: str
    over: str
    at: Array
    torque_nm: Array
    law_nm: Array | None
    share: float


@dataclass(frozen=True)
class Replay:
    """A stretch of a recording, to be simulated as `hil simulate` does it, once by each model."""

    series: Series
    _shown: list[tuple[Model, Array]] = field(default_factory=list, init=False, repr=False, compare=False)

    def outputs(self, model: Model) -> Array:
        """What a model shows at every sample, n x 3: `OUTPUTS`, those of an angle by what it turns by."""
        return as_read(self._simulated(model)[:, : len(OUTPUTS)], self.series.of_angle, self.series.dt)

    def acting(self, model: Model) -> Array:
        """Motor torque in N m that acts in a model, at every sample (n,)."""
        return self._simulated(model)[:, len(OUTPUTS)]

    def angle(self, model: Model) -> Array:
        """Angles of a model in rad where they were recorded, n x 3, from the first reading on; else NaN."""
        one, shown = self.series, self._simulated(model)[:, : len(OUTPUTS)]
        found = np.full(shown.shape, np.nan)
        for column in np.flatnonzero(one.of_angle).tolist():
            found[:, column] = angle_of(shown[:, column], one.dt, float(one.angle[0, column]))
        return found

    def _simulated(self, model: Model) -> Array:
        for known, outputs in self._shown:
            if known == model:
                return outputs
        one = self.series
        begins = one.first_wheel_angle_rad
        shown = replayed(model, one.torque, one.dt, one.samples, one.load, begins, one.of_angle)
        none = np.zeros(len(one.torque))  # a model of functions may lack one
        names = (*OUTPUTS, "motor_torque_nm")
        self._shown.append((model, np.column_stack([shown.get(name, none) for name in names])))
        return self._shown[-1][1]


@dataclass(frozen=True)
class Outcome:
    """All that `explain_gap` has to say.

    `numbers` by name: base, found, standard error. `model` is given back, `alone` is the base with the
    numbers that suit the recordings best where nothing joins them. `curves` show what stays. `noise` (3,) is
    the proven standard deviation of one sample, NaN where a channel was not recorded. `as_likely` are models
    drawn from what the fit knows of its numbers. `steadied` is a drag in the model without a name: it keeps
    it from drifting where recordings do not excite what would name it. `unfinished` says why the search ended
    before it was through, if it did: names are candidates then.
    """

    verdict: Verdict
    effects: tuple[Named, ...]
    alternatives: tuple[Named, ...]
    numbers: dict[str, tuple[float, float, float]]
    base_was_far: bool
    model: Model
    alone: Model
    curves: tuple[Curve, ...]
    seconds: float
    noise: Array
    as_likely: tuple[Model, ...]
    fitted: tuple[Replay, ...]
    held_out: tuple[Replay, ...]
    steadied: EffectUse | None = None
    unfinished: str = ""
