"""Numbers that the whole house shares by agreement."""

from __future__ import annotations

import signal

#: Time between samples of the bench, s: what the RMCU, the dynamometers' frames and recordings keep to.
TICK_S = 0.001
#: Where passengers feel vibration of the driveline, Hz: the band whose energy is judged.
COMFORT_BAND_HZ = (8.0, 20.0)
#: What asks a command to end, all of them alike: Ctrl-C, a termination, a closed terminal, and the key that
#: would else leave a core. Windows has neither of the last two.
ENDING_SIGNALS = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT") if hasattr(signal, name)
)
#: Packages of this software, for logs and for versions.
PACKAGES = ("hil", "drivers", "sim_backend", "test_plans", "reports")
