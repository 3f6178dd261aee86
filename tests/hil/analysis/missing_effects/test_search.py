"""Steps of the search that a data set has shown to be needed."""

from __future__ import annotations

import pytest

from hil.analysis.missing_effects._candidates import Candidates
from hil.analysis.missing_effects._hypothesis import Hypothesis
from hil.analysis.missing_effects._search import _among_losses
from hil.core.model import EffectUse
from tests.hil.analysis.missing_effects.chain import problem_about
from tests.hil.analysis.missing_effects.two_masses import base, braked


def test_a_loss_that_bends_gives_way_to_a_dry_and_a_viscous_one() -> None:
    """Rolling and air took the place of both, and no name that joined them took off half of what stayed.

    The mass rests below its dry friction, which neither law with a dry part does: either may be likelier.
    """
    model = base()
    done = Candidates(problem_about(model, braked(0.6, 0.7)))
    alone = done.fitted(Hypothesis(model, dict(model.parameters)), None)
    done.go_on_from(alone)
    rolling = EffectUse("running_resistance", {"rolling_nm": 0.6, "aero_nms2_rad2": 0.02})
    first = done.fitted(alone.point.hypothesis.with_term(rolling), alone)
    found = _among_losses(done, first, lambda _: None)
    sizes = {use.id: use.values for use in found.point.hypothesis.terms}
    assert done.score(found) > done.score(first) + 100.0
    assert sizes["load_viscous_drag"]["coefficient_nms_rad"] == pytest.approx(0.7, rel=0.06)
    dry = sizes.get("load_coulomb_friction", {}).get("torque_nm")
    assert (dry or sizes["running_resistance"]["rolling_nm"]) == pytest.approx(0.6, rel=0.06)
