"""`set_controller`: which controller file the RMCU uses from now on."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, Self

from pydantic import Field, ValidationInfo, field_validator, model_validator

from hil.core.controller import load_controller
from hil.core.errors import BadInputError
from hil.core.files import is_file
from test_plans.conductor import Conductor
from test_plans.pace import Outlook, Pace
from test_plans.steps._step import Name, Step


@dataclass(frozen=True)
class FileSearch:
    """Where relative paths in a plan are looked for; `required` is false for a plan of the past."""

    directories: tuple[Path, ...]
    required: bool = True


class SetController(Step):
    """Load a controller file into the RMCU; `file` is absolute or relative to where it was found from."""

    kind: ClassVar[str] = "set_controller"
    file: Path | None = Field(
        default=None, strict=False, description="controller file (TOML), relative to the plan or built in"
    )
    designed: Name | None = Field(default=None, description="name of an earlier design step of this plan")

    @model_validator(mode="after")
    def _one_of_both(self) -> Self:
        if (self.file is None) == (self.designed is None):
            raise ValueError("give either 'file' or 'designed'")
        return self

    @field_validator("file", mode="after")
    @classmethod
    def _found_and_valid(cls, file: Path | None, info: ValidationInfo) -> Path | None:
        search = info.context
        if file is None or not isinstance(search, FileSearch) or not search.required:
            return file
        places = [directory / file for directory in search.directories]
        found = next((place for place in places if is_file(place)), None)
        if found is None:
            raise ValueError(f"no such file: {', '.join(str(place) for place in places)}")
        try:
            load_controller(found)
        except BadInputError as error:
            raise ValueError(f"the controller file cannot be used: {error}") from error
        return found.absolute()  # a relative one is what a design step makes

    @property
    def sets_controller(self) -> bool:
        """It does."""
        return True

    def execute(self, conductor: Conductor) -> None:
        """Hand the file over."""
        conductor.set_controller(self.file or designed_file(str(self.designed)))

    def outlook(self, speed_m_s: float, pace: Pace) -> Outlook:  # noqa: ARG002 - not on the dynos
        """Next to no time."""
        return Outlook(0.0, speed_m_s)


def designed_file(name: str) -> Path:
    """Relative path under which a design step's controller is kept."""
    return Path(f"controller_{name}.toml")
