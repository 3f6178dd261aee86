"""Metrics by name: one file a metric; other packages add theirs by entry point `hil.metrics`."""

from test_plans.metrics._metric import (
    ChannelName,
    DidNotSettleError,
    Limits,
    Metric,
    NotReachedError,
    NoValueError,
)
from test_plans.metrics._periodogram import energy_within, hann, periodogram
from test_plans.metrics._window import WindowMetric
from test_plans.metrics.band_energy import BandEnergy, BandEnergyMotorSpeed
from test_plans.metrics.overshoot import (
    Overshoot,
    OvershootPercent,
    OvershootPercentShaftTorque,
    OvershootShaftTorque,
)
from test_plans.metrics.peak import Magnitude, Peak, PeakShaftTorque, Trough
from test_plans.metrics.response_time import (
    Arrival,
    ArrivalShaftTorque,
    Holding,
    ResponseTime,
    ResponseTimeShaftTorque,
)
from test_plans.metrics.ride_comfort import RideComfort
from test_plans.metrics.settling_time import SettlingShaftTorque, SettlingTime
from test_plans.metrics.stability import (
    StabilityOscillation,
    StabilityTorqueRequest,
    instability,
)
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
    "DidNotSettleError",
    "Holding",
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
    "ResponseTime",
    "ResponseTimeShaftTorque",
    "RideComfort",
    "SettlingShaftTorque",
    "SettlingTime",
    "StabilityOscillation",
    "StabilityTorqueRequest",
    "Trough",
    "WindowMetric",
    "energy_within",
    "hann",
    "instability",
    "periodogram",
]
