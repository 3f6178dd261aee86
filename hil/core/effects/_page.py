"""docs/reference/effects.md, made of the registry: `python -m hil.core.effects._page`."""

from __future__ import annotations

import importlib
import math

from hil.core.effects._effect import Effect, Parameter
from hil.core.effects._registry import found

_HEAD = """# Effects
The names that a diagnosis uses, and that a model file may carry. "Rotor side" means before the gear,
"wheel side" after it. This page is made of the registry (`python -m hil.core.effects._page`); each effect is
one file, `hil/core/effects/<id>.py`, and yours can be one more: [own-effect](../how-to/own-effect.md).

| id | parameters (unit) | what it is |
|---|---|---|
"""
_TAIL = """
## Effects that cannot be distinguished
Dead time and lag (the separation is in high-frequency amplitude), Coulomb friction and running resistance
when the axle always turns one way, Coulomb and Stribeck, bush mode and cubic stiffness at one amplitude,
viscous drag and running resistance at one speed, tyre slip and a softer tyre at one speed, torque gain and a
common factor of all inertias by speeds alone. Where the data at
hand cannot separate two effects, the honest answer is both names and the test that would separate them.
"""


def page() -> str:
    """The page as Markdown, without effects of other packages."""
    effects = [effect for effect in found()[0].values() if _module(effect) is not None]
    rows = "".join(f"| [`{e.id}`](#{e.id}) | {_numbers(e)} | {e.summary} |\n" for e in effects)
    return _HEAD + rows + "".join(_section(e) for e in effects) + _TAIL


def _module(effect: Effect) -> str | None:
    """What the file of an effect says at its head; None if it is not one of this package."""
    try:
        return importlib.import_module(f"{__package__}.{effect.id}").__doc__ or ""
    except ModuleNotFoundError:
        return None


def _numbers(effect: Effect) -> str:
    names = [f"`{name}`" for name in effect.text_parameters]
    names += [f"`{p.name}`{' (optional)' if p.optional else ''}" for p in effect.parameters]
    return ", ".join(names)


def _section(effect: Effect) -> str:
    text = " ".join((_module(effect) or "").split("\n\n", 1)[-1].split()) if _has_law(effect) else ""
    lines = [f"\n## {effect.id}\n", f"{effect.summary} {text}".strip() + "\n\n"]
    lines.append("| parameter | unit | from | to | meaning |\n|---|---|---|---|---|\n")
    lines += [_row(p) for p in effect.parameters]
    lines.append(f"\nIn data: {effect.signature[:1].lower()}{effect.signature[1:]} ")
    lines.append(f"Shown by: {effect.shown_by[:1].lower()}{effect.shown_by[1:]}")
    lines.append(f" For models of kind {', '.join(effect.needs)}.")
    if effect.needs_reversals:
        lines.append(" An axle that always turns one way hides it.")
    if effect.least is not None:
        unit = effect.least.of or effect.parameter(effect.acting()[0]).unit
        least = f"{effect.least.amount:g} {unit}".strip()
        lines.append(f" Named from {least} on: below, it is a correction.")
    if effect.similar:
        lines.append(f" Looks like: {', '.join(f'`{id_}`' for id_ in effect.similar)}.")
    if effect.source:
        lines.append(f" Source: {effect.source}.")
    return "".join(lines) + "\n"


def _has_law(effect: Effect) -> bool:
    return "\n\n" in (_module(effect) or "")


def _row(p: Parameter) -> str:
    meaning = f"{p.meaning}; {p.default:g} when left out" if p.optional else p.meaning
    low, high = (f"{value:g}" if math.isfinite(value) else "" for value in (p.lower, p.upper))
    return f"| `{p.name}` | {p.unit or '1'} | {low} | {high} | {meaning} |\n"


if __name__ == "__main__":
    print(page(), end="")
