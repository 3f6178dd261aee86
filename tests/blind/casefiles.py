"""Measures a case and writes what the diagnosis may see; the answer is sealed."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from hil.core.channels import INPUT, OUTPUTS, TIME
from hil.core.model import save_model
from tests.blind.cases import Case
from tests.blind.experiments import SAMPLE_S, Experiment
from tests.blind.plant import Array, Truth, read_by_sensors, true_outputs
from tests.blind.sensors import coloured_noise

LOAD = "dyno_torque_ref_nm"
_MAIN, _HOLDOUT, _SEALED = "recordings", "holdout", "answer.json"


@dataclass(frozen=True)
class Answer:
    """What a case hides: opened after the diagnosis.

    `noise` and `holdout_noise` are rms(noise) / rms(measured - its mean) of each channel over the recordings
    together, from the noise that was really added (rounding included, and what a sensor drifts).
    """

    effects: tuple[tuple[str, dict[str, float | str]], ...]
    share: float
    noise: dict[str, float]
    holdout_noise: dict[str, float]


@dataclass(frozen=True)
class OpenFiles:
    """Paths of a case that the diagnosis is given."""

    model: Path
    recordings: tuple[Path, ...]
    holdout: tuple[Path, ...]


def write_case(case: Case, directory: Path) -> tuple[OpenFiles, Answer]:
    """Write model.toml and the recordings as CSV; return their paths and the sealed answer."""
    model = directory / "model.toml"
    by_the_dyno = any(one.load_nm is not None for one in case.experiments)
    save_model(replace(case.model, load_input=LOAD) if by_the_dyno else case.model, model)
    main, noise = _measure(case, case.experiments, 1, directory / _MAIN)
    holdout, holdout_noise = _measure(case, case.holdout, 2, directory / _HOLDOUT)
    answer = Answer(tuple((h.id, h.values) for h in case.hidden), case.share, noise, holdout_noise)
    return OpenFiles(model, main, holdout), answer


def seal_answer(directory: Path, kind: str, answer: Answer) -> None:
    """Write the answer where only the scoring looks; its presence says that the case is complete."""
    text = json.dumps({"kind": kind, "answer": asdict(answer)}, indent=1)
    (directory / _SEALED).write_text(text, encoding="utf-8")


def open_answer(directory: Path) -> tuple[str, Answer]:
    """Kind of the true plant, and what was hidden."""
    data = json.loads((directory / _SEALED).read_text(encoding="utf-8"))
    hidden = data["answer"]
    effects = tuple((str(id_), dict(values)) for id_, values in hidden["effects"])
    return str(data["kind"]), Answer(effects, hidden["share"], hidden["noise"], hidden["holdout_noise"])


def drawn_case(directory: Path) -> OpenFiles | None:
    """The files of a case that was drawn before; None where there is none, or only half of one."""
    if not (directory / _SEALED).is_file():
        return None
    main, held = (tuple(sorted((directory / place).glob("*.csv"))) for place in (_MAIN, _HOLDOUT))
    return OpenFiles(directory / "model.toml", main, held)


def _measure(
    case: Case, experiments: tuple[Experiment, ...], stream: int, directory: Path
) -> tuple[tuple[Path, ...], dict[str, float]]:
    directory.mkdir()
    rng = np.random.default_rng([case.seed, stream, len(case.spec.key), *case.spec.key.encode()])
    paths, shown, errors = [], [], []
    for experiment in experiments:
        request, reading, clean = _recorded(case, experiment, rng)
        shown.append(reading)
        errors.append(reading - clean)
        path = directory / f"{experiment.name}.csv"
        columns: dict[str, Array] = {
            TIME: np.arange(len(request), dtype=np.float64) * SAMPLE_S,
            INPUT: request,
        }
        if experiment.load_nm is not None:
            columns[LOAD] = experiment.load_nm
        columns |= {name: reading[:, i] for i, name in enumerate(OUTPUTS) if name in case.channels}
        _write_csv(columns, path)
        paths.append(path)
    together, error = np.concatenate(shown), np.concatenate(errors)
    ratio = np.sqrt(np.mean(error**2, axis=0)) / np.std(together, axis=0)
    return tuple(paths), dict(zip(OUTPUTS, ratio.tolist(), strict=True))


def _write_csv(columns: dict[str, Array], path: Path) -> None:
    """As `hil.core.recording` writes it, to the byte, in a fifth of the time: a case has 1.3e6 numbers."""
    table = np.stack(list(columns.values()), axis=1)
    line = ",".join(["%.9g"] * len(columns)) + "\n"
    text = line * len(table) % tuple(table.ravel().tolist())
    path.write_text(",".join(columns) + "\n" + text, encoding="utf-8")


def _recorded(case: Case, experiment: Experiment, rng: np.random.Generator) -> tuple[Array, Array, Array]:
    """(torque request, what the channels read, the same without noise and rounding)."""
    samples = len(experiment.torque_nm)
    noise = np.stack(
        [
            coloured_noise(
                rng,
                samples,
                float(deviation),
                share=case.noise.share,
                corner_hz=case.noise.corner_hz,
                rate_hz=1.0 / SAMPLE_S,
            )
            for deviation in case.noise.deviations
        ],
        axis=1,
    )
    seat = rng.uniform(-1.0, 1.0)
    request, outputs = true_outputs(case.truth, experiment, noise=noise, seat=seat)
    if not math.isfinite(float(np.sum(outputs))):
        raise FloatingPointError(f"{case.spec.key}: the reference plant diverged in {experiment.name}")
    reading = read_by_sensors(case.truth, outputs, noise)
    kept = tuple(replace(s, drift=0.0) for s in case.truth.sensors if s.step == 0.0)
    unrounded = Truth(case.truth.kind, {}, {}, kept)
    return request, reading, read_by_sensors(unrounded, outputs, np.zeros_like(noise))
