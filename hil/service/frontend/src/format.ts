// Numbers and moments as people of the page's language write them, and names of channels in it.

import { LOCALE } from "./i18n/language.ts";
import { t } from "./i18n/text.ts";

const formats = new Map<string, Intl.NumberFormat>();

function formatOf(options: Intl.NumberFormatOptions): Intl.NumberFormat {
  const key = JSON.stringify(options);
  const known = formats.get(key) ?? new Intl.NumberFormat(LOCALE, options);
  formats.set(key, known);
  return known;
}

// A measured value: three digits or so, as many as can be read at a glance.
export function figure(value: number | null | undefined, unit = ""): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  const text = size >= 1e6 || (size < 1e-3 && size > 0)
    ? formatOf({ notation: "scientific", maximumSignificantDigits: 3 }).format(value)
    : fixed(value, size >= 100 ? 0 : size >= 10 ? 1 : size >= 0.1 || size === 0 ? 2 : 4);
  return joined(text.replace("-", "−"), unit);
}

// Decimals that a person reads of a quantity while it changes, by its unit; more are noise of its sensor.
const DECIMALS: Record<string, number> = { "N m": 1, "rad/s": 1, "1/min": 0, rpm: 0, "km/h": 1, "m/s": 2, "m/s²": 2, rad: 4, "°C": 1, K: 1, V: 1, A: 1, W: 0, kW: 2, Hz: 1, s: 3, "%": 1 };

// A value that changes as it is read: decimals by its unit and not by its size, so that no figure changes its place.
export function reading(value: number | null | undefined, unit: string, shown = unit): string {
  const decimals = DECIMALS[unit];
  if (value === null || value === undefined || decimals === undefined || !(Math.abs(value) < 1e6)) return figure(value, shown);
  const none = Math.abs(value) < 0.5 * 10 ** -decimals; // no negative zero
  return joined(fixed(none ? 0 : value, decimals).replace("-", "−"), shown);
}

export const fixed = (value: number, digits: number): string =>
  formatOf({ minimumFractionDigits: digits, maximumFractionDigits: digits }).format(value);

// With so many digits, and no zeros behind them.
export function significant(value: number, digits: number): string {
  const size = Math.abs(value), text = size > 0 && (size < 1e-6 || size >= 1e21) ? { notation: "scientific" as const } : {};
  return formatOf({ ...text, maximumSignificantDigits: digits, useGrouping: false }).format(value).replace("-", "−");
}

// As many as tell neighbouring ticks apart: 2.5 has one, 0.25 two.
export function digitsOf(step: number): number {
  let digits = 0;
  while (digits < 6 && Math.abs(step - Number(step.toFixed(digits))) > 1e-6 * step) digits += 1;
  return digits;
}

// A value that a person set: as it was typed.
export const exact = (value: number): string => formatOf({ maximumSignificantDigits: 12, useGrouping: false }).format(value).replace("-", "−");

export const percent = (share: number, digits = 0): string =>
  formatOf({ style: "percent", minimumFractionDigits: digits, maximumFractionDigits: digits }).format(share).replace("-", "−");

export const whole = (value: number): string => formatOf({ maximumFractionDigits: 0 }).format(value);

// A unit of several words stays on the line of its value.
export const joined = (text: string, unit: string): string => (unit && unit !== "1" ? `${text} ${unit}`.replaceAll(" ", "\u00a0") : text);

const DECIMAL = formatOf({}).formatToParts(0.5).find((part) => part.type === "decimal")?.value ?? ".";

// Figures in a text of the service, which has a point in them, as the reader's language writes them.
export const figuresIn = (text: string, mark = DECIMAL): string =>
  text.replace(/(?<![\w.:/-])([-−]?)(\d+)\.(\d+(?:e[-+]?\d+)?)(?![\w:/-]|\.\d)/g, (_, sign: string, before: string, part: string) => `${sign && "−"}${before}${mark}${part}`);

