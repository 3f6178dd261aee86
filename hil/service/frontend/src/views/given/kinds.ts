// Kinds of files in TOML that people give: where they are, and how a new one begins.

import { to } from "../../addresses.ts";
import { t } from "../../i18n/text.ts";

export type GivenKind = "model" | "controller" | "bench";

interface Kind {
  path: string; // of the API
  list: "models" | "controllers" | "bench-files";
  address: (name: string) => string;
  write: string; // what writing a new one is called
  edit: string;
  label: string; // of its text
  start: string; // a template with comments
}

const MODEL = `# What this is a model of.
kind = "three_inertia"

[parameters]
motor_inertia = 0.02        # kg m2
gear_ratio = 8.148          # motor speed / wheel speed
shaft_stiffness = 6089.0    # N m/rad
shaft_damping = 19.75       # N m s/rad
wheel_inertia = 4.355       # kg m2, wheels and dyno rotors
tyre_stiffness = 5717.0     # N m/rad
tyre_damping = 351.0        # N m s/rad
vehicle_inertia = 303.0     # kg m2
torque_delay = 0.008        # s
`;

const CONTROLLER = `# What this controller is for. What follows # is a comment.
name = "my_controller"
sample_time_s = 0.001
torque_limit_nm = 150.0            # of the request, at the motor

[dfc]                              # driving force control: outer loop
integral_gain = 0.001              # K_i(DFC)
feedforward_time_constant_s = 0.05 # tau_2
wheel_radius_m = 0.33
slip_floor_m_s = 1.0               # slip below this speed counts as at it

[wsc]                              # wheel speed control: inner loop
proportional_gain = 2.6775         # K_p
integral_gain = 0.4016             # K_i
filter_time_constant_s = 0.05      # tau_1

[wsc.lead]                         # phase stabilization
alpha = 0.25962                    # smaller: more lead
time_constant_s = 0.0078087
normalisation = "high_frequency"

[dfo]                              # driving force observer
time_constant_s = 0.007961783      # tau_DFO
gear_ratio = 8.148                 # motor speed / wheel speed
wheel_inertia_kg_m2 = 4.355        # wheels and dyno rotors

[plant]                            # transfer functions, without dead time
denominator = [1.0, 71.59, 6376.0, 2.399e5, 3.867e6, 0.0]
motor_speed = [46.35, 2604.0, 8.768e4, 5.302e4, 8.547e5]
wheel_speed = [45.99, 5664.0, 6839.0, 1.049e5]
shaft_torque = [212.7, 5.23e4, 1.947e6, 3.14e7, 0.0]
`;

const BENCH = `name = "my_bench"
title = "What this bench is"

[buses.rmcu]
interface = "hil-sim"
channel = "my_bench/rmcu"
bit_rate = 1000000

[buses.dyno]
interface = "hil-sim"
channel = "my_bench/dyno"
bit_rate = 1000000

[rmcu]
bus = "rmcu"
dbc = "rmcu.dbc"

[dyno]
bus = "dyno"
eds = "rcs_dyno.eds"
rear_left = 3
rear_right = 4

[limits]
motor_torque_nm = 150.0
driving_torque_nm = 600.0
shaft_torque_nm = 1200.0
motor_speed_rad_s = 700.0
wheel_speed_rad_s = 85.0
vehicle_speed_m_s = 28.0

[simulation]
model = "three_inertia.toml"
`;

// Texts are looked up when they are shown: in the language of then.
export const kindOf = (kind: GivenKind): Kind => ({
  model: { path: "/models", list: "models", address: to.model, write: t("Write a model"), edit: t("Make a new version of the model"), label: t("Text of the model"), start: MODEL },
  controller: { path: "/controllers", list: "controllers", address: to.controller, write: t("Write a controller"), edit: t("Make a new version of the controller"), label: t("Text of the controller"), start: CONTROLLER },
  bench: { path: "/bench-files", list: "bench-files", address: to.benchFile, write: t("Write a bench file"), edit: t("Make a new version of the bench file"), label: t("Text of the bench file"), start: BENCH },
} as const)[kind];

// What a name stands for stays: axle, axle_2, axle_3.
export function nextName(name: string, taken: string[]): string {
  const [, stem = name, count] = /^(.*?)(?:_(\d+))?$/.exec(name) ?? [];
  for (let next = Number(count ?? 1) + 1; ; next += 1) {
    const found = `${stem.slice(0, 58)}_${next}`;
    if (!taken.includes(found)) return found;
  }
}
