"""Any case of the set, whichever group it is of."""

from __future__ import annotations

from tests.blind.cases import Case, draw_case
from tests.blind.later_cases import draw_later_case
from tests.blind.later_groups import LATER_GROUPS
from tests.blind.specs import Spec


def draw(seed: int, spec: Spec, length: float = 1.0) -> Case:
    """The case that `seed` and `spec` name, always the same."""
    later = spec.group in LATER_GROUPS
    return (draw_later_case if later else draw_case)(seed, spec, length)
