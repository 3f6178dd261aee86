"""Numbers of a chain with shafts by its measured frequency responses: the same from any base of its kind.

Resonances that are far off leave a fit in time no slope to follow; gain and phase do, from several starts.
What is nonlinear bends them, so these are numbers to start from and no more.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import numpy.typing as npt

from hil.analysis.frequency_response import Experiment, estimate
from hil.analysis.identification import ChainFit, fit_chain
from hil.analysis.missing_effects._hypothesis import Hypothesis
from hil.analysis.missing_effects._series import Series
from hil.core.channels import OUTPUTS
from hil.core.errors import BadInputError
from hil.core.model import Model

Flags = npt.NDArray[np.bool_]


def numbers_by_response(model: Model, series: Sequence[Series]) -> Hypothesis | None:
    """The numbers alone as frequency responses show them.

    None for a rigid model, where a load brakes the wheels, or where recordings give no response of the motor
    speed and another output.
    """
    has = np.all([one.has for one in series], axis=0)
    if model.kind not in ("two_inertia", "three_inertia") or not has[0] or has.sum() < 2 or model.load_input:
        return None
    found = next(_chains(model, series, has), None)
    if found is None:
        return None
    numbers = {
        name: float(found.model.parameters.get(name, value)) for name, value in model.parameters.items()
    }
    return Hypothesis(model, numbers)


def _chains(model: Model, series: Sequence[Series], has: Flags) -> Iterator[ChainFit]:
    """Chains by all recordings and channels; where those are not coherent, by fewer or by one recording."""
    fewer = [has & np.array(kept) for kept in ((True, True, True), (True, False, True), (True, True, False))]
    alone = sorted(series, key=lambda one: -len(one.torque))
    for together in (series, *([one] for one in alone)):
        for channels in fewer:
            if channels.sum() < 2:
                continue
            try:
                yield fit_chain(estimate([_experiment(one, channels) for one in together]), model.kind)
            except (BadInputError, np.linalg.LinAlgError):
                continue


def _experiment(one: Series, has: Flags) -> Experiment:
    names = tuple(name for name, there in zip(OUTPUTS, has, strict=True) if there)
    outputs = np.ascontiguousarray(one.samples[:, has].T)
    return Experiment(one.name, one.dt, one.torque, outputs, names, hold_s=one.dt)
