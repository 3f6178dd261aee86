"""A file given in another's place is called by what it is."""

from pathlib import Path

import pytest

from hil.core.controller import load_controller
from hil.core.errors import BadInputError
from hil.core.files.toml_file import kind_of
from hil.core.model import load_model
from hil.engine import load_bench
from test_plans import load_plan

ROOT = Path(__file__).parents[4]
BENCH = ROOT / "benches" / "sim.toml"
CONTROLLER = ROOT / "test_plans" / "library" / "controllers" / "phase_stabilization.toml"


@pytest.mark.parametrize(
    ("read", "file", "is_a", "needed"),
    [
        (load_model, BENCH, "bench file", "model"),
        (load_model, CONTROLLER, "controller", "model"),
        (load_controller, BENCH, "bench file", "controller"),
        (load_bench, CONTROLLER, "controller", "bench file"),
        (load_plan, BENCH, "bench file", "plan"),
    ],
)
def test_it_says_what_it_is_and_what_was_needed(read, file: Path, is_a: str, needed: str) -> None:
    with pytest.raises(BadInputError) as caught:
        read(file)
    assert caught.value.what == f"this is a {is_a}; a {needed} is needed"
    assert caught.value.fix.startswith("give it as --")


@pytest.mark.parametrize("keys", [(), ("name", "title"), ("steps", "buses")])
def test_nothing_is_said_of_what_could_be_two_things_or_none(keys: tuple[str, ...]) -> None:
    assert kind_of(dict.fromkeys(keys)) is None
