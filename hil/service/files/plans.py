"""The plans of a service: those that are built in, and those that people gave."""

from __future__ import annotations

import contextlib
import hashlib
import json
from collections.abc import Mapping
from pathlib import Path

from hil.api_schemas.api import PlanData
from hil.core.errors import BadInputError
from hil.core.files import read_text
from hil.service.files.pictures import Pictures
from hil.service.files.uploads import NameTakenError, Uploads, giver_of
from hil.service.store import GivenText
from hil.service.worker_pool.plan_reading import GivenPlan, data_of, given_plan, read_given, renamed
from test_plans import Choices, Plan, library_plans, load_plan, plan_from_text
from test_plans.yaml_document import read_yaml

_MOST_READ = 500


class Plans:
    """Plans by name. A plan that was given may load built-in and given controllers and no other file.

    Args:
        given: those that people gave.
        controllers: that people gave; plans find them beside themselves, in the same folder.
        pictures: that people gave, for prompts of plans; in the same folder.
    """

    def __init__(self, given: Uploads, controllers: Uploads, pictures: Pictures) -> None:
        self._given, self._controllers, self._pictures = given, controllers, pictures
        self._built_in = {name: load_plan(name) for name in library_plans()}
        self._read: dict[str, GivenPlan] = {}

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
                    given.append(self._known(path).data)
        return [*(data_of(plan, built_in=True) for plan in self._built_in.values()), *given]

    def get(self, name: str) -> PlanData | None:
        """One of them.

        Raises:
            BadInputError: it cannot be read any more.
        """
        if name in self._built_in:
            return data_of(self._built_in[name], built_in=True)
        path = self._path(name)
        return None if path is None else self._known(path).data

    def chosen(self, name: str, values: Mapping[str, float]) -> Plan | None:
        """A plan with its variables as chosen; None if there is none of the name.

        Raises:
            BadInputError: a variable that it does not have, or a value beyond its bounds.
        """
        path = self._path(name)
        return None if path is None else load_plan(path, Choices(values=values))

    def written(self, name: str, text: str, values: Mapping[str, float]) -> Plan:
        """A plan that is not given, as if it lay beside those that are, with its variables as chosen.

        Raises:
            BadInputError: all that is wrong with it, or a value beyond its bounds.
        """
        place = self._with_controllers() / f"{name}.yaml"
        chosen = Choices(values=values).applied(text, read_yaml(text, str(place))) if values else text
        return plan_from_text(chosen, str(place), place.parent)

    def text(self, name: str) -> str | None:
        """The YAML of one."""
        path = self._path(name)
        return None if path is None else read_text(path)

    def sha256(self, name: str) -> str:
        """SHA-256 of the text of a plan that was given, as a newer one names what it replaces; else ''."""
        there = None if name in self._built_in else self._given.text(name)
        return "" if there is None else there.sha256

    def source(self, name: str) -> Path:
        """Where a plan that was queued, here or elsewhere, would lie now: beside what it loads."""
        if name in self._built_in:
            return self._built_in[name].source
        return self._with_controllers() / f"{name}.yaml"

    def give(
        self,
        name: str,
        text: str,
        by: str,
        *,
        replace: bool = True,
        read: GivenPlan | None = None,
        based_on: str = "",
        instead_of: str | None = None,
    ) -> PlanData:
        """Keep a plan; one of the same name is replaced. Runs that are queued keep theirs.

        Args:
            by: who gives it.
            replace: whether one of the same name may be replaced.
            based_on: name of the plan that it was made from.
            read: what it says, if another process has read it; None reads it here.
            instead_of: SHA-256 of the text that it may replace, '' if the name has to be free; None replaces
                whatever is there.

        Raises:
            NameTakenError: a built-in plan has the name, or somebody else has given one meanwhile.
            BadInputError: all that is wrong with it.
        """
        if name in self._built_in:
            raise NameTakenError("is the name of a built-in plan", where=name, fix="give it another name")
        before = self._given.text(name) if replace else None
        if instead_of is not None:
            _refuse_another(name, before, instead_of, text)
        read = read or read_given(name, text, self._with_controllers())
        fix = "look at it, then give yours again, or under another name"
        self._given.give(name, text, by, instead_of=before, based_on=based_on, fix=fix)
        self._remember(text, read)
        return read.data

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
        text = renamed(text, copy)
        if self.text(copy) not in (None, text):
            raise NameTakenError("is the name of another plan", where=copy, fix="give the copy another name")
        return self.give(copy, text, by, replace=False, based_on=name)

    def loading(self, file: str) -> list[str]:
        """Names of given plans that load a controller file."""
        found = []
        self._with_controllers()
        for name, path in self._given.paths().items():
            with contextlib.suppress(BadInputError):
                if file in self._known(path).files:
                    found.append(name)
        return found

    def remove(self, name: str) -> bool:
        """Remove a plan that was given; false if there is none."""
        return name not in self._built_in and self._given.remove(name)

    def _known(self, path: Path) -> GivenPlan:
        """What a given plan says; read once, for a long one takes a second.

        Raises:
            BadInputError: it cannot be read any more.
        """
        text = read_text(path)
        found = self._read.get(_hashed(text))
        if found is None or not all((path.parent / file).is_file() for file in found.files):
            found = given_plan(load_plan(path), path.parent)
            self._remember(text, found)
        return found

    def _remember(self, text: str, read: GivenPlan) -> None:
        self._read[_hashed(text)] = read
        while len(self._read) > _MOST_READ:
            del self._read[next(iter(self._read))]

    def _path(self, name: str) -> Path | None:
        if name in self._built_in:
            return self._built_in[name].source
        path = self._given.path(name)
        if path is not None:
            self._with_controllers()
        return path

    def _with_controllers(self) -> Path:
        """The folder, once every controller and picture that a given plan may name lies there."""
        self._controllers.paths()
        self._pictures.bring()
        return self._given.folder


def _refuse_another(name: str, there: GivenText | None, instead_of: str, text: str) -> None:
    """Refuse to replace a plan that its writer has not seen; the same text may be given again.

    Raises:
        NameTakenError: says who gave what is there, and when.
    """
    if there is None:
        if instead_of:
            what = "was removed after you began to write"
            raise NameTakenError(what, where=name, fix="give it as a new plan, or leave it removed")
        return
    if instead_of != there.sha256 and text != there.text:
        what = f"was saved by {giver_of(there)}"
        if instead_of:
            what = f"{what}, after you began to write"
        fix = "compare both texts, then give yours as a newer version, or another name, or take theirs"
        raise NameTakenError(what, where=name, fix=fix)


def _hashed(text: str) -> str:
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()