// As disks and files are given: 1 MB is a million.
export function bytes(count: number): string {
  const [unit, size] = count >= 1e9 ? ["GB", 1e9] : count >= 1e6 ? ["MB", 1e6] : count >= 1e3 ? ["kB", 1e3] : ["B", 1] as const;
  return joined(fixed(count / size, size === 1 || count / size >= 100 ? 0 : 1), unit);
}

export function duration(seconds: number): string {
  if (seconds < 60) return joined(fixed(seconds, seconds < 10 ? 1 : 0), "s");
  const minutes = Math.floor(seconds / 60);
  if (minutes < 60) return t("{minutes} min {seconds} s", { minutes, seconds: Math.floor(seconds - 60 * minutes) });
  return t("{hours} h {minutes} min", { hours: Math.floor(minutes / 60), minutes: minutes % 60 });
}

// As a guess is given: to the second.
export const roughly = (seconds: number): string => (seconds < 60 ? joined(whole(seconds), "s") : duration(seconds));

const moments = new Intl.DateTimeFormat(LOCALE, { dateStyle: "medium", timeStyle: "short" });

const times = new Intl.DateTimeFormat(LOCALE, { timeStyle: "medium" });

export const clockTime = (ms: number): string => times.format(new Date(ms));

export const moment = (iso: string): string => moments.format(new Date(iso));

const exactMoments = new Intl.DateTimeFormat(LOCALE, { dateStyle: "medium", timeStyle: "medium" });

// To the second: of what happened, where the order of things matters.
export const exactMoment = (iso: string): string => exactMoments.format(new Date(iso));

const hours = new Intl.DateTimeFormat(LOCALE, { timeStyle: "short" });

// A moment that is near: of today, the time alone.
export const nearMoment = (iso: string, now = new Date()): string =>
  (new Date(iso).toDateString() === now.toDateString() ? hours : moments).format(new Date(iso));

const days = new Intl.DateTimeFormat(LOCALE, { dateStyle: "medium", timeZone: "UTC" });

// A day without a time, as it is in every zone.
export const dayText = (day: string): string => days.format(new Date(`${day}T12:00:00Z`));

const UNITS: Record<string, string> = { nm: "N m", rad_s: "rad/s", m_s: "m/s", s: "s", rad: "rad", degc: "°C", v: "V", a: "A", w: "W", hz: "Hz" };

const CHANNELS: Record<string, string> = {
  motor_speed: t("motor speed"), wheel_speed: t("wheel speed"), wheel_speed_left: t("wheel speed left"), wheel_speed_right: t("wheel speed right"), vehicle_speed: t("vehicle speed"),
  motor_torque: t("motor torque"), motor_torque_ref: t("motor torque ref"), shaft_torque: t("shaft torque"), shaft_torque_left: t("shaft torque left"), shaft_torque_right: t("shaft torque right"),
  driving_torque_ref: t("driving torque ref"), driving_torque_est: t("driving torque est"), dyno_torque_ref: t("dyno torque ref"), dyno_torque_left: t("dyno torque left"), dyno_torque_right: t("dyno torque right"),
};

const endingOf = (name: string): string | undefined =>
  Object.keys(UNITS).filter((one) => name.endsWith(`_${one}`)).sort((one, other) => other.length - one.length)[0];

// The unit that a name ends with; "" if it ends with none.
export const unitIn = (name: string): string => UNITS[endingOf(name) ?? ""] ?? "";

// A channel's name without its unit, in words.
export function wordsOf(channel: string): string {
  const ending = endingOf(channel);
  const bare = ending ? channel.slice(0, -ending.length - 1) : channel;
  return CHANNELS[bare] ?? bare.replaceAll("_", " ");
}

export const limitText = (upper: number | null | undefined, lower: number | null | undefined, unit = ""): string =>
  [lower === null || lower === undefined ? "" : `≥\u00a0${figure(lower, unit)}`, upper === null || upper === undefined ? "" : `≤\u00a0${figure(upper, unit)}`]
    .filter(Boolean).join(", ") || "–";
