"""A diagnosis in its form of `diagnosis.json`, and told from what a search found."""

import json

from hil.analysis.diagnosis import diagnose
from hil.analysis.diagnosis.findings.result import derived_of
from hil.core.channels import OUTPUTS
from hil.core.model import EffectUse
from tests.hil.analysis.diagnosis.one_recording import MODEL, recorded


def test_a_small_diagnosis_is_told_whole() -> None:
    offset = EffectUse("sensor_offset", {"channel": OUTPUTS[2], "offset": 20.0})
    found = diagnose(MODEL, [recorded(offset)], [recorded(offset, seed=2)])
    told = json.loads(json.dumps(found.as_json()))
    assert (told["verdict"], [e["id"] for e in told["effects"]]) == ("named", ["sensor_offset"])
    assert told["effects"][0]["where"]["channels"] == [OUTPUTS[2]]
    gap = told["holdout_gap"][OUTPUTS[2]]
    assert gap["after"] < 1.1 * gap["noise_floor"] < gap["before"]
    assert len(found.overlays) == 1


def test_what_is_derived_of_friction_needs_none_of_its_optional_parameters():
    use = EffectUse("coulomb_friction", {"torque_nm": 2.0, "turn_rad": 0.1})
    assert derived_of(use) == {"breakaway_forwards_nm": 2.0, "breakaway_backwards_nm": 2.0}
