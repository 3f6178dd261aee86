"""How sure a name is, from what was tried beside it."""

import pytest

from hil.analysis.diagnosis.fit._coordinates import Hypothesis
from hil.analysis.diagnosis.search._search import Found, search
from hil.analysis.diagnosis.tell._confidence import alternatives_of, confidence_of, drop_of, rivals
from hil.core.channels import OUTPUTS
from hil.core.model import EffectUse
from tests.hil.analysis.diagnosis.one_recording import MODEL, one_problem

OFFSET = EffectUse("sensor_offset", {"channel": OUTPUTS[2], "offset": 20.0})


@pytest.fixture(scope="module")
def found() -> Found:
    return search(one_problem(OFFSET), Hypothesis(MODEL), lambda text: None)


def test_a_name_without_rivals_is_sure(found: Found) -> None:
    assert all(margin > 100.0 for _, margin in rivals(found, 0))
    assert confidence_of(found, 0) > 0.9
    assert drop_of(found, 0) == pytest.approx(found.base.total - found.best.total)


def test_nothing_is_an_alternative_to_nothing(found: Found) -> None:
    assert alternatives_of(found, "none") == ()
