"""Metrics by name: one file a metric; other packages add theirs by entry point `hil.metrics`."""

from test_plans.metrics._metric import ChannelName, DidNotSettleError, Metric, NoValueError
from test_plans.metrics._periodogram import energy_within, periodogram
from test_plans.metrics._window import WindowMetric
from test_plans.metrics.band_energy import BandEnergy, BandEnergyMotorSpeed
from test_plans.metrics.overshoot import (
    Overshoot,
    OvershootPercent,
    OvershootPercentShaftTorque,
    OvershootShaftTorque,
)
from test_plans.metrics.peak import Peak, PeakShaftTorque
from test_plans.metrics.ride_comfort import RideComfort
from test_plans.metrics.settling_time import SettlingShaftTorque, SettlingTime
from test_plans.registry import Registry

_OWN: tuple[type[Metric], ...] = (
    PeakShaftTorque,
    OvershootShaftTorque,
    OvershootPercentShaftTorque,
    SettlingShaftTorque,
    BandEnergyMotorSpeed,
    RideComfort,
    Peak,
    Overshoot,
    OvershootPercent,
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
    "BandEnergy",
    "BandEnergyMotorSpeed",
    "ChannelName",
    "DidNotSettleError",
    "Metric",
    "NoValueError",
    "Overshoot",
    "OvershootPercent",
    "OvershootPercentShaftTorque",
    "OvershootShaftTorque",
    "Peak",
    "PeakShaftTorque",
    "RideComfort",
    "SettlingShaftTorque",
    "SettlingTime",
    "WindowMetric",
    "energy_within",
    "periodogram",
]
