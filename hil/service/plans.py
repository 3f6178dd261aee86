"""The plans of a service: those that are built in, and those that people gave."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Mapping
from pathlib import Path

from hil.core.errors import BadInputError
from hil.core.files import read_text
from hil.core.printable import printable
from hil.service.data import PlanData, VariableData
from hil.service.given_files import GivenFiles, NameTakenError
from hil.service.plan_files import files_of
from test_plans import Choices, Plan, library_plans, load_plan, plan_from_text
from test_plans.yaml_document import read_yaml


class Plans:
    """Plans by name. A plan that was given may load built-in and given controllers and no other file.

    Args:
        given: those that people gave.
        controllers: that people gave; plans find them beside themselves, in the same folder.
    """

    def __init__(self, given: GivenFiles, controllers: GivenFiles) -> None:
        self._given, self._controllers = given, controllers
        self._built_in = {name: load_plan(name) for name in library_plans()}

    def fresh_folder(self) -> Path:
        """Where given plans are, with the controllers that they load: as the database has them now."""
        self._given.paths()
        return self._with_controllers()

    def all(self) -> list[PlanData]:
        """What there is; a plan that cannot be read any more is left out."""
        self._with_controllers()
        given = []
        for name, path in self._given.paths().items():
            with contextlib.suppress(BadInputError):
                if name not in self._built_in:
                    given.append(_data(load_plan(path), built_in=False))
        return [*(_data(plan, built_in=True) for plan in self._built_in.values()), *given]

    def get(self, name: str) -> PlanData | None:
        """One of them.

        Raises:
            BadInputError: it cannot be read any more.
        """
        path = self._path(name)
        return None if path is None else _data(load_plan(path), built_in=name in self._built_in)

    def chosen(self, name: str, values: Mapping[str, float]) -> Plan | None:
        """A plan with its variables as chosen; None if there is none of the name.

        Raises:
            BadInputError: a variable that it does not have, or a value beyond its bounds.
        """
        path = self._path(name)
        return None if path is None else load_plan(path, Choices(values=values))

    def text(self, name: str) -> str | None:
        """The YAML of one."""
        path = self._path(name)
        return None if path is None else read_text(path)

    def source(self, name: str) -> Path:
        """Where a plan that was queued, here or elsewhere, would lie now: beside what it loads."""
        if name in self._built_in:
            return self._built_in[name].source
        return self._with_controllers() / f"{name}.yaml"

    def give(self, name: str, text: str, by: str, *, replace: bool = True) -> PlanData:
        """Keep a plan; one of the same name is replaced. Runs that are queued keep theirs.

        Args:
            by: who gives it.
            replace: whether one of the same name may be replaced.

        Raises:
            NameTakenError: a built-in plan has the name, or somebody else has given one just now.
            BadInputError: all that is wrong with it.
        """
        if name in self._built_in:
            raise NameTakenError("is the name of a built-in plan", where=name, fix="give it another name")
        before = self._given.text(name) if replace else None
        where, folder = f"{name}.yaml", self._with_controllers()
        for file in files_of(plan_from_text(text, where, folder, files_required=False)):
            if file.name != str(file):
                raise BadInputError(
                    f"loads the file {printable(repr(str(file)), 100)}",
                    where=where,
                    fix="a plan that is given to the service loads controllers that it has, by their names",
                )
        plan = plan_from_text(text, where, folder, to_carry_out=True)
        if plan.name != name:
            raise BadInputError(
                f"the plan calls itself '{plan.name}'", where=where, fix="give it under that name"
            )
        fix = "look at it, then give yours again, or under another name"
        self._given.give(name, text, by, instead_of=before, fix=fix)
        return _data(plan, built_in=False)

    def copied(self, name: str, copy: str, controllers: Mapping[str, str], by: str) -> PlanData | None:
        """Keep a copy that loads other controllers, by the files that they replace; None if there is no plan.

        Raises:
            NameTakenError: the copy's name is that of another plan.
            BadInputError: the plan loads no such file.
        """
        text = self.text(name)
        if text is None:
            return None
        folder = self._with_controllers().resolve()
        chosen = {old: folder / file for old, file in controllers.items()}
        text = Choices(controllers=chosen).applied(text, read_yaml(text, name))
        for path in chosen.values():  # plans find what lies beside them by its name alone
            text = text.replace(json.dumps(str(path), ensure_ascii=False), json.dumps(path.name))
        text = _renamed(text, copy)
        if self.text(copy) not in (None, text):
            raise NameTakenError("is the name of another plan", where=copy, fix="give the copy another name")
        return self.give(copy, text, by, replace=False)

    def loading(self, file: str) -> list[str]:
        """Names of given plans that load a controller file."""
        found = []
        self._with_controllers()
        for name, path in self._given.paths().items():
            with contextlib.suppress(BadInputError):
                if any(one.name == file for one in files_of(load_plan(path))):
                    found.append(name)
        return found

    def remove(self, name: str) -> bool:
        """Remove a plan that was given; false if there is none."""
        return name not in self._built_in and self._given.remove(name)

    def _path(self, name: str) -> Path | None:
        if name in self._built_in:
            return self._built_in[name].source
        path = self._given.path(name)
        if path is not None:
            self._with_controllers()
        return path

    def _with_controllers(self) -> Path:
        """The folder, once every controller that a given plan may load lies there."""
        self._controllers.paths()
        return self._given.folder


def _renamed(text: str, name: str) -> str:
    """A plan's text with another name, which stands in its title too."""
    document = read_yaml(text, name)
    content = document.value if isinstance(document.value, dict) else {}
    changes = {("name",): name, ("title",): f"{content.get('title', '')}, {name}"}
    places = {document.spans[path]: value for path, value in changes.items() if path in document.spans}
    for start, end in sorted(places, reverse=True):
        text = text[:start] + json.dumps(places[start, end], ensure_ascii=False) + text[end:]
    return text


def _data(plan: Plan, *, built_in: bool) -> PlanData:
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
    )


def hazard_of(plan: Plan) -> str:
    """Why a plan is hazardous, in its words; '' if it is not."""
    if not plan.hazardous:
        return ""
    return plan.hazardous if isinstance(plan.hazardous, str) else "the plan says so"
