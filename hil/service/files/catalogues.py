"""The catalogues of models and controllers, and the API data of their entries."""

from __future__ import annotations

import contextlib
from pathlib import Path

from hil.api_schemas.design import ControllerData, ModelData
from hil.core.controller import Controller, controller_from_toml
from hil.core.errors import BadInputError
from hil.core.files.toml_file import parse_toml
from hil.core.model import Model, load_model, model_from_dict
from hil.engine.bench.bench_file import shipped
from hil.plant import refuse_too_stiff
from hil.service.files.catalogue import Catalogue
from hil.service.files.uploads import Uploads
from test_plans import library_controllers


def model_catalogue(given: Uploads) -> Catalogue[Model]:
    """Models: the shipped ones are those beside the shipped benches."""
    return Catalogue(given, _shipped_models(), _model)


def controller_catalogue(given: Uploads) -> Catalogue[Controller]:
    """Controllers; given ones lie in the folder of the plans, which find them there by their names."""
    return Catalogue(given, library_controllers(), controller_from_toml)


def model_data(catalogue: Catalogue[Model], name: str, path: Path) -> ModelData:
    """What is shown of a model that lies there.

    Raises:
        BadInputError: it cannot be read any more.
    """
    model = catalogue.read(path)
    return ModelData(
        name=name,
        kind=model.kind,
        built_in=catalogue.is_built_in(name),
        effects=[use.id for use in model.effects],
        warning=model.doubt,
    )


def controller_data(catalogue: Catalogue[Controller], name: str, path: Path) -> ControllerData:
    """What is shown of a controller that lies there.

    Raises:
        BadInputError: it cannot be read any more.
    """
    controller = catalogue.read(path)
    warnings = controller.meta.get("warnings")
    return ControllerData(
        name=name,
        built_in=catalogue.is_built_in(name),
        stabilisation=controller.stabilization,
        warnings=[str(one) for one in warnings] if isinstance(warnings, list) else [],
    )


def _model(text: str, where: str) -> Model:
    model = model_from_dict(parse_toml(text, where), where, text)
    refuse_too_stiff(model)
    return model


def _shipped_models() -> dict[str, Path]:
    found = {}
    for path in sorted(shipped("sim.toml").parent.glob("*.toml")):
        with contextlib.suppress(BadInputError):  # a bench file
            load_model(path)
            found[path.stem] = path
    return found
