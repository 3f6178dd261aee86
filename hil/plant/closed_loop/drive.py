"""What a rear dynamometer does with its shaft: free, holding a speed, giving a torque, or being a vehicle."""

from __future__ import annotations

from hil.core.runtime.compiled import compiled

FREE, SPEED, TORQUE, VEHICLE = range(4)

# Columns of a drive's row
MODE, TARGET_SPEED, RAMPED_SPEED, INTEGRATOR, TARGET_TORQUE, ACCELERATION = range(6)
COLUMNS = 6

# The speed loop of both drives together: critically damped at 3 Hz on the inertia of wheels and rotors.
_BANDWIDTH_RAD_S = 18.85
_LARGEST_TORQUE_NM = 2000.0


@compiled
def load(drive, wheel_speed, inertia, dt):  # type: ignore[no-untyped-def]
    """Braking torque of one side in N m (positive slows a positive speed); a vehicle is the plant's."""
    if drive[MODE] == SPEED:
        reach = drive[ACCELERATION] * dt
        missing = drive[TARGET_SPEED] - drive[RAMPED_SPEED]
        drive[RAMPED_SPEED] += min(max(missing, -reach), reach)
        error = wheel_speed - drive[RAMPED_SPEED]
        drive[INTEGRATOR] += 0.5 * inertia * _BANDWIDTH_RAD_S * _BANDWIDTH_RAD_S * error * dt
        torque = inertia * _BANDWIDTH_RAD_S * error + drive[INTEGRATOR]
        return min(max(torque, -_LARGEST_TORQUE_NM), _LARGEST_TORQUE_NM)
    if drive[MODE] == TORQUE:
        return drive[TARGET_TORQUE]
    return 0.0
