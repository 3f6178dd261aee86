"""Metrics by name: one file a metric; other packages add theirs by entry point `hil.metrics`."""

from test_plans.metrics._low_pass import energy_within, hann, periodogram
from test_plans.metrics._metric import (
    ChannelName,
    DidNotSettleError,
    Limits,
    Metric,
    NotReachedError,
    NoValueError,
)
from test_plans.metrics._transient import transient_end_s
from test_plans.metrics._window import WindowMetric
from test_plans.metrics.band_energy import BandEnergy, BandEnergyMotorSpeed
from test_plans.metrics.jerk import Jerk
from test_plans.metrics.overshoot import (
    Overshoot,
    OvershootPercent,
    OvershootPercentShaftTorque,
    OvershootShaftTorque,
)
from test_plans.metrics.peak import Magnitude, Peak, PeakShaftTorque, Trough
from test_plans.metrics.play import Clunk, Contact, ContactEnergy, PlayCrossings, TimeInPlay, contacts
from test_plans.metrics.response_time import (
    Arrival,
    ArrivalShaftTorque,
    Delay,
    Holding,
    ResponseTime,
    ResponseTimeShaftTorque,
    TimeToTolerance,
)
from test_plans.metrics.ride_comfort import RideComfort, VibrationDose
from test_plans.metrics.settling_time import Ripple, SettlingShaftTorque, SettlingTime, SettlingToReference
from test_plans.metrics.stability import (
    StabilityOscillation,
    StabilityTorqueRequest,
    instability,
)
from test_plans.metrics.wheel_slip import WheelSlip
from test_plans.registry import Registry

_OWN: tuple[type[Metric], ...] = (
    PeakShaftTorque,
    OvershootShaftTorque,
    OvershootPercentShaftTorque,
    SettlingShaftTorque,
    BandEnergyMotorSpeed,
    ResponseTimeShaftTorque,
    ArrivalShaftTorque,
    StabilityTorqueRequest,
    RideComfort,
    VibrationDose,
    Jerk,
    TimeInPlay,
    PlayCrossings,
    Clunk,
    ContactEnergy,
    WheelSlip,
    Delay,
    SettlingToReference,
    Ripple,
    Peak,
    Trough,
    Magnitude,
    Overshoot,
    OvershootPercent,
    ResponseTime,
    Arrival,
    Holding,
    StabilityOscillation,
    SettlingTime,
    BandEnergy,
)

METRICS: Registry[Metric] = Registry(
    "metric",
    "hil.metrics",
    Metric,  # type: ignore[type-abstract]
    [(metric.name, metric) for metric in _OWN],
)

__all__ = [
    "METRICS",
    "Arrival",
    "ArrivalShaftTorque",
    "BandEnergy",
    "BandEnergyMotorSpeed",
    "ChannelName",
    "Clunk",
    "Contact",
    "ContactEnergy",
    "Delay",
    "DidNotSettleError",
    "Holding",
    "Jerk",
    "Limits",
    "Magnitude",
    "Metric",
    "NoValueError",
    "NotReachedError",
    "Overshoot",
    "OvershootPercent",
    "OvershootPercentShaftTorque",
    "OvershootShaftTorque",
    "Peak",
    "PeakShaftTorque",
    "PlayCrossings",
    "ResponseTime",
    "ResponseTimeShaftTorque",
    "RideComfort",
    "Ripple",
    "SettlingShaftTorque",
    "SettlingTime",
    "SettlingToReference",
    "StabilityOscillation",
    "StabilityTorqueRequest",
    "TimeInPlay",
    "TimeToTolerance",
    "Trough",
    "VibrationDose",
    "WheelSlip",
    "WindowMetric",
    "contacts",
    "energy_within",
    "hann",
    "instability",
    "periodogram",
    "transient_end_s",
]
