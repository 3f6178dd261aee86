"""Parameter sets of driveline chains; the third is the physical reading of (14)-(16)."""

RIGID = {
    "motor_inertia": 0.05,
    "gear_ratio": 8.148,
    "vehicle_inertia": 303.0,
    "viscous_drag": 0.4,
    "torque_delay": 0.008,
}
TWO = {
    "motor_inertia": 0.05,
    "gear_ratio": 8.148,
    "shaft_stiffness": 6089.0,
    "shaft_damping": 19.75,
    "vehicle_inertia": 150.0,
    "torque_delay": 0.006,
}
THREE = {
    "motor_inertia": 0.02,
    "gear_ratio": 8.148,
    "shaft_stiffness": 6089.0,
    "shaft_damping": 19.75,
    "wheel_inertia": 4.355,
    "tyre_stiffness": 5717.0,
    "tyre_damping": 351.0,
    "vehicle_inertia": 303.0,
    "torque_delay": 0.008,
}
