"""The diagnosis on cases with known answers: right names, reliability, intervals, models given back, time.

    python -m benchmarks.missing_effects own                 # a turning mass by other formulas
    python -m benchmarks.missing_effects real --data DIR     # drives of others, docs/reference/real-data.md
    python -m benchmarks.missing_effects blind [--every 20]  # every 20th case of the blind set's plants

`own` and `real` ask from four bases each. A line has case, base, truth, right or wrong, names with
confidence, the largest gap left, processor time in seconds. Ctrl-C ends a run with the figures of what was
asked.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.real_data.__main__ import DATA_SETS, missing
from hil.analysis.diagnosis import diagnose
from hil.core.errors import HilError
from hil.core.model import Model, load_model
from hil.core.recording import Recording, read_recording
from hil.plant import replay
from tests.blind.casefiles import write_case
from tests.blind.diagnosing import Reply
from tests.blind.draws import draw
from tests.blind.fairness import label_of
from tests.blind.scoring import SAME, Score, names_of, score
from tests.blind.specs import Spec, full_set
from tests.hil.analysis.missing_effects.turning_mass import base, recording

_SURE = 0.9
_CONFIDENCES = (0.0, 0.5, 0.7, 0.9, 0.97, 1.01)
_TWO_SIDED_95 = 1.96
#: Counted in the blind set alone: other bases have wrong numbers on purpose, a drive's readings are rounded.
_ASIDE = ("parameter_mismatch", "sensor_quantization")


@dataclass(frozen=True)
class Case:
    """One question: a base, recordings, what is hidden (empty: nothing with a name), how to judge.

    Names in `beside` are neither asked for nor wrong. `off` gives how many standard errors numbers are off,
    `official` what a model reaches in a public benchmark's own measure.
    """

    name: str
    base: str
    model: Model
    recordings: Sequence[Recording]
    holdout: Sequence[Recording]
    truth: tuple[str, ...]
    right: Callable[[dict[str, Any]], bool]
    beside: Sequence[str] = ()
    off: Callable[[dict[str, Any]], Sequence[float]] = lambda answer: ()
    official: Callable[[Model], str] = lambda model: ""


@dataclass
class Tally:
    """Answers: right or not, and each name that was given, with its confidence.

    `off` are numbers of named effects by their distance from the truth in standard errors, `given_back` gaps
    of the model given back, simulated from the first samples, over those in the answer.
    """

    right: list[bool] = field(default_factory=list)
    off: list[float] = field(default_factory=list)
    given_back: list[float] = field(default_factory=list)
    named: list[tuple[float, bool]] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)

    def line(self) -> str:
        """The figures."""
        wrong = sum(c >= 0.5 and not ok for c, ok in self.named)
        sure = [ok for c, ok in self.named if c >= _SURE]
        middle, high = np.quantile(self.seconds, (0.5, 0.95))
        return (
            f"right {sum(self.right)} of {len(self.right)}; wrong names at 0.5 and more: {wrong}; "
            f"of {len(sure)} names at 0.9 and more {sum(sure)} right; "
            f"{middle:.1f} s median, {high:.1f} s 95th"
        )

    def calibration(self) -> Iterator[str]:
        """Confidence against frequency, intervals that hold the truth, models given back."""
        away = 0.0
        for low, high in pairwise(_CONFIDENCES):
            inside = [(c, ok) for c, ok in self.named if low <= c < high]
            if inside:
                told = float(np.mean([c for c, _ in inside]))
                true = float(np.mean([ok for _, ok in inside]))
                away += len(inside) * abs(told - true) / len(self.named)
                yield f"  confidence {told:.2f}: {true:.2f} right, of {len(inside)}"
        yield f"  mean |confidence - frequency| {away:.3f}"
        if self.off:
            held = np.mean(np.abs(self.off) < _TWO_SIDED_95)
            yield f"  95 % intervals hold the truth: {100 * held:.0f} % of {len(self.off)}"
        if self.given_back:
            apart = np.abs(np.array(self.given_back) - 1.0)
            yield (
                f"  gap of the model given back against the answer's: {100 * np.median(apart):.1f} % "
                f"median, {100 * np.quantile(apart, 0.95):.1f} % 95th of {len(apart)}"
            )


def main(arguments: Sequence[str] | None = None) -> int:
    """Print a line for each case and the figures; 2 where no case is there."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.missing_effects",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("group", choices=("own", "real", "blind"))
    parser.add_argument("names", nargs="*", help="only data sets, or subjects, of these names")
    parser.add_argument("--data", type=Path, default=Path(), help="directory of data sets")
    parser.add_argument("--part", default="", help="only this group of the blind set")
    parser.add_argument("--every", type=int, default=20, help="of the blind set's cases")
    parser.add_argument("--seed", type=int, default=11, help="of the blind set")
    options = parser.parse_intermixed_args(arguments)
    unknown = [name for name in options.names if options.group == "real" and name not in DATA_SETS]
    if unknown:
        parser.error(f"no data set {unknown[0]}; there are {', '.join(DATA_SETS)} (--data: where they are)")
    tally = Tally()
    try:
        for case in _cases(options):
            _asked(case, tally)
    except KeyboardInterrupt:
        print("stopped; figures of what was asked so far", file=sys.stderr)
    if not tally.right:
        print("no case is there", file=sys.stderr)
        return 2
    print(tally.line())
    print("\n".join(tally.calibration()))
    return 0


