"""A sequence file: which plans `hil autotune` runs one after the other, and when it is content."""

from __future__ import annotations

from pathlib import Path

from pydantic import Field

from hil.core.files import is_file
from test_plans.building import Strict, build, mapping_at
from test_plans.loading import named_file, names_in
from test_plans.yaml_document import read_yaml, yaml_text

SEQUENCES = Path(__file__).parent / "sequences"
_EXAMPLE = "name: mine, then identify: and accept:"


class SequenceKeys(Strict):
    """The keys of a sequence file."""

    name: str = Field(
        pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]{0,63}$",
        description="name of the results; letters, digits, _, - and ., at most 64",
    )
    title: str = Field(default="", max_length=200, description="title of the report")
    description: str = Field(default="", max_length=10_000, description="purpose")
    identify: str = Field(
        min_length=1, description="plan for identification; the diagnosis uses its recording"
    )
    accept: str = Field(min_length=1, description="acceptance plan, whose worst margin is maximised")
    controller: str = Field(default="", description="file name of the controller to tune; '' for the last")
    free: str = Field(
        default="", description="file of free parameters, as for hil tune --free; '' for the built-in one"
    )
    rounds: int = Field(
        default=3, ge=1, le=20, description="largest number of rounds of diagnosis, tuning and confirmation"
    )
    runs: int = Field(default=6, ge=1, le=50, description="largest number of runs on the bench in a round")
    agree_percent: float = Field(
        default=3.0, gt=0, le=1000, description="largest deviation of a run from its prediction, % of a limit"
    )
    grow_percent: float = Field(
        default=0.2, gt=0, le=100, description="smallest growth of the margin that counts, % of a limit"
    )
    draws: int = Field(
        default=0, ge=0, le=5000, description="vehicles sampled around the model; 0: the model alone"
    )
    seed: int = Field(default=0, ge=0, le=2**31, description="random seed of draws and search")
    starts: int = Field(
        default=6, ge=0, le=1000, description="number of additional starting points of the optimiser"
    )
    diagnose_minutes: float = Field(
        default=15.0, gt=0, le=1440, description="largest processor time of a diagnosis, minutes"
    )


class Sequence(SequenceKeys):
    """A checked sequence file; plans and files that it names lie beside it, or are built in."""

    source: Path

    @property
    def identify_plan(self) -> str:
        """As `load_plan` takes it."""
        return _beside(self.source, self.identify)

    @property
    def accept_plan(self) -> str:
        """As `load_plan` takes it."""
        return _beside(self.source, self.accept)

    @property
    def free_file(self) -> Path | None:
        """None: as shipped."""
        return self.source.parent / self.free if self.free else None


def library_sequences() -> tuple[str, ...]:
    """Names of the built-in sequences."""
    return names_in(SEQUENCES)


def load_sequence(name_or_path: str | Path) -> Sequence:
    """Read a sequence from a file, or a built-in one by its name.

    Raises:
        BadInputError: no such file, or all that is wrong with it: line, key, and what to do.
    """
    path = named_file(name_or_path, SEQUENCES, "sequence")
    document = read_yaml(yaml_text(path), str(path))
    content = mapping_at(document.value, document, (), _EXAMPLE)
    keys = build(SequenceKeys, content, document, ())
    return Sequence(**keys.model_dump(), source=path)


def _beside(source: Path, plan: str) -> str:
    """A plan's file beside the sequence's; else what was written: a path, or a built-in plan's name."""
    beside = source.parent / plan
    return str(beside) if is_file(beside) else plan
