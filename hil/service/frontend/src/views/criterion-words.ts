// A criterion in words: what is measured, in which segment, and within which limits.

import { figure, limitText } from "../format.ts";
import { t } from "../i18n/text.ts";

export interface Measured {
  id: string;
  title?: string;
  value: number | null;
  unit: string;
  upper?: number | null;
  lower?: number | null;
  below?: string;
  verdict: string;
  margin?: number | null;
  reason?: string;
  source?: string;
}

// By the names of metrics (docs/reference/metrics.md): their words, and what is computed.
const METRICS: Record<string, [string, string]> = {
  peak_shaft_torque: [t("Peak of the shaft torque"), t("the value farthest in the step's direction, from the step to the end of the segment")],
  overshoot_shaft_torque: [t("Overshoot of the shaft torque"), t("how far it goes beyond the reference in the step's direction")],
  overshoot_percent_shaft_torque: [t("Overshoot of the shaft torque, in percent"), t("how far it goes beyond the reference, in percent of the step's size")],
  settling_shaft_torque: [t("Settling time of the shaft torque"), t("time from the step until it stays near its mean at the end")],
  band_energy_motor_speed: [t("Band energy of the motor speed"), t("energy of the vibration between 8 and 20 Hz after the step")],
  response_time_shaft_torque: [t("Response time of the shaft torque"), t("time from the step until it first has most of the step's size")],
  arrival_shaft_torque: [t("Deviation of the shaft torque at the end"), t("mean at the end minus the value after the step, in percent of the step's size")],
  ride_comfort: [t("Weighted acceleration (ride comfort)"), t("weighted r.m.s. acceleration along the vehicle, ISO 2631-1")],
  vibration_dose: [t("Vibration dose value"), t("fourth-power vibration dose along the vehicle, ISO 2631-1")],
  jerk: [t("Largest jerk"), t("largest rate of change of the vehicle's acceleration, low-pass filtered")],
  time_in_play: [t("Time in the play"), t("time that the shaft torque takes from one flank to the other, summed")],
  play_crossings: [t("Passages through the play"), t("how often the shaft torque goes from one flank to the other")],
  clunk: [t("Clunk"), t("fastest change of the shaft torque shortly after a contact of the flanks")],
  contact_energy: [t("Energy of the hardest contact"), t("work into the shafts after a contact of the flanks")],
  wheel_slip: [t("Largest wheel slip"), t("largest difference of the wheel's and the vehicle's speed")],
  delay: [t("Delay of the response"), t("time from the step until the response begins")],
  settling_to_reference: [t("Settling time to the reference"), t("time from the step until it stays near the value that was asked for")],
  ripple: [t("Ripple at the end"), t("half the distance of the largest and the smallest value at the end")],
  peak: [t("Peak"), t("the value farthest in the step's direction, from the step to the end of the segment")],
  trough: [t("Trough"), t("the value farthest against the step's direction")],
  magnitude: [t("Largest magnitude"), t("the largest absolute value")],
  overshoot: [t("Overshoot"), t("how far it goes beyond the reference in the step's direction")],
  overshoot_percent: [t("Overshoot in percent"), t("how far it goes beyond the reference, in percent of the step's size")],
  settling_time: [t("Settling time"), t("time from the step until it stays near its mean at the end")],
  band_energy: [t("Band energy"), t("energy of the vibration within a band of frequencies")],
  response_time: [t("Response time"), t("time from the step until it first has most of the step's size")],
  arrival: [t("Steady-state deviation from the request"), t("mean at the end minus the value after the step, in percent of the step's size")],
  holding: [t("Largest deviation while holding"), t("largest distance from the value after the step in the second half of the window")],
  stability_oscillation: [t("Sustained oscillation"), t("amplitude of the strongest line that does not decay, without the wheel's declared orders")],
  stability_torque_request: [t("Torque request at its limit or reversed"), t("share of the time in which the request is at the torque limit or against what was asked for")],
};

export interface Named {
  metric: string; // '' where the id names none that is known
  segment: string;
  below: string; // the segment it is compared with
}

// Ids are SEGMENT.METRIC, or with .below.SEGMENT behind, unless an author gave another.
export function namedBy(id: string): Named {
  const [own = "", below = ""] = id.split(".below."), dot = own.lastIndexOf("."), metric = own.slice(dot + 1);
  return dot > 0 && metric in METRICS ? { metric, segment: own.slice(0, dot), below } : { metric: "", segment: dot > 0 ? own.slice(0, dot) : "", below };
}

// What is measured: the author's title, else the metric's words, else the id. Titles of device checks are the product's own.
export function wordsOfCriterion({ id, title, source }: Pick<Measured, "id" | "title" | "source">): string {
  const words = METRICS[namedBy(id).metric]?.[0] ?? "";
  return (title && !(source === "device" && words) ? title : words) || title || id;
}

export const METRIC_NAMES: readonly string[] = Object.keys(METRICS);
export const metricWords = (metric: string): string => METRICS[metric]?.[0] ?? metric;
export const meaningOf = (metric: string): string => METRICS[metric]?.[1] ?? "";

// The metrics of criteria, each once.
export const metricsOf = (criteria: readonly Measured[]): string[] => [...new Set(criteria.map((one) => namedBy(one.id).metric).filter(Boolean))];

export function allowed({ below, upper, lower, unit }: Measured): string {
  if (!below) return limitText(upper, lower, unit);
  return upper == null ? t("below {limit}", { limit: below }) : t("below {limit}: {value}", { limit: below, value: figure(upper, unit) });
}

export const isFailed = ({ verdict, upper, lower, below }: Measured): boolean =>
  verdict === "fail" || verdict === "undecided" || (verdict === "did_not_settle" && (upper != null || lower != null || !!below));

// Those of the plan before those of any device, as the table has them.
export const inOrder = <T extends Pick<Measured, "source">>(criteria: readonly T[]): T[] =>
  [...criteria.filter((one) => one.source !== "device"), ...criteria.filter((one) => one.source === "device")];

// In one sentence: what, where, the value and the limit.
export function failureOf(one: Measured): string {
  const { segment } = namedBy(one.id), what = wordsOfCriterion(one), limit = allowed(one);
  const value = one.value === null ? t("no value") : figure(one.value, one.unit);
  return segment ? t("{what} in {segment}: {value}, allowed is {limit}.", { what, segment, value, limit }) : t("{what}: {value}, allowed is {limit}.", { what, value, limit });
}
