"""Margins of a plan's controllers, and of a draft in their place, in each segment of the plan."""

from __future__ import annotations

import functools
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from hil.analysis.control_design import Margins
from hil.analysis.tuning import DrivenSegment, SpeedLoops, driven_segments, gain_factor, sliding, with_mass
from hil.core.controller import Controller, load_controller
from hil.core.errors import BadInputError
from hil.core.model import Model
from hil.service.worker_pool._cloud import Cars, cars_of, worst_of
from hil.service.worker_pool._designing import drafts_of, margin_fields, spec_of
from test_plans import load_plan

_KEPT = 8
_STEP_S = 0.001


def segments(
    model: str, plan: str, cars: int, tolerance: dict[str, float] | None, seed: int, **chosen: Any
) -> dict[str, Any]:
    """Fields of `SegmentsData` for files of a model and a plan.

    The speed counts by the controllers' schedules, the mass as the vehicle's inertia; on a road with less
    friction than a dry one's, tyres grip and slide.

    Raises:
        BadInputError: the plan drives no segment, or what a cloud is refused for.
    """
    draft = drafts_of(model).draft(spec_of(chosen)).controller
    found = driven_segments(load_plan(plan))
    if not found:
        what = "no segment of the plan is one of driving torque"
        raise BadInputError(what, where=Path(plan).stem, fix="choose one with steps of driving_torque")
    drawn = json.dumps(tolerance)
    loops = _Loops(model, cars, drawn, seed, draft)
    rows = [row for one in found for row in loops.rows(one)]
    own = cars_of(model, cars, drawn, seed)
    return {"source": own.source, "cars": len(own.plants) - 1, "segments": rows, "notes": loops.notes}


class _Loops:
    """Loops of controllers around cars, each once: many segments have the same."""

    def __init__(self, model: str, cars: int, tolerance: str, seed: int, draft: Controller) -> None:
        self._chosen, self._draft = (model, cars, tolerance, seed), draft
        self._known: dict[tuple[object, ...], dict[str, Any]] = {}
        self._loaded: dict[Path, Controller] = {}
        self.notes: list[str] = []

    def rows(self, segment: DrivenSegment) -> list[dict[str, Any]]:
        """Fields of `SegmentData`: while tyres grip, and on a slippery road while they slide."""
        own = self._loaded.get(segment.file) or load_controller(segment.file)
        self._loaded[segment.file] = own
        # A draft takes the place of what is loaded: without the schedule that this has.
        factor = gain_factor(own, segment.speed_m_s)
        rows = []
        for slides in (False, True) if segment.friction < 1 else (False,):
            cars = cars_on(*self._chosen, segment.mass_kg, slides)
            if cars is None:
                self._note("sliding tyres need a model with a tyre: three_inertia")
                continue
            key = (segment.mass_kg, slides)
            rows.append(
                {
                    "segment": segment.id,
                    "speed_km_h": round(3.6 * segment.speed_m_s, 6),
                    "friction": segment.friction,
                    "mass_kg": segment.mass_kg,
                    "sliding": slides,
                    "controller": segment.file.stem,
                    "own": self._loop((segment.file, factor, *key), own, factor, cars),
                    "draft": self._loop(("", 1.0, *key), self._draft, 1.0, cars),
                }
            )
        return rows

    def _loop(
        self, key: tuple[object, ...], controller: Controller, factor: float, cars: Cars
    ) -> dict[str, Any]:
        if key not in self._known:
            found = cars.margins(factor * cars.open_loops(controller))
            self._known[key] = _fields(found)
        return self._known[key]

    def _note(self, text: str) -> None:
        if text not in self.notes:
            self.notes.append(text)


def _fields(found: list[Margins]) -> dict[str, Any]:
    """Fields of `SegmentLoop`; the model itself is first."""
    return {
        "margins": margin_fields(found[0]),
        "worst": margin_fields(found[worst_of(found)]),
        "stable_share": float(np.mean([one.stable for one in found])),
    }


@functools.lru_cache(_KEPT)
def cars_on(
    model: str, count: int, tolerance: str, seed: int, mass_kg: float | None, slides: bool
) -> Cars | None:
    """The cars of a draft with another mass, or sliding; None if the model has no tyre that could slide.

    Cars of transfer functions stay as they are with another mass.
    """
    cars = cars_of(model, count, tolerance, seed)
    if mass_kg is None and not slides:
        return cars
    if not cars.draws:
        return None if slides else cars
    changed: list[Model] = []
    for draw in cars.draws:
        axle: Model | None = with_mass(draw.model, mass_kg)
        if axle is not None and slides:
            axle = sliding(axle)
        if axle is None:
            return None
        changed.append(axle)
    loops = SpeedLoops(changed, _STEP_S)
    draws = tuple(replace(one, model=axle) for one, axle in zip(cars.draws, changed, strict=True))
    return replace(cars, draws=draws, plants=loops.plants, origin_poles=loops.origin_poles)
