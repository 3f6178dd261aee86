// How cars differ, as it stands in the address of the design studio and as the service is asked.

export const SPREADS = [
  { name: "vehicle_inertia", most: 90, per: 0.01 }, { name: "tyre_stiffness", most: 90, per: 0.01 }, { name: "tyre_damping", most: 90, per: 0.01 },
  { name: "shaft_stiffness", most: 90, per: 0.01 }, { name: "dead_time_s", most: 20, per: 0.001 },
] as const;
export type SpreadName = (typeof SPREADS)[number]["name"];
export type Spread = Partial<Record<SpreadName, number>>; // in %, dead time in ms

export const CARS = [0, 20, 40, 100, 200] as const;
export const USUAL_CARS = 40;

export function carsFrom(text: string | null): number {
  const count = Number(text ?? USUAL_CARS);
  return CARS.find((one) => one === count) ?? USUAL_CARS;
}

// "vehicle_inertia:10,dead_time_s:1"; null leaves it to the model's file.
export function spreadFrom(text: string | null): Spread | null {
  if (!text) return null;
  const found: Spread = {};
  for (const part of text.split(",")) {
    const [name, value = ""] = part.split(":"), known = SPREADS.find((one) => one.name === name), number = Number(value);
    if (known && value !== "" && number >= 0 && number <= known.most) found[known.name] = number;
  }
  return Object.keys(found).length ? found : null;
}

export const spreadText = (spread: Spread | null): string => (spread === null ? "" : SPREADS.filter(({ name }) => spread[name] !== undefined).map(({ name }) => `${name}:${spread[name]}`).join(","));

export const toleranceOf = (spread: Spread | null): Record<string, number> | null =>
  spread === null ? null : Object.fromEntries(SPREADS.filter(({ name }) => spread[name]).map(({ name, per }) => [name, Number(((spread[name] as number) * per).toPrecision(6))]));
