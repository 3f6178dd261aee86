"""Between what the numbers of a controller file lie, and why: what is beyond is refused with the file."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

#: The RMCU refuses others.
SAMPLE_TIMES_S = (1e-4, 1e-2)
SLOWEST_HZ = 0.01  # of a lead or a notch: no axle swings slower
LARGEST_TORQUE_NM = 300.0
MOST_SCHEDULE_POINTS = 6  # of a table of gains over speed
MOST_DEAD_TIME_SAMPLES = 64  # that the RMCU's reference of the play waits for
_OTHER_UNIT = "no axle needs more; check the unit"


@dataclass(frozen=True)
class Within:
    """Bounds of a number, both included, and the reason that a message gives."""

    least: float
    most: float
    why: str

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Check after the number itself."""
        return core_schema.no_info_after_validator_function(self._checked, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """The bounds, for editors."""
        return {**handler(schema), "minimum": self.least, "maximum": self.most}

    def _checked(self, value: float) -> float:
        if not self.least <= value <= self.most:
            raise ValueError(f"it lies from {self.least:g} to {self.most:g}: {self.why}")
        return value


SampleTime = Annotated[float, Within(*SAMPLE_TIMES_S, "the range of the RMCU; check that it is in seconds")]
Torque = Annotated[float, Within(1e-3, LARGEST_TORQUE_NM, "the range of the RMCU")]
Gain = Annotated[float, Within(0.0, 1e6, _OTHER_UNIT)]
TimeConstant = Annotated[
    float,
    Within(
        1e-5,
        1e4,
        "the sample time of the RMCU is 0.1 ms or more, and an axle settles fast; give it in seconds",
    ),
]
Alpha = Annotated[
    float, Within(1.9e-3, 1.0, "(6) gives 0.0019 for 85 degrees of lead, the most that can be made")
]
Radius = Annotated[float, Within(1e-3, 100.0, "the range of wheels, m")]
SlipFloor = Annotated[float, Within(1e-3, 1e3, "a speed in m/s by which slip is divided")]
SlipLimit = Annotated[float, Within(0.0, 100.0, _OTHER_UNIT)]
Frequency = Annotated[float, Within(SLOWEST_HZ, 0.5 / SAMPLE_TIMES_S[0], "the range of the RMCU's notch")]
Width = Annotated[float, Within(1e-3, 1e3, "narrower or wider (8) is no notch")]
Depth = Annotated[float, Within(0.0, 10.0, "0 lets nothing pass, 1 is no notch, and above 1 it amplifies")]
Ratio = Annotated[float, Within(1e-3, 1e4, "the range of gears: motor speed / wheel speed")]
Inertia = Annotated[float, Within(1e-6, 1e6, "the range of wheels, kg m²")]
WheelTorque = Annotated[float, Within(0.0, 1e4, _OTHER_UNIT)]
Gradient = Annotated[float, Within(0.0, 1e7, _OTHER_UNIT)]
Slip = Annotated[float, Within(1e-3, 1.0, "a slip; 0.1 is usual")]
HalfGap = Annotated[float, Within(0.0, 1.0, "radians at the wheels")]
TwistSpeed = Annotated[float, Within(1e-2, 1e3, "radians per second at the wheels")]
Factor = Annotated[float, Within(0.0, 100.0, "a factor of a gain")]
Share = Annotated[float, Within(0.0, 1.0, "a share")]
Stiffness = Annotated[float, Within(1.0, 1e6, "N m/rad at the wheels; check the unit")]
Damping = Annotated[float, Within(0.0, 1e5, "N m s/rad at the wheels; check the unit")]
DeadTime = Annotated[
    float,
    Within(
        0.0,
        MOST_DEAD_TIME_SAMPLES * SAMPLE_TIMES_S[1],
        f"the RMCU waits for {MOST_DEAD_TIME_SAMPLES} samples at most; give it in seconds",
    ),
]
Speed = Annotated[float, Within(0.0, 200.0, "speeds of vehicles, m/s")]
#: Of a polynomial, where it is not 0.
COEFFICIENTS = (1e-60, 1e60)


def coefficients_checked(values: tuple[float, ...]) -> tuple[float, ...]:
    """Coefficients of a polynomial, in descending powers of s.

    Raises:
        ValueError: all of them are 0, or one is of no use to the RMCU.
    """
    least, most = COEFFICIENTS
    if not any(values):
        raise ValueError("all coefficients are 0: the output would never move")
    for value in values:
        if value and not least <= abs(value) <= most:
            raise ValueError(f"{value:g} is not valid: a coefficient is 0 or from {least:g} to {most:g}, "
                             "or the RMCU's filters overflow")  # fmt: skip
    return values


def denominator_checked(values: tuple[float, ...]) -> tuple[float, ...]:
    """The same of a denominator.

    Raises:
        ValueError: it begins with 0, or has coefficients that are none.
    """
    if values[0] == 0:
        raise ValueError(
            "it begins with 0: the first is that of the highest power of s, and divides all others"
        )
    return coefficients_checked(values)


def too_fast(places_hz: Mapping[str, float], sample_time_s: float) -> Iterable[tuple[str, str]]:
    """Keys of filters whose frequency the RMCU cannot reach, and what is wrong with each."""
    half_rate_hz = 0.5 / sample_time_s
    for key, place_hz in places_hz.items():
        if not place_hz < half_rate_hz:
            yield (
                key,
                (
                    f"{key} puts the filter at {place_hz:.4g} Hz: it lies below {half_rate_hz:g} Hz, "
                    "half the rate at which the RMCU samples"
                ),
            )
