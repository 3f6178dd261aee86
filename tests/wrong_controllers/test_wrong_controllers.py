"""Controllers that bang, idle or turn the wrong way never pass; a right one does."""

from __future__ import annotations

import pytest

from hil.core.controller import load_controller
from tests.wrong_controllers.mutants import FACTORS, mutants_of
from tests.wrong_controllers.trying import Stage, Tried


@pytest.fixture(scope="module")
def stage() -> Stage:
    return Stage.of("acceptance")


def tried(stage: Stage, what: str, change: str) -> list[Tried]:
    return [one for one in stage.all_mutants(what) if one.mutant.what == what and one.mutant.change == change]


def test_every_number_is_changed_by_every_factor(stage: Stage) -> None:
    gain, phase = (load_controller(file) for file in stage.files)
    found = list(mutants_of(phase, gain))
    assert {one.change for one in found if one.what == "dfo.gear_ratio"} == {f"× {f:g}" for f in FACTORS}
    assert {"off", "dc", "centre", "the other one", "K_p off"} <= {one.change for one in found}
    assert all(one.controller is None or one.controller != phase for one in found)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("what", "change", "by"),
    [
        ("torque_limit_nm", "× 0.01", "stability_torque_request"),
        ("wsc.proportional_gain", "× 100", "stability_torque_request"),
        ("dfc.feedforward_time_constant_s", "× 100", "response_time"),
        ("dfo.gear_ratio", "× 10", "arrival"),
    ],
)
def test_what_bangs_idles_or_does_not_arrive_is_noticed_by_name(
    what: str, change: str, by: str, stage: Stage
) -> None:
    for one in tried(stage, what, change):
        assert any(name.endswith(f".{by}") for name in one.noticed), (one.file, one.noticed)


def test_the_right_controllers_pass(stage: Stage) -> None:
    own = stage.run(stage.files[0], None)
    assert stage.noticed(own) == ()
