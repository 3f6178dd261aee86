"""Numbers that the whole house shares by agreement."""

from __future__ import annotations

#: Time between samples of the bench, s: what the RMCU, the dynamometers' frames and recordings keep to.
TICK_S = 0.001
#: Where passengers feel vibration of the driveline, Hz: the band whose energy is judged.
COMFORT_BAND_HZ = (8.0, 20.0)