def _asked(case: Case, tally: Tally) -> None:
    """Ask, and print a line."""
    began = time.process_time()
    try:
        answer = _answer(case)
    except (HilError, ArithmeticError, ValueError, np.linalg.LinAlgError) as error:
        answer = {"verdict": f"failed ({str(error)[:60]})", "effects": []}
    cell = _cell(case, answer, time.process_time() - began, tally)
    print(f"{case.name:<42}{case.base:<10}{' + '.join(case.truth) or '-':<34}{cell}", flush=True)


def _cell(case: Case, answer: dict[str, Any], took: float, tally: Tally) -> str:
    right = case.right(answer)
    tally.right.append(right)
    tally.seconds.append(took)
    tally.off.extend(case.off(answer))
    tally.given_back.extend(answer.get("given_back", []))
    named = []
    for effect in answer["effects"]:
        label, *alike = names_of(effect)
        named.append(f"{'~'.join([label, *alike])} {effect['confidence']:.2f}")
        if case.base == "blind" or effect["id"] not in _ASIDE:
            tally.named.append(
                (float(effect["confidence"]), bool({label, *alike} & {*case.truth, *case.beside}))
            )
    gaps = answer.get("holdout_gap") or answer.get("gap") or {}
    left = max((100.0 * float(gap["after"]) for gap in gaps.values()), default=float("nan"))
    text = " + ".join(named) or str(answer["verdict"])
    reached = f", {answer['official']}" if answer.get("official") else ""
    return f"{'right' if right else 'WRONG'} {text}, {left:.2g} % left, {took:.1f} s{reached}"


def _answer(case: Case) -> dict[str, Any]:
    found = diagnose(case.model, case.recordings, case.holdout)
    said = found.as_json()
    stated = said["holdout_gap"] or said["gap"]
    gaps = {name: one["after"] for name, one in stated.items() if name in case.recordings[0]}
    try:
        back = _gaps(found.model, case.holdout or case.recordings, tuple(gaps))
    except HilError:  # too stiff to be simulated as users do it
        back = dict.fromkeys(gaps, float("inf"))
    return said | {
        "given_back": [back[name] / gaps[name] for name in gaps],
        "official": case.official(found.model),
    }


def _gaps(model: Model, recordings: Sequence[Recording], channels: Sequence[str]) -> dict[str, float]:
    """What a model leaves of each channel, simulated as anyone does it, of the channel's deviation."""
    shown = [replay(model, one) for one in recordings]
    found = {}
    for name in channels:
        measured = np.concatenate([one[name] for one in recordings])
        error = measured - np.concatenate([one[name] for one in shown])
        found[name] = float(np.sqrt(np.mean(error**2)) / np.std(measured))
    return found


def _cases(options: argparse.Namespace) -> Iterator[Case]:
    if options.group == "own":
        yield from _own()
    elif options.group == "real":
        yield from _real(options.data, options.names)
    else:
        yield from _blind(options)


def _exactly(truth: Sequence[str], beside: Sequence[str] = ()) -> Callable[[dict[str, Any]], bool]:
    """The names alone, numbers, rounding and what may stand beside apart; where there is none, no name."""

    def right(answer: dict[str, Any]) -> bool:
        named = [{*names_of(e)} for e in answer["effects"] if e["id"] != "parameter_mismatch"]
        return _holds([one for one in named if not one & {*beside}], truth)

    return right


