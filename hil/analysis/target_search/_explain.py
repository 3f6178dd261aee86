"""From target figures to ranked rivals: what in axle or controller would give them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from hil.analysis.target_search._conditions import Condition, conditions_of
from hil.analysis.target_search._plausible import candidates
from hil.analysis.target_search._search import Found, Search
from hil.analysis.target_search._separating import Separating, separating
from hil.analysis.target_search._targets import Targets
from hil.analysis.target_search._trial import CarryOut, Guess, Outcome, Trial, guess_at
from hil.core.errors import BadInputError
from hil.core.errors.wording import did_you_mean
from hil.core.model import Model, model_to_toml

#: Rivals that are reported.
RIVALS = 4
#: Guesses of each that are tried on all conditions until one holds them.
_CHECKED = 24


@dataclass(frozen=True)
class Rival:
    """A guess with what it gives in the whole plan, and the conditions that it holds or misses."""

    names: tuple[str, ...]
    guess: Guess
    model: Model
    outcome: Outcome
    conditions: tuple[Condition, ...]
    cost: float
    numbers: int

    @property
    def name(self) -> str:
        """Its effects; 'controller' stands for the controller's open numbers."""
        return " + ".join(self.names)

    @property
    def missed(self) -> tuple[Condition, ...]:
        """Conditions that do not hold."""
        return tuple(condition for condition in self.conditions if not condition.holds)

    def as_json(self, model_file: str) -> dict[str, Any]:
        """As it stands in targets.json."""
        return {
            "effects": [{"id": id_, "parameters": dict(v)} for id_, v in self.guess.effects.items()],
            "rmcu_keeps": dict(self.guess.held),
            "free_numbers": self.numbers,
            "cost": self.cost,
            "figures": dict(self.outcome.figures),
            "early_figures": dict(self.outcome.early),
            "conditions": [
                {"name": c.name, "found": c.found, "limit": c.limit, "unit": c.unit, "holds": c.holds}
                for c in self.conditions
            ],
            "missed": [c.name for c in self.missed],
            "model": model_file,
        }


@dataclass(frozen=True)
class Explanation:
    """What a search came to; rivals best first, those that miss the fewest conditions before others."""

    targets: Targets
    base: Rival
    rivals: tuple[Rival, ...]
    separating: Separating | None
    searched: tuple[str, ...]
    evaluations: int
    interrupted: bool

    @property
    def reached(self) -> bool:
        """Whether the best rival holds every condition."""
        return bool(self.rivals) and not self.rivals[0].missed

    @property
    def verdict(self) -> str:
        """In one sentence."""
        if not self.rivals:
            return "No run was predicted."
        best = self.rivals[0]
        if self.reached:
            held = sum(not rival.missed for rival in self.rivals)
            return f"{held} of {len(self.rivals)} rivals meet every condition; the best is {best.name}."
        missed = "; ".join(_in_words(condition) for condition in best.missed)
        return f"No rival meets every condition. The closest, {best.name}, misses {missed}."


def _in_words(condition: Condition) -> str:
    found = "no value" if condition.found is None else f"{condition.found:.4g}"
    return f"{condition.name}: {found}, wanted {condition.limit} {condition.unit}"


def _shaft_torque_nm(trial: Trial) -> float:
    """What the plan brings to the shaft: its steps of driving torque, else what the base model predicts."""
    steps = [s for s in trial.targets.plan.segments if s.quantity == "driving_torque"]
    largest = max((abs(segment.reference_after) for segment in steps), default=0.0)
    if not largest:
        predicted = trial.run(trial.plan, Guess({}, {})).recording
        largest = float(np.max(np.abs(predicted["shaft_torque_nm"]), initial=0.0))
    if not largest:
        raise BadInputError(
            "the plan applies no torque to the shaft, so no effect is visible",
            where=trial.plan.name,
            fix="name a plan with steps or a chirp",
        )
    return largest


def explain(
    base: Model,
    execute: CarryOut,
    targets: Targets,
    *,
    evaluations: int,
    among: Sequence[str] = (),
    seed: int = 0,
    show: Callable[[str, float | None], None] = lambda text, share: None,
    stopped: Callable[[], bool] = lambda: False,
) -> Explanation:
    """Search for what brings the predicted run to the targets; `execute` predicts runs.

    Only candidates `among` are looked at, all if there are none.

    Raises:
        BadInputError: a base model that carries no effect, no candidate of a name, or a plan that cannot be
            predicted or brings no torque.
    """
    trial = Trial(base, execute, targets)
    every = candidates(base, _shaft_torque_nm(trial), targets.open)
    if not every:
        raise BadInputError(
            f"a '{base.kind}' model carries no effect", fix="give a two- or three-inertia model"
        )
    known = {candidate.id: candidate for candidate in every}
    for name in among:
        if name not in known:
            raise BadInputError(f"there is no candidate '{name}'", fix=did_you_mean(name, known))
    every = tuple(known[name] for name in dict.fromkeys(among)) or every
    search = Search(trial, evaluations, seed, show, stopped)
    search.execute(every)
    show("checking the best", None)
    rivals = [_of_set(search.places(found.chosen, _CHECKED), trial) for found in search.best[:RIVALS]]
    rivals.sort(key=lambda rival: (len(rival.missed), rival.cost))
    test = None
    if len(rivals) > 1:
        show("searching for a test that distinguishes them", None)
        test = separating(rivals[0].guess, rivals[1].guess, trial, (rivals[0].name, rivals[1].name))
    start = _rival(("model as it came",), Guess({}, {}), trial)
    searched = tuple(candidate.id for candidate in every)
    return Explanation(targets, start, tuple(rivals), test, searched, search.done, search.interrupted)


def _of_set(places: Sequence[Found], trial: Trial) -> Rival:
    """The first guess of a set that holds every condition, identification too, or misses the fewest.

    The search knows all conditions but what an identification run returns: others are tried for that alone.
    """
    rivals = []
    for found in places:
        names = tuple(candidate.id for candidate in found.chosen)
        rivals.append(_rival(names, guess_at(found.point, found.chosen), trial))
        if not rivals[-1].missed or any(not condition.identified for condition in rivals[-1].missed):
            break
    return min(rivals, key=lambda rival: (len(rival.missed), rival.cost))


def _rival(names: tuple[str, ...], guess: Guess, trial: Trial) -> Rival:
    outcome = trial.of(guess)
    conditions = conditions_of(guess, outcome, trial)
    numbers = len(guess.held) + sum(len(values) for values in guess.effects.values())
    cost = outcome.cost(trial.targets)
    return Rival(names, guess, guess.model(trial.base), outcome, conditions, cost, numbers)


def files_of(found: Explanation) -> dict[str, bytes]:
    """Model files of the rivals, and the plan that tells the first two apart."""
    files = {}
    for number, rival in enumerate(found.rivals, 1):
        files[model_name(number)] = _model_text(rival).encode()
    if found.separating is not None:
        files[SEPARATING] = found.separating.text.encode()
    return files


def _model_text(rival: Rival) -> str:
    lines = [f"# Rival '{rival.name}' of hil explain."]
    if rival.guess.held:
        lines.append("# Its RMCU keeps, under [simulation.rmcu] of the bench file:")
        lines += [f"#   {name} = {value:.6g}" for name, value in rival.guess.held.items()]
    return "\n".join([*lines, model_to_toml(rival.model)])


SEPARATING = "separating_plan.yaml"


def model_name(number: int) -> str:
    """File name of a rival's model, numbered from 1."""
    return f"rival_{number}.toml"
