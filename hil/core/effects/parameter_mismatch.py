"""No effect is missing: a parameter of the model has the wrong value."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from hil.core.effects._effect import Effect, Parameter, Stage
from hil.core.effects._law import Law


def _correct(chain: dict[str, float], values: Mapping[str, Any]) -> None:
    chain[str(values["parameter"])] = values["value"]


EFFECT = Effect(
    id="parameter_mismatch",
    title="Parameter mismatch",
    stage=Stage.MODEL,
    summary="No effect is missing: a parameter of the model has the wrong value.",
    signature="The gap follows the model's own sensitivity to that parameter.",
    shown_by="The test that identified the parameter.",
    parameters=(Parameter("value", "parameter's", -1e12, 1e12, "the correct value", fitted=False),),
    text_parameters=("parameter",),
    needs=("rigid", "two_inertia", "three_inertia", "transfer_function"),
    law=Law(chain=_correct),
)
