"""What the doctor prints and its exit codes, with a simulated bench here and in another process."""

import json

import pytest

from tests.hil.cli.test_commands import hil
from tests.hil.cli.test_sim_bench import serving


def test_a_bench_that_is_well_in_words_and_as_json():
    done = hil("bench", "doctor", "sim", "--for", "0.5")
    assert "no fault found" in done.stdout
    assert "rear left: NMT pre-operational, drive switch on disabled" in done.stdout
    assert json.loads(hil("bench", "doctor", "sim", "--for", "0.5", "--json").stdout)["verdict"] == "fine"


@pytest.mark.slow
def test_a_bench_that_is_not_there(tmp_path):
    text = hil("bench", "sim", "sim", "--port", "0", "--for", "0.1", "--json").stdout
    (tmp_path / "net.toml").write_text(json.loads(text)["bench_file"])
    done = hil("bench", "doctor", tmp_path / "net.toml", "--for", "0.2", code=3)
    assert "neither RMCU nor dynos answer" in done.stdout
    assert "Traceback" not in done.stderr


@pytest.mark.slow
def test_what_is_wrong_with_a_bench_in_another_process(tmp_path):
    with serving(tmp_path) as (_, file):
        well = json.loads(hil("bench", "doctor", file, "--json").stdout)
        assert well["verdict"] == "fine"
        wrong = tmp_path / "wrong.toml"
        wrong.write_text(file.read_text().replace("rear_right = 4", "rear_right = 5"))
        found = json.loads(hil("bench", "doctor", wrong, "--json", code=1).stdout)["findings"]
        missing = next(finding for finding in found if "missing" in finding["what"])
        assert missing["what"] == "rear right (node 5) is missing"
        assert missing["fix"].startswith("node 4 answers and stands in no bench file: is it rear right?")
        wrong.write_text(file.read_text().replace("bit_rate = 1000000", "bit_rate = 500000"))
        refused = json.loads(hil("bench", "doctor", wrong, "--json", code=3).stdout)
        assert any("runs at 1000000 bit/s, not at 500000" in f["what"] for f in refused["findings"])
