"""The run that tells two guesses apart: of a few plans, the one in which their responses differ most.

Guesses may differ in the controller's numbers as well as in the axle, so the plans step the driving torque,
at other speeds and by other sizes than the plan that the figures come from; one steps the motor torque, with
the controller out of it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from hil.analysis.target_search._trial import Guess, Predicted, Trial
from hil.core.channels import unit_of
from hil.core.errors import HilError
from hil.core.errors.wording import quantity
from test_plans import Plan, plan_from_text
from test_plans.steps import SetController

_SPEEDS_KM_H = (5.0, 10.0, 40.0)
_SHARES = (0.5, 1.0)  # of the largest step of the targets' plan
_MOTOR_NM = 20.0
_CHANNELS = {"shaft_torque_nm": 0.7, "motor_speed_rad_s": 0.02}  # with the noise of a usual sensor


@dataclass(frozen=True)
class Separating:
    """A plan file, what it is in words, and by how much the two differ in it.

    `level`: rms over time and channels, in the noise of a usual sensor; `differs`: by channel, in its unit.
    """

    text: str
    words: str
    level: float
    differs: Mapping[str, float]

    def in_words(self) -> str:
        """The difference in the channel that shows it best: "12.3 N m rms in shaft_torque_nm"."""
        channel = max(self.differs, key=lambda name: self.differs[name] / _CHANNELS[name])
        return f"{quantity(self.differs[channel], unit_of(channel))} rms in {channel}"


def separating(one: Guess, two: Guess, trial: Trial, names: tuple[str, str]) -> Separating | None:
    """The best of the plans; None if neither can be executed on both guesses."""
    best: Separating | None = None
    for words, steps in _plans(trial.targets.plan):
        plan, text = _plan(steps, words, names)
        try:
            a, b = (trial.run(plan, guess) for guess in (one, two))
        except HilError:
            continue
        differs = _differences(a, b)
        level = float(np.sqrt(np.mean([(rms / _CHANNELS[name]) ** 2 for name, rms in differs.items()])))
        if best is None or level > best.level:
            best = Separating(text, words, level, differs)
    return best


def _plans(plan: Plan) -> list[tuple[str, list[dict[str, Any]]]]:
    controllers = dict.fromkeys(
        str(step.file) for step in plan.steps if isinstance(step, SetController) and step.file
    )
    stepped = [segment for segment in plan.segments if segment.quantity == "driving_torque"]
    largest = max((abs(segment.reference_after) for segment in stepped), default=0.0)
    found: list[tuple[str, list[dict[str, Any]]]] = []
    for speed in _SPEEDS_KM_H:
        for share in _SHARES:
            steps: list[dict[str, Any]] = []
            for number, file in enumerate(controllers):
                steps += [
                    {"set_controller": {"file": Path(file).name}},
                    {"hold_speed": {"speed_km_h": speed, "duration_s": 2}},
                    _step(f"step_{number + 1}", "driving_torque", round(share * largest, 1)),
                ]
            if steps and largest:
                found.append((f"steps of {share * largest:g} N m at {speed:g} km/h", steps))
    held = {"hold_speed": {"speed_km_h": 20.0, "duration_s": 2}}
    found.append(
        (f"a step of {_MOTOR_NM:g} N m of motor torque", [held, _step("open", "motor_torque", _MOTOR_NM)])
    )
    return found


def _step(segment: str, quantity: str, torque_nm: float) -> dict[str, Any]:
    values = {"from_nm": 0, "to_nm": torque_nm, "before_s": 1, "after_s": 8}
    return {"step": {"segment": segment, "quantity": quantity, **values}}


def _plan(steps: list[dict[str, Any]], words: str, names: tuple[str, str]) -> tuple[Plan, str]:
    table = {
        "name": "separate",
        "title": f"Test that tells {names[0]} from {names[1]}",
        "steps": steps,
        "finally": [{"ramp_down": {"duration_s": 4}}],
    }
    text = (
        f"# Tells {names[0]} from {names[1]}: {words}.\n"
        "# Carry it out with 'hil run' on the bench and on both models, and compare with 'hil compare'.\n"
        + str(yaml.safe_dump(table, sort_keys=False))
    )
    return plan_from_text(text, "separating plan", Path()), text


def _differences(one: Predicted, two: Predicted) -> dict[str, float]:
    """Rms over time of the difference in each channel, all segments alike."""
    differs = {}
    for channel in _CHANNELS:
        squares = []
        for a, b in zip(one.segments, two.segments, strict=True):
            x = one.recording.between(a.step_s, a.end_s)[channel]
            y = two.recording.between(b.step_s, b.end_s)[channel]
            count = min(len(x), len(y))
            squares.append(np.mean((x[:count] - y[:count]) ** 2))
        differs[channel] = float(np.sqrt(np.mean(squares)))
    return differs
