// A plan as text: the name that it says, and places in it.

export const START = `name: my_plan
title: What it is for
steps:
  - set_controller: {file: phase_stabilization.toml}
  - hold_speed: {speed_km_h: 0, duration_s: 1}
  - step: {segment: tip_in, quantity: driving_torque, from_nm: 0, to_nm: 100, before_s: 0.5, after_s: 2}
finally:
  - ramp_down: {duration_s: 1}
criteria:
  - {segment: tip_in, metric: peak_shaft_torque, upper: 400, unit: N m}
`;

const NAME = /^name:[ \t]*["']?([A-Za-z0-9][A-Za-z0-9_.-]{0,63})["']?[ \t]*(?:#.*)?$/m;

// Null where it says none that the service would take.
export const nameIn = (text: string): string | null => NAME.exec(text)?.[1] ?? null;

// What stands where a plan's name belongs; '' where nothing does.
export const writtenName = (text: string): string => /^name:[ \t]*(.*?)[ \t]*(?:#.*)?$/m.exec(text)?.[1]?.replace(/^(["'])(.*)\1$/, "$2") ?? "";

// A copy of a plan that is built in has a name of its own.
export const renamed = (text: string, name: string): string => text.replace(NAME, `name: ${name}`);
