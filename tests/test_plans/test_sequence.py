"""Sequence files: which plans are run one after the other, and when it is enough."""

from pathlib import Path

import pytest

from hil.core.errors import BadInputError
from test_plans import library_sequences, load_plan, load_sequence

TEXT = "name: mine\nidentify: short_identification\naccept: acceptance\n"


def written(folder: Path, text: str) -> Path:
    path = folder / "mine.yaml"
    path.write_text(text)
    return path


@pytest.mark.parametrize("name", library_sequences())
def test_a_built_in_sequence_names_plans_that_are_there(name):
    sequence = load_sequence(name)
    assert load_plan(sequence.identify_plan).segments
    assert load_plan(sequence.accept_plan).criteria
    assert sequence.free_file is None


def test_plans_and_files_beside_it_come_before_built_in_ones(tmp_path):
    path = written(tmp_path, TEXT.replace("acceptance", "own.yaml") + "free: mine.toml\n")
    assert load_sequence(path).accept_plan == "own.yaml"
    (tmp_path / "own.yaml").write_text("")
    found = load_sequence(path)
    assert found.accept_plan == str(tmp_path / "own.yaml")
    assert found.identify_plan == "short_identification"
    assert found.free_file == tmp_path / "mine.toml"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (TEXT + "round: 3\n", "line 4.*unknown key 'round'"),
        (TEXT + "rounds: 0\n", "line 4"),
        (TEXT + "agree_percent: -1\n", "line 4"),
        (TEXT + "runs: many\n", "line 4"),
        ("name: mine\n", "'identify' is missing"),
        ("- a\n", "keys and values are needed"),
        ("", "keys and values are needed"),
    ],
)
def test_what_is_wrong_is_told_with_its_line(tmp_path, text, said):
    with pytest.raises(BadInputError, match=f"(?s){said}"):
        load_sequence(written(tmp_path, text))


def test_there_is_no_such_sequence():
    with pytest.raises(BadInputError, match="no sequence 'autotun'"):
        load_sequence("autotun")
