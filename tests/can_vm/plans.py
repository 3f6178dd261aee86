"""The acceptance plan, shortened: one step with each controller."""

BOTH_CONTROLLERS = """
  - set_controller: {file: gain_stabilization.toml}
  - hold_speed: {speed_km_h: 0, duration_s: 0.2}
  - step: {segment: gain, quantity: driving_torque, from_nm: 0, to_nm: 326, before_s: 0.2, after_s: 1}
  - set_controller: {file: phase_stabilization.toml}
  - hold_speed: {speed_km_h: 0, duration_s: 0.2}
  - step: {segment: phase, quantity: driving_torque, from_nm: 0, to_nm: 326, before_s: 0.2, after_s: 1}
"""
CRITERIA = """
  - {segment: phase, metric: peak_shaft_torque, upper: 564, unit: N m}
  - {segment: phase, metric: peak_shaft_torque, below: gain}
"""
LONG_STEP = """
  - set_controller: {file: phase_stabilization.toml}
  - step: {segment: s, quantity: driving_torque, from_nm: 0, to_nm: 50, before_s: 0.1, after_s: 3}
"""
