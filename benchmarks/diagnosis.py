"""How often the diagnosis is right, on hidden cases of the tests' own plant: accuracy, errors, time.

    python -m benchmarks.diagnosis [--seed 1] [--size medium] [--noise 1] [CASE ...]

A case is effect names joined by '+', or 'none'; the default is every effect alone, nothing, some pairs
and some effects outside the registry.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import numpy as np

from hil.analysis.diagnosis import Diagnosis, diagnose
from hil.core.model import load_model
from tests.hil.analysis.diagnosis.hidden_cases import EFFECTS, OUTSIDE, SIZES, draw
from tests.hil.analysis.diagnosis.reference_plant import recordings

PAIRS = (
    "backlash+sensor_gain",
    "coulomb_friction+dead_time",
    "viscous_drag+mount_mode",
    "torque_saturation+actuator_lag",
    "shaft_cubic_stiffness+running_resistance",
)
UNKNOWN = ("tyre_slip", "fixed_line", "stiffness_drift")
NOISE = (0.15, 0.02, 1.5)
HELD_OUT = ("multisine", "reversals")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("cases", nargs="*", default=["none", *EFFECTS, *PAIRS, *UNKNOWN])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--size", choices=sorted(SIZES), default="medium")
    parser.add_argument("--noise", type=float, default=1.0)
    chosen = parser.parse_args()
    model = load_model(Path(__file__).parents[1] / "benches/three_inertia.toml").with_effects()
    right, ratios, errors, times = [], [], [], []
    for case in chosen.cases:
        effects = tuple(name for name in case.split("+") if name != "none")
        truth, answer = draw(effects, SIZES[chosen.size], chosen.seed)
        a, b, c = (chosen.noise * level for level in NOISE)
        all_of_them = recordings(truth, chosen.seed, noise=(a, b, c))
        held = [r for r in all_of_them if r.source.stem in HELD_OUT]
        began = time.perf_counter()
        found = diagnose(model, [r for r in all_of_them if r.source.stem not in HELD_OUT], held)
        times.append(time.perf_counter() - began)
        ok = _is_right(found, answer)
        right.append(ok)
        ratio = max(g.gap / g.noise_floor for g in found.holdout_after.values())
        off = _errors(found, answer)
        errors += off
        if ok and len(effects) == 1 and effects[0] not in OUTSIDE:
            ratios.append(ratio)
        names = ", ".join(e.use.id for e in found.effects) or found.verdict
        print(
            f"{'right' if ok else 'WRONG':<6}{case:<44}{names:<40}{ratio:6.3f}{times[-1]:7.1f} s", flush=True
        )
    print(f"right {np.mean(right):.1%} of {len(right)}; time per case, median {np.median(times):.1f} s")
    if ratios:
        middle, high = np.quantile(ratios, (0.5, 0.95))
        print(f"held-out gap / noise, single: {middle:.3f} median, {high:.3f} p95")
    if errors:
        print(f"parameter error: {np.median(errors):.2%} median")


def _is_right(found: Diagnosis, answer: list[tuple[str, str, dict[str, float]]]) -> bool:
    if any(name in OUTSIDE for name, _, _ in answer):
        return found.verdict == "unknown"
    named = {
        (e.use.id, str(e.use.values.get("channel", e.use.values.get("parameter", "")))) for e in found.effects
    }
    return named == {(name, about) for name, about, _ in answer} and found.verdict != "unknown"


def _errors(found: Diagnosis, answer: list[tuple[str, str, dict[str, float]]]) -> list[float]:
    return [
        abs(float(e.use.values[key]) / value - 1.0)
        for name, _, values in answer
        for e in found.effects
        if e.use.id == name
        for key, value in values.items()
        if key in e.use.values
    ]


if __name__ == "__main__":
    main()
