"""From YAML to a plan, by path or name, with messages that name file, line and key."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from hil.core.errors import BadInputError
from hil.core.errors.wording import closest, did_you_mean
from hil.core.files import is_file
from hil.core.files.toml_file import parse_toml, refuse_other_kind
from test_plans.building import PlanMistakes, brief, build, list_at, mapping_at
from test_plans.conductor import PlannedSegment
from test_plans.criteria import EXAMPLE as CRITERION_EXAMPLE
from test_plans.criteria import Criterion, criterion_at
from test_plans.plan import Plan, PlanKeys, estimate_duration_s
from test_plans.steps import LARGEST_COUNT, STEPS, FileSearch, Step
from test_plans.variables import KEY as VARIABLES
from test_plans.variables import Choices, variables_at, with_values
from test_plans.yaml_document import Document, KeyPath, read_yaml, yaml_text


def names_in(folder: Path) -> tuple[str, ...]:
    """Names of the built-in YAML files in `folder`, in order."""
    return tuple(sorted(path.stem for path in folder.glob("*.yaml")))


def named_file(name_or_path: str | Path, folder: Path, kind: str, built_in: str = "one") -> Path:
    """A path as it is, or the built-in file of `folder` that has this name.

    Args:
        kind: what it is, for messages; `built_in`: the same of one that comes with the package.

    Raises:
        BadInputError: it is no path, and there is no such name.
    """
    path = Path(name_or_path)
    if path.suffix in (".yaml", ".yml") or len(path.parts) > 1 or is_file(path):
        return path
    names = names_in(folder)
    if path.name in names:
        return folder / f"{path.name}.yaml"
    raise BadInputError(
        f"there is no {kind} {brief(path.name)}, neither a file nor a built-in {built_in}",
        fix=f"{did_you_mean(path.name, names)}; a file's name ends in .yaml",
    )


logger = logging.getLogger(__name__)

LIBRARY = Path(__file__).parent / "library"
LONGEST_PLAN_S = 24 * 3600.0

_STEP_EXAMPLE = "- wait: {duration_s: 1}"
_KEYS = (*PlanKeys.model_fields, "steps", "finally", "criteria")


def library_plans() -> tuple[str, ...]:
    """Names of the built-in plans."""
    return names_in(LIBRARY)


def library_controllers() -> dict[str, Path]:
    """The built-in controller files by name."""
    return {path.stem: path for path in sorted((LIBRARY / "controllers").glob("*.toml"))}


def load_plan(name_or_path: str | Path, choices: Choices | None = None) -> Plan:
    """Read a plan from a file, or a built-in one by its name.

    With `choices` the plan's text is the one that was chosen: what is executed, recorded and reported.

    Raises:
        BadInputError: no such plan, or all that is wrong with it: file, line, key, and what to do.
    """
    path = named_file(name_or_path, LIBRARY, "plan", "plan")
    text = yaml_text(path)
    if path.suffix == ".toml":
        _refuse_other_file(text, str(path))
    if choices is not None:
        text = choices.applied(text, read_yaml(text, str(path)))
    plan = plan_from_text(text, str(path), path.parent, to_execute=True)
    logger.info("plan %s: %d steps, %d criteria", path, len(plan.steps), len(plan.criteria))
    return plan


def plan_from_text(
    text: str, where: str, base_dir: Path, *, files_required: bool = True, to_execute: bool = False
) -> Plan:
    """Check the text of a plan; `where` names it in messages.

    Relative controller files are looked for in `base_dir`, then among the built-in ones. With
    `files_required` false they are not looked for: for a plan that was executed long ago. With
    `to_execute` it is refused, too, if it asks for driving torque before there is a controller.

    Raises:
        BadInputError: file, line, key, and what to do.
    """
    reader = _Reader(with_values(read_yaml(text, where)), base_dir, files_required)
    return reader.plan(text, to_execute=to_execute)


class _Reader:
    """Walks through one document."""

    def __init__(self, document: Document, base_dir: Path, files_required: bool) -> None:
        self._document = document
        self._files = FileSearch((base_dir, LIBRARY / "controllers"), files_required)

    def plan(self, text: str, *, to_execute: bool) -> Plan:
        document, mistakes = self._document, PlanMistakes()
        content = mapping_at(document.value, document, (), "name: my_plan, then steps:")
        keys: PlanKeys | None = None
        steps: tuple[Step, ...] | None = None
        end_steps: tuple[Step, ...] = ()
        criteria: tuple[Criterion, ...] = ()
        for key in content:
            with mistakes.collected():
                self._refuse_unknown(key)
        with mistakes.collected():
            keys = self._keys(content)
        with mistakes.collected():
            if not any(closest(key, _KEYS) == "steps" for key in content if key not in _KEYS):
                steps = self._first_steps(content)
        with mistakes.collected():
            end_steps = self._steps(_or_empty(content, "finally"), ("finally",))
            self._refuse_segments_at_the_end(end_steps)
        with mistakes.collected():
            if steps is not None and to_execute:
                self._refuse_without_controller((*steps, *end_steps), len(steps))
        with mistakes.collected():
            criteria = self._criteria(_or_empty(content, "criteria"), steps)
        mistakes.refuse()
        assert keys is not None
        assert steps is not None
        source = Path(document.where)
        plan = Plan(
            **keys.model_dump(), steps=steps, finally_=end_steps, criteria=criteria, text=text, source=source
        )
        self._refuse_endless(plan)
        return plan

    def _refuse_unknown(self, key: str) -> None:
        if key not in _KEYS:
            raise BadInputError(
                f"unknown key {key!r}", where=self._document.place((key,)), fix=did_you_mean(key, _KEYS)
            )

    def _keys(self, content: dict[str, Any]) -> PlanKeys:
        named = {key: content[key] for key in content if key in PlanKeys.model_fields}
        if named.get(VARIABLES) is not None:
            named[VARIABLES] = variables_at(named[VARIABLES], self._document)
        return build(PlanKeys, named, self._document, ())

    def _first_steps(self, content: dict[str, Any]) -> tuple[Step, ...]:
        if not content.get("steps"):
            raise BadInputError(
                "a plan needs at least one step",
                where=self._document.place(("steps",)),
                fix=f"write under steps: {_STEP_EXAMPLE}",
            )
        steps = self._steps(content["steps"], ("steps",))
        count = sum(step.count for step in steps)
        if count > LARGEST_COUNT:
            raise BadInputError(
                f"{count} steps in total, at most {LARGEST_COUNT} are allowed",
                where=self._document.place(("steps",)),
                fix="split the plan",
            )
        self._refuse_same_segments(steps)
        return steps

    def _steps(self, value: object, path: KeyPath) -> tuple[Step, ...]:
        mistakes, steps = PlanMistakes(), []
        for index, entry in enumerate(list_at(value, self._document, path, _STEP_EXAMPLE)):
            with mistakes.collected():
                steps.append(self._step(entry, (*path, index)))
        mistakes.refuse()
        return tuple(steps)

    def _step(self, value: object, path: KeyPath) -> Step:
        document = self._document
        entry = mapping_at(value, document, path, _STEP_EXAMPLE)
        if len(entry) != 1:
            raise BadInputError(
                f"a step has one key, its kind; this has {len(entry)}: {', '.join(map(repr, entry))}",
                where=document.place(path),
                fix=f"indent the step's own keys below its kind, or write: {_STEP_EXAMPLE}",
            )
        kind, content = next(iter(entry.items()))
        here = (*path, kind)
        step_class = STEPS.find(kind)
        if step_class is None:
            raise BadInputError(
                f"unknown kind of step {kind!r}", where=document.place(here), fix=STEPS.suggestion(kind)
            )
        values: dict[str, Any] = mapping_at(
            {} if content is None else content, document, here, f"- {kind}: {{key: value}}"
        )
        nested = {key: self._steps(values[key], (*here, key)) for key in step_class.nested if key in values}
        return build(step_class, values | nested, document, here, self._files)

    def _criteria(self, value: object, steps: tuple[Step, ...] | None) -> tuple[Criterion, ...]:
        """The criteria; where the steps have mistakes, no one knows which segments there will be."""
        segments = None if steps is None else {one.id: one for step in steps for one in step.segments()}
        mistakes, seen = PlanMistakes(), dict[str, int]()
        criteria = []
        for index, entry in enumerate(
            list_at(value, self._document, ("criteria",), f"- {CRITERION_EXAMPLE}")
        ):
            with mistakes.collected():
                criteria.append(self._criterion(entry, index, segments, seen))
        mistakes.refuse()
        return tuple(criteria)

    def _criterion(
        self, entry: object, index: int, segments: dict[str, PlannedSegment] | None, seen: dict[str, int]
    ) -> Criterion:
        path: KeyPath = ("criteria", index)
        criterion = criterion_at(entry, self._document, path, segments)
        if criterion.id in seen:
            raise BadInputError(
                f"the criterion '{criterion.id}' occurs twice, as number {seen[criterion.id]} too",
                where=self._document.place(path),
                fix="give one of them an 'id' of its own",
            )
        seen[criterion.id] = index + 1
        return criterion

    def _refuse_same_segments(self, steps: tuple[Step, ...]) -> None:
        seen: set[str] = set()
        for index, id_ in _ids(steps):
            if id_ in seen:
                raise BadInputError(
                    f"two steps produce a segment '{id_}'",
                    where=self._document.place(("steps", index)),
                    fix="give one of them another name",
                )
            seen.add(id_)

    def _refuse_segments_at_the_end(self, steps: tuple[Step, ...]) -> None:
        for index, id_ in _ids(steps):
            raise BadInputError(
                f"the segment '{id_}' is not evaluated in 'finally'",
                where=self._document.place(("finally", index)),
                fix="move the step to 'steps'; 'finally' brings the axle to rest",
            )

    def _refuse_without_controller(self, steps: tuple[Step, ...], first: int) -> None:
        """Refuse driving torque before any controller; of `steps` those from `first` on are the end steps."""
        for index, step in enumerate(steps):
            path: KeyPath = ("steps", index) if index < first else ("finally", index - first)
            for place, one in _each(step, path):
                if one.needs_controller:
                    raise BadInputError(
                        f"'{one.kind}' requests driving torque before any set_controller step",
                        where=self._document.place(place),
                        fix="write before it: - set_controller: {file: my_controller.toml}",
                    )
                if one.sets_controller:
                    return

    def _refuse_endless(self, plan: Plan) -> None:
        duration = estimate_duration_s(plan)
        if duration > LONGEST_PLAN_S:
            raise BadInputError(
                f"would take {duration / 3600:.1f} h, at most {LONGEST_PLAN_S / 3600:g} h are executed",
                where=self._document.place(("steps",)),
                fix="split the plan",
            )


def _or_empty(content: dict[str, Any], key: str) -> object:
    value = content.get(key)
    return [] if value is None else value


def _each(step: Step, path: KeyPath) -> Iterator[tuple[KeyPath, Step]]:
    """A step, or those within it, in their order, with their places."""
    yield path, step
    for key in step.nested:
        for index, inner in enumerate(getattr(step, key, ())):
            yield from _each(inner, (*path, step.kind, key, index))


def _ids(steps: tuple[Step, ...]) -> Iterator[tuple[int, str]]:
    for index, step in enumerate(steps):
        for segment in step.segments():
            yield index, segment.id


def _refuse_other_file(text: str, where: str) -> None:
    try:
        content = parse_toml(text, where)
    except BadInputError:  # then it is looked at as a plan
        return
    refuse_other_kind(content, "plan", where)
