"""What a given file says, and whether a service may take it: read in another process."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hil.api_schemas.api import PlanData, VariableData
from hil.app.schemas import SCHEMAS
from hil.core.controller import controller_from_toml
from hil.core.errors import BadInputError
from hil.core.errors.wording import printable
from hil.core.files import is_file
from hil.core.files.toml_file import parse_toml
from hil.core.model import model_from_dict
from hil.execution.data_folder import files_of
from test_plans import Plan, estimate_duration_s, largest_requests_nm, pictures_of, plan_from_text
from test_plans.yaml_document import read_yaml


@dataclass(frozen=True)
class GivenPlan:
    """A given plan: what is shown of it, and names of the files beside it that it loads or shows."""

    data: PlanData
    files: tuple[str, ...]


def read_given(name: str, text: str, folder: Path) -> GivenPlan:
    """Read a plan that somebody gives under a name; `folder` has the controllers that it may load.

    Raises:
        BadInputError: all that is wrong with it.
    """
    where = f"{name}.yaml"
    for file in files_of(plan_from_text(text, where, folder, files_required=False)):
        if file.name != str(file):
            raise BadInputError(
                f"loads the file {printable(repr(str(file)), 100)}",
                where=where,
                fix="a plan on the service can only load controllers of the service, by name",
            )
    plan = plan_from_text(text, where, folder, to_execute=True)
    for picture in pictures_of(plan):
        if not is_file(folder / picture):
            raise BadInputError(
                f"shows the picture '{picture}', which the service does not have",
                where=where,
                fix="give the picture to the service first",
            )
    if plan.name != name:
        raise BadInputError(
            f"the name in the plan is '{plan.name}'", where=where, fix="upload it under that name"
        )
    return given_plan(plan, folder)


def given_plan(plan: Plan, folder: Path) -> GivenPlan:
    """What a given plan says; `folder` has the controllers that it may load."""
    beside = folder.resolve()
    files = (file for file in files_of(plan) if file.resolve().parent == beside)
    return GivenPlan(
        data_of(plan, built_in=False), tuple(sorted({file.name for file in files}.union(pictures_of(plan))))
    )


def data_of(plan: Plan, *, built_in: bool) -> PlanData:
    """What is shown of a plan."""
    return PlanData(
        name=plan.name,
        title=plan.title,
        description=plan.description,
        hazard=hazard_of(plan),
        built_in=built_in,
        variables={
            name: VariableData(
                default=one.default,
                unit=one.unit,
                lower=one.lower,
                upper=one.upper,
                description=one.description,
            )
            for name, one in plan.variables.items()
        },
        duration_s=estimate_duration_s(plan),
        largest_requests_nm=largest_requests_nm(plan),
    )


def hazard_of(plan: Plan) -> str:
    """Why a plan is hazardous, in its words; '' if it is not."""
    if not plan.hazardous:
        return ""
    return plan.hazardous if isinstance(plan.hazardous, str) else "the plan is marked hazardous"


def plan(name: str, text: str, folder: str) -> dict[str, Any]:
    """Fields of `GivenPlan`.

    Raises:
        BadInputError: all that is wrong with it.
    """
    found = read_given(name, text, Path(folder))
    return {"data": found.data.model_dump(mode="json"), "files": found.files}


def model(name: str, text: str) -> dict[str, Any]:
    """Nothing, once it has been read.

    Raises:
        BadInputError: it is no model.
    """
    where = f"{name}.toml"
    model_from_dict(parse_toml(text, where), where, text)
    return {}


def controller(name: str, text: str) -> dict[str, Any]:
    """Nothing, once it has been read.

    Raises:
        BadInputError: it is no controller.
    """
    controller_from_toml(text, f"{name}.toml")
    return {}


def schema(kind: str) -> dict[str, Any]:
    """As `hil schema` prints it."""
    return SCHEMAS[kind]()


def renamed(text: str, name: str) -> str:
    """A plan's text with another name, which stands in its title too."""
    document = read_yaml(text, name)
    content = document.value if isinstance(document.value, dict) else {}
    changes = {("name",): name, ("title",): f"{content.get('title', '')}, {name}"}
    places = {document.spans[path]: value for path, value in changes.items() if path in document.spans}
    for start, end in sorted(places, reverse=True):
        text = text[:start] + json.dumps(places[start, end], ensure_ascii=False) + text[end:]
    return text