def _holds(named: Sequence[set[str]], truth: Sequence[str]) -> bool:
    """Whether classes of names are as many as what is hidden, and each of it is in one."""
    return len(named) == len(truth) and all(any(name in one for one in named) for name in truth)


def _own() -> Iterator[Case]:
    for name, numbers, truth in (
        ("viscous 2.17, Coulomb 1.39", (0.54, 2.17, 1.39, 0.0), ("coulomb_friction",)),
        ("viscous 2.17 alone", (0.54, 2.17, 0.0, 0.0), ()),
        ("pendulum 4 N m, Coulomb 0.3", (0.54, 1.0, 0.3, 4.0), ("coulomb_friction", "motor_order_ripple")),
    ):
        torque = 6.0 if numbers[3] else 20.0
        fit, held = (recording(*numbers, torque_nm=torque, seed=seed) for seed in (0, 5))
        for which, model in _bases(base(numbers[0], numbers[1])).items():
            yield Case(name, which, model, [fit], [held], truth, _exactly(truth))


def _bases(model: Model) -> dict[str, Model]:
    """A base as it is, without drag, and of half and three times the inertia."""
    still = {name: 0.0 for name in model.parameters if name.endswith(("drag", "damping"))}
    return {
        "as it is": model,
        "no drag": model.with_parameters(**still),
        "half J": with_inertias(model, 0.5),
        "3 J": with_inertias(model, 3.0).with_parameters(**still),
    }


def with_inertias(model: Model, factor: float) -> Model:
    """A model whose inertias are all that many times what they are."""
    inertias = [name for name in model.parameters if name.endswith("inertia")]
    return model.with_parameters(**{name: factor * model.parameters[name] for name in inertias})


def _real(directory: Path, names: Sequence[str]) -> Iterator[Case]:
    for name in names or DATA_SETS:
        one = DATA_SETS[name]
        absent = missing(one, one.place(directory))
        if absent:
            print(f"{name}: {absent[0]} is not in {one.place(directory)}", file=sys.stderr)
            continue
        measured = one.read(one.place(directory))
        start = next(iter(measured.starts.values()))
        for which, model in _bases(start).items():
            right = _exactly(one.hidden, one.beside)
            yield Case(
                name,
                which,
                model,
                measured.recordings,
                measured.holdout,
                one.hidden,
                right,
                one.beside,
                official=partial(one.official, one.place(directory)),
            )


def blind_cases(seed: int, every: int) -> Iterator[Case]:
    """Each so-and-so-many-th case of the blind set."""
    return _blind(argparse.Namespace(seed=seed, every=every, names=[], part=""))


def _blind(options: argparse.Namespace) -> Iterator[Case]:
    specs = [
        s
        for s in full_set()
        if (not options.names or s.subject.split(":")[0] in options.names) and options.part in ("", s.group)
    ]
    for spec in specs[:: options.every]:
        with tempfile.TemporaryDirectory() as place:
            files, answer = write_case(draw(options.seed, spec), Path(place))
            model = load_model(files.model)
            fit, held = (
                [replace(read_recording(path), source=path) for path in paths]
                for paths in (files.recordings, files.holdout)
            )
        truth = tuple(SAME.get(t, t) for t in (label_of(id, values) for id, values in answer.effects))

        def judged(
            found: dict[str, Any], spec: Spec = spec, answer: Any = answer, kind: str = model.kind
        ) -> Score:
            failed = str(found["verdict"]) if str(found["verdict"]).startswith("failed") else ""
            return score(spec, kind, answer, Reply(found, failed, 0.0))

        def right(found: dict[str, Any], judged: Callable[[dict[str, Any]], Score] = judged) -> bool:
            return judged(found).right

        def off(found: dict[str, Any], judged: Callable[[dict[str, Any]], Score] = judged) -> Sequence[float]:
            return [*judged(found).standard_errors_off.values()]

        yield Case(
            f"{spec.key} {model.kind}",
            "blind",
            model,
            fit,
            held,
            truth,
            right,
            off=off,
        )


if __name__ == "__main__":
    sys.exit(main())
