"""A campaign file: which simulations of a plan are made, and how many of them are to pass."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import Field

from hil.analysis.campaigns._axes import MOST_SIMULATIONS, Span, refuse_too_many, spans_at
from hil.analysis.tuning import Tolerance
from hil.core.errors import BadInputError
from hil.core.errors.wording import did_you_mean
from hil.core.files import is_file
from hil.core.files.toml_file import FORMAT, FormatNumber
from test_plans.building import PlanMistakes, Strict, brief, build, mapping_at
from test_plans.loading import LIBRARY, named_file, names_in
from test_plans.yaml_document import Document, KeyPath, read_yaml, yaml_text

CAMPAIGNS = Path(__file__).parent / "library"
_EXAMPLE = "name: my_campaign, then plan: acceptance"


class CampaignKeys(Strict):
    """The keys of a campaign file that are plain text or numbers."""

    format: FormatNumber = FORMAT
    name: str = Field(
        pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]{0,63}$",
        description="name of the results; letters, digits, _, - and ., at most 64",
    )
    title: str = Field(default="", max_length=200, description="title of the report")
    description: str = Field(default="", max_length=10_000, description="purpose")
    plan: str = Field(min_length=1, description="plan file beside this one, or the name of a built-in plan")
    bench: str = Field(
        default="sim", min_length=1, description="simulated bench: file beside this one, or a shipped one"
    )
    model: str = Field(default="", description="model file beside this one; '' for the bench's own")
    controller: str = Field(
        default="", description="file name of the plan's controller to replace or vary; '' for the last"
    )
    controllers: list[str] = Field(
        default=[], description="controller files to compare in its place; none for the plan's own"
    )
    draws: int = Field(
        default=0,
        ge=0,
        le=MOST_SIMULATIONS,
        description="vehicles sampled around each model; 0: the model alone",
    )
    seed: int = Field(default=0, ge=0, le=2**31, description="random seed of the draws and of sensor noise")
    criteria: list[str] = Field(
        default=[], description="ids of the plan's criteria to evaluate; none for all of them"
    )
    pass_share: float | None = Field(
        default=None, ge=0, le=1, description="required pass rate of each controller, 0 to 1"
    )


class CampaignFile(CampaignKeys):
    """A checked campaign file, as far as it can be checked alone.

    Attributes:
        vary: what is varied by name, each with its values.
        tolerance: what differs from car to car.
        source: its path; text: its YAML.
    """

    vary: dict[str, tuple[float, ...]]
    tolerance: Tolerance
    source: Path
    text: str

    @property
    def document(self) -> Document:
        """Its YAML with the places of keys, for messages."""
        return read_yaml(self.text, str(self.source))

    def beside(self, name: str, *others: Path) -> Path | None:
        """A file that it names: beside itself, else in one of `others`; None if there is none."""
        places = (self.source.parent, *others)
        return next((place / name for place in places if is_file(place / name)), None)


def library_campaigns() -> tuple[str, ...]:
    """Names of the built-in campaigns."""
    return names_in(CAMPAIGNS)


def load_campaign_file(name_or_path: str | Path) -> CampaignFile:
    """Read a campaign from a file, or a built-in one by its name.

    Raises:
        BadInputError: no such file, or all that is wrong with it: line, key, and what to do.
    """
    path = named_file(name_or_path, CAMPAIGNS, "campaign")
    return campaign_from_text(yaml_text(path), path)


def campaign_from_text(text: str, path: Path) -> CampaignFile:
    """Check the text of a campaign file; paths in it are relative to `path`.

    Raises:
        BadInputError: all that is wrong with it: line, key, and what to do.
    """
    document, mistakes = read_yaml(text, str(path)), PlanMistakes()
    content = mapping_at(document.value, document, (), _EXAMPLE)
    keys: CampaignKeys | None = None
    spans: dict[str, Span | tuple[float, ...]] = {}
    tolerance = Tolerance()
    known = (*CampaignKeys.model_fields, "vary", "tolerance")
    for key in content:
        with mistakes.collected():
            if key not in known:
                fix = did_you_mean(key, known)
                raise BadInputError(f"unknown key {key!r}", where=document.place((key,)), fix=fix)
    with mistakes.collected():
        named = {key: value for key, value in content.items() if key in CampaignKeys.model_fields}
        keys = build(CampaignKeys, named, document, ())
    with mistakes.collected():
        spans = spans_at(content.get("vary"), document)
    with mistakes.collected():
        tolerance = _tolerance_at(content.get("tolerance"), document)
    mistakes.refuse()
    assert keys is not None
    refuse_too_many(spans, len(keys.controllers), keys.draws, document)
    vary = {
        name: span.values(document, name) if isinstance(span, Span) else span for name, span in spans.items()
    }
    return CampaignFile(**keys.model_dump(), vary=vary, tolerance=tolerance, source=path, text=text)


def _tolerance_at(value: object, document: Document) -> Tolerance:
    path: KeyPath = ("tolerance",)
    table = {} if value is None else mapping_at(value, document, path, "vehicle_inertia: 0.1")
    mistakes, shares = PlanMistakes(), Tolerance.apart(table)["relative"]
    for name, value in table.items():
        with mistakes.collected():
            where = document.place((*path, name))
            if name not in Tolerance.names():
                fix = did_you_mean(name, Tolerance.names())
                raise BadInputError(f"unknown key {name!r}", where=where, fix=fix)
            if name in shares and not _is_share(value):
                fix = "give a relative half width from 0 to below 1: 0.1 for 10 %"
                raise BadInputError(f"{brief(value)} is not a half width", where=where, fix=fix)
    mistakes.refuse()
    return build(Tolerance, Tolerance.apart(table), document, path)


def _is_share(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and 0 <= value < 1


def campaign_schema() -> dict[str, Any]:
    """JSON schema (draft 2020-12) of a campaign's YAML, for editors."""
    schema = CampaignKeys.model_json_schema()
    definitions: dict[str, Any] = {"Span": Span.model_json_schema()}
    number = {"type": "number"}
    tolerance: Mapping[str, Any] = Tolerance.model_json_schema()["properties"]
    share = {"type": "number", "minimum": 0, "exclusiveMaximum": 1, "description": "half width, relative"}
    schema["properties"] |= {
        "vary": {
            "type": ["object", "null"],
            "description": "controller.NAME, model.NAME, effect.ID.NAME, plan.NAME: values of each",
            "propertyNames": {"pattern": r"^(controller|model|plan)\.[^.]+$|^effect\.[^.]+\.[^.]+$"},
            "additionalProperties": {
                "anyOf": [{"type": "array", "items": number, "minItems": 1}, {"$ref": "#/$defs/Span"}]
            },
        },
        "tolerance": {
            "type": ["object", "null"],
            "description": "parameters that vary between vehicles",
            "properties": {name: tolerance.get(name, share) for name in Tolerance.names()},
            "additionalProperties": False,
        },
    }
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **schema,
        "title": "Campaign",
        "$defs": definitions,
    }


def controller_file(file: CampaignFile, name: str) -> Path:
    """A controller that a campaign names: beside it, or a built-in one, with or without its ending.

    Raises:
        BadInputError: there is none.
    """
    built_in = LIBRARY / "controllers"
    for candidate in (name, f"{name}.toml"):
        found = file.beside(candidate, built_in)
        if found is not None:
            return found
    known = sorted(path.stem for path in built_in.glob("*.toml"))
    path: KeyPath = ("controllers", file.controllers.index(name))
    where = file.document.place(path)
    raise BadInputError(
        f"there is no controller file {brief(name)}", where=where, fix=did_you_mean(name, known)
    )
