"""Finds the effects: every module of this package, and every entry point of the group `hil.effects`.

An entry point names an `Effect`: `my_effect = "my_package.my_module:EFFECT"`.
"""

from __future__ import annotations

import hashlib
import importlib
import importlib.metadata
import inspect
import pkgutil
from collections.abc import Iterator
from pathlib import Path

from hil.core.effects._effect import Effect, Stage
from hil.core.errors import BadInputError

GROUP = "hil.effects"


def _own() -> Iterator[Effect]:
    package = Path(__file__).parent
    for module in pkgutil.iter_modules([str(package)]):
        if not module.name.startswith("_"):
            yield importlib.import_module(f"{__package__}.{module.name}").EFFECT


def _from_others() -> Iterator[Effect]:
    for entry in importlib.metadata.entry_points(group=GROUP):
        where = f"entry point '{entry.name}' of {GROUP} ({entry.value})"
        try:
            effect = entry.load()
        except Exception as error:  # another package's code raises what it likes
            raise BadInputError(
                f"cannot be loaded: {error}", where=where, fix="mend or uninstall the package"
            ) from error
        if not isinstance(effect, Effect):
            raise BadInputError(
                f"is a {type(effect).__name__}, not an Effect",
                where=where,
                fix="name an object of class Effect",
            )
        yield effect


def found() -> tuple[dict[str, Effect], str]:
    """All effects by id, in the order in which they act; and a digest of those of other packages.

    Raises:
        BadInputError: an entry point that cannot be used, or two effects of one id.
    """
    effects = {effect.id: effect for effect in _own()}
    digest = hashlib.sha256()
    strangers = sorted(_from_others(), key=lambda effect: effect.id)
    for effect in strangers:
        if effect.id in effects:
            raise BadInputError(
                f"two effects are called '{effect.id}'",
                where=f"entry points of {GROUP}",
                fix="uninstall one of the packages",
            )
        effects[effect.id] = effect
        digest.update(f"{effect.id}\0{_source(effect)}\0".encode())
    stages = list(Stage)
    ordered = sorted(effects.values(), key=lambda effect: (stages.index(effect.stage), effect.id))
    return {effect.id: effect for effect in ordered}, digest.hexdigest()[:16] if strangers else ""


def _source(effect: Effect) -> str:
    """The source of the files that hold an effect's law, for caches of what was compiled from them."""
    functions = [value for value in vars(effect.law).values() if inspect.isfunction(value)]
    files = sorted({function.__code__.co_filename for function in functions})
    return "".join(Path(file).read_text("utf-8") for file in files if Path(file).is_file())
