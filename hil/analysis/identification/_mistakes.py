"""Channels that no axle gives: swapped, turned, in rpm or in kN m; refused by name before anything is fitted.

A fit takes any of these in silence, as an axle of another gear ratio, inertia or sign. What tells are the
laws of `_local_laws`: speeds and torques each give the gear ratio, and inertia is positive. One factor in all
speeds or in all torques leaves every law as it was and scales inertia and stiffness alone: that can only be
doubted.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hil.analysis.frequency_response import Experiment, FrequencyResponse
from hil.analysis.identification._local_laws import RotorLaw, rotor_law, slow_inertia, speed_ratio
from hil.core.channels import INPUT, OUTPUTS
from hil.core.errors import BadInputError

_MOTOR, _WHEEL, _SHAFT = OUTPUTS
_RPM = 60.0 / (2.0 * np.pi)
_KILO = 1000.0

#: Gear ratios of e-axles, with room: in-wheel motors 1, trucks up to 30.
_RATIOS = (0.8, 40.0)
#: A gear ratio that a mistake must leave to be named without another witness: e-axles have 6 to 14.
_USUAL_RATIO = 3.0
#: What is left of a usual gear ratio by a wheel speed in rpm.
_FEW = 1.5
#: Two ways to the gear ratio that differ by more do not belong together; rpm makes 9.5.
_APART = 3.0
#: So near to the factor of rpm they must be: an inverter that gives less than asked makes any factor.
_LIKE_RPM = 1.3
#: Shaft over motor torque that no gear and no resonance makes.
_TORQUE_RATIOS = (0.03, 1000.0)
#: All that turns, seen from the rotor, kg m².
_INERTIAS_KG_M2 = (1e-5, 1e3)
#: Rotors of e-axles have 0.005 to 0.5 kg m², and with all that turns more than ten times as much.
_SMALL_ROTOR_KG_M2 = 0.004
_SMALL_TOTAL_KG_M2 = 0.02
_TORQUE_INPUTS = (INPUT, "motor_torque_nm")
_SIGN, _TO_RAD_S, _TO_NM = "invert the sign of the channel", "multiply it by 2π/60", "multiply it by 1000"


def refuse_mistakes(
    experiments: Sequence[Experiment], frf: FrequencyResponse, gear_ratio: float | None = None
) -> tuple[str, ...]:
    """Refuse channels that are swapped, inverted or in another unit; returns what is doubtful, for people.

    Args:
        experiments: what `frf` was estimated from.
        frf: responses to the input.
        gear_ratio: if known.

    Raises:
        BadInputError: names the channel and what to do.
    """
    where = ", ".join(experiment.name for experiment in experiments)
    speeds = speed_ratio(experiments, frf)
    torque = all(experiment.input_name in _TORQUE_INPUTS for experiment in experiments)
    law = rotor_law(frf) if torque else RotorLaw(None, None)
    wrong = _wrong_size(frf, speeds, law, gear_ratio, torque) or _wrong_sign(frf, speeds, law, torque)
    if wrong is not None:
        raise BadInputError(wrong[0], where=where, fix=wrong[1])
    doubts = _doubts(frf, law) if torque else ()
    if speeds is not None and law.ratio is not None and not _near(abs(speeds), abs(law.ratio)):
        doubts = (
            *doubts,
            f"motor over wheel speed is {speeds:.3g}, the torques say {law.ratio:.3g}: check the "
            "units of the channels, and that the inverter gives the requested torque",
        )
    if speeds is not None and speeds < _FEW and law.ratio is None and gear_ratio is None:
        doubts = (*doubts, f"motor over wheel speed is {speeds:.3g}: is '{_WHEEL}' in rpm?")
    return doubts


def _wrong_size(
    frf: FrequencyResponse, speeds: float | None, law: RotorLaw, gear_ratio: float | None, torque: bool
) -> tuple[str, str] | None:
    """What is swapped or in another unit, and what to do."""
    expected = law.ratio if law.ratio is not None else gear_ratio
    if speeds is not None:
        text = f"motor over wheel speed is {abs(speeds):.3g}"
        if expected is not None and not _near(abs(speeds), abs(expected)):
            whose = "the torques say" if law.ratio is not None else "the gear ratio is"
            named = _apart(abs(speeds), abs(expected), f"{text}, {whose} {abs(expected):.3g}")
            if named is not None:
                return named
        if not _RATIOS[0] <= abs(speeds) <= _RATIOS[1]:
            return _alone(abs(speeds), text)
    if torque and _SHAFT in frf.outputs:
        largest = float(np.max(np.abs(frf.of(_SHAFT))))
        for channel, beyond in ((_SHAFT, largest < _TORQUE_RATIOS[0]), (INPUT, largest > _TORQUE_RATIOS[1])):
            if beyond:
                return f"{channel} looks like kN m: shaft over motor torque is {largest:.3g} at most", _TO_NM
    return None


def _near(one: float, other: float, factor: float = _APART) -> bool:
    return 1.0 / factor < one / other < factor


def _apart(speeds: float, torques: float, observed: str) -> tuple[str, str] | None:
    """Names the mistake that brings both ways to the gear ratio together, if one does."""
    if speeds < _RATIOS[0] and _near(1.0 / speeds, torques):
        return f"{_MOTOR} and {_WHEEL} look swapped: {observed}", "exchange the two columns"
    for channel, ratio in ((_MOTOR, speeds / _RPM), (_WHEEL, speeds * _RPM)):
        if _near(ratio, torques, _LIKE_RPM) and _USUAL_RATIO <= torques <= _RATIOS[1]:
            return f"{channel} looks like rpm: {observed}", _TO_RAD_S
    for channel, ratio in ((_SHAFT, torques * _KILO), (INPUT, torques / _KILO)):
        if _near(ratio, speeds):
            return f"{channel} looks like kN m: {observed}", _TO_NM
    return None


def _alone(speeds: float, observed: str) -> tuple[str, str]:
    """Names a ratio of speeds that no gear has."""
    if speeds > _RATIOS[1]:
        return f"{_MOTOR} looks like rpm: {observed}, no axle's gear has that", _TO_RAD_S
    if speeds * _RPM > _USUAL_RATIO:
        return f"{_WHEEL} looks like rpm: {observed}, no axle's gear has that", _TO_RAD_S
    return f"{_MOTOR} and {_WHEEL} look swapped: {observed}", "exchange the two columns"


def _wrong_sign(
    frf: FrequencyResponse, speeds: float | None, law: RotorLaw, torque: bool
) -> tuple[str, str] | None:
    """What is turned, and what to do."""
    motor = _motor_sign(frf, law) if torque else None
    shaft = None if law.ratio is None else np.sign(law.ratio)
    together = None if speeds is None else np.sign(speeds)
    if motor == -1 and shaft == -1:
        return f"{INPUT} looks inverted: the axle does the opposite", _SIGN
    if motor == -1 and shaft is None and together == 1:
        return f"{INPUT} looks inverted: both speeds fall when torque pushes", _SIGN
    if motor == -1 and together == 1:
        return f"{_MOTOR} and {_WHEEL} look inverted: they fall when torque pushes", "invert the sign of both"
    if motor == -1:
        return f"{_MOTOR} looks inverted: it falls when torque pushes", f"{_SIGN}, or of {INPUT}"
    if shaft == -1:
        return f"{_SHAFT} looks inverted: it falls when torque pushes", f"{_SIGN}, or of {INPUT}"
    if together == -1:
        either = _WHEEL if motor == 1 else f"either {_MOTOR} or {_WHEEL}"
        return f"{either} looks inverted: motor and wheel turn against each other", _SIGN
    return None


def _motor_sign(frf: FrequencyResponse, law: RotorLaw) -> float | None:
    if law.inertia_kg_m2 is not None:
        return float(np.sign(law.inertia_kg_m2))
    slow = slow_inertia(frf, _MOTOR) if _MOTOR in frf.outputs else None
    return None if slow is None else slow[0]


def _doubts(frf: FrequencyResponse, law: RotorLaw) -> tuple[str, ...]:
    """What an axle might just do, and more likely a wrong unit or sign does."""
    doubts = []
    ask = "check whether all speeds are in rpm, or all torques in kN m"
    slow = None if _MOTOR not in frf.outputs else slow_inertia(frf, _MOTOR)
    total = None if slow is None else slow[1]
    if total is not None and not _INERTIAS_KG_M2[0] < total < _INERTIAS_KG_M2[1]:
        doubts.append(
            f"the total inertia is {total:.2g} kg m² at the rotor, not plausible for an axle: {ask}"
        )
    elif law.inertia_kg_m2 is not None and 0.0 < law.inertia_kg_m2 < _SMALL_ROTOR_KG_M2:
        doubts.append(f"the rotor has {law.inertia_kg_m2:.2g} kg m², low for an axle: {ask}")
    elif total is not None and total < _SMALL_TOTAL_KG_M2:
        doubts.append(f"the total inertia is {total:.2g} kg m² at the rotor, low for an axle: {ask}")
    wheel = None if _MOTOR in frf.outputs or _WHEEL not in frf.outputs else slow_inertia(frf, _WHEEL)
    if wheel is not None and wheel[0] < 0.0:
        doubts.append(f"'{_WHEEL}' falls when torque pushes: its sign, or the input's, looks inverted")
    return tuple(doubts)
