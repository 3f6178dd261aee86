"""What a designed loop must keep: refused when unstable, warned of when poor."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hil.analysis.control_design._closed_loop import closed_loop_poles
from hil.analysis.control_design._loop import Margins
from hil.analysis.control_design._spec import DesignSpec, Robustness
from hil.core.effects import finite_number
from hil.core.errors import BadInputError
from hil.core.model import Model, TransferFunction

#: A loop beyond these is stable but poor. 2 (6 dB) of |S| is the usual bound for a robust loop; it
#: implies about 29 degrees and 6 dB.
LARGEST_SENSITIVITY = 2.0
LEAST_PHASE_MARGIN_DEG = 30.0
LEAST_GAIN_MARGIN_DB = 6.0
#: Poles this near to the unit circle take over 1000 s to grow at 1 kHz: rounding, not instability.
_OUTSIDE = 1.0 + 1e-6


def refuse_unstable(
    plant: TransferFunction, blocks: Sequence[TransferFunction], spec: DesignSpec, found: Margins
) -> None:
    """Refuse a closed loop that grows on the model itself.

    Both the poles of the sampled loop and Nyquist's criterion are asked: each may miss what the other sees
    when a model's numbers are extreme.

    Args:
        plant: motor speed over motor torque, with its dead time.
        blocks: the feedback in series.
        spec: what was asked for.
        found: of the sampled loop.

    Raises:
        BadInputError: the loop is unstable: where it grows, how fast, |S|max, and what to change.
    """
    poles = closed_loop_poles(plant, blocks, spec.sample_time_s)
    outside = poles[np.abs(poles) > _OUTSIDE]
    if found.stable and not outside.size:
        return
    if outside.size:
        worst = outside[np.argmax(np.abs(outside))]
        hz = abs(float(np.angle(worst))) / (2 * np.pi * spec.sample_time_s)
        grows_s = spec.sample_time_s / float(np.log(np.abs(worst)))
        what = (
            f"{outside.size} closed-loop pole{'s lie' if outside.size > 1 else ' lies'} outside the unit "
            f"circle, the worst at {hz:.3g} Hz, growing e-fold every {grows_s * 1e3:.3g} ms"
        )
    else:
        what = "by Nyquist's criterion the loop encircles -1"
    raise BadInputError(
        f"the closed loop is unstable on this model: {what}; |S|max {found.sensitivity_peak:.3g} "
        f"at {found.sensitivity_peak_hz:.3g} Hz",
        fix=_change(spec),
    )


def _change(spec: DesignSpec) -> str:
    lower = f"lower --pole (it is {spec.pole_rad_s:g} rad/s; gains grow with it)"
    if spec.stabilisation == "gain":
        where = "at the resonance" if spec.notch_hz is None else f"at {spec.notch_hz:g} Hz"
        part = f"move or widen the notch (it is {where}, width {spec.notch_width:g})"
    else:
        part = (
            f"change --lead-deg, --lead-hz or --normalisation (they are {spec.lead_deg:g} degrees, "
            f"{spec.lead_hz:g} Hz, {spec.normalisation}), or let --optimize search"
        )
    return f"{lower}, {part}; if these values are intended, check the model's dead time and units"


def warnings_of(found: Margins, worst: Robustness) -> tuple[str, ...]:
    """Plain sentences on what a stable loop lacks, on the model itself and in the worst draw."""
    warnings = _poor(
        "on the nominal model", found.sensitivity_peak, found.phase_margin_deg, found.gain_margin_db
    )
    if worst.stable_share < 1.0:
        warnings.append(
            f"the loop is unstable for {1 - worst.stable_share:.0%} of the plants that the model's "
            f"uncertainty allows ({worst.source}): it may oscillate on the axle"
        )
    elif not warnings:
        warnings = _poor(
            f"in the worst of {worst.source}",
            worst.sensitivity_peak,
            worst.phase_margin_deg,
            worst.gain_margin_db,
        )
    return tuple(warnings)


def _poor(where: str, sensitivity: float, phase_deg: float, gain_db: float) -> list[str]:
    found = []
    if not sensitivity <= LARGEST_SENSITIVITY:
        found.append(f"|S|max is {sensitivity:.3g} {where}; a robust loop keeps {LARGEST_SENSITIVITY:g}")
    if not phase_deg >= LEAST_PHASE_MARGIN_DEG:
        found.append(f"the phase margin is {phase_deg:.3g}° {where}; {LEAST_PHASE_MARGIN_DEG:g}° are usual")
    if not gain_db >= LEAST_GAIN_MARGIN_DB:
        found.append(f"the gain margin is {gain_db:.3g} dB {where}; {LEAST_GAIN_MARGIN_DB:g} dB are usual")
    return found


def beyond_the_data(model: Model, found: Margins) -> list[str]:
    """What lies outside of the frequencies that the model was identified from, in a sentence for people."""
    band = model.meta.get("band_hz")
    if not (isinstance(band, list | tuple) and len(band) == 2):
        return []
    low_hz, high_hz = (finite_number(end) for end in band)
    if low_hz is None or high_hz is None:
        return []
    places_hz = {
        "|S|max": found.sensitivity_peak_hz,
        "the gain margin": found.gain_margin_hz,
        "the phase margin": found.phase_margin_hz,
    }
    beyond = [
        f"{name} at {hz:.3g} Hz"
        for name, hz in places_hz.items()
        if np.isfinite(hz) and not low_hz <= hz <= high_hz
    ]
    if not beyond:
        return []
    return [
        f"outside of the data ({low_hz:.3g}-{high_hz:.3g} Hz) that the model was identified from: "
        f"{', '.join(beyond)}: no measurement supports them there"
    ]
