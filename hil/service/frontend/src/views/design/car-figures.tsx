// A draft on cars that are drawn around its model: what each figure comes to, and which car is worst.

import type { JSX } from "preact";
import type { CloudData } from "../../api/types.ts";
import { figure, fixed, percent } from "../../format.ts";
import { English } from "../../i18n/english.tsx";
import { t, tn, tx } from "../../i18n/text.ts";
import { NumberInput } from "../../ui/number-field.tsx";
import { Badge, inWords, Scroll } from "../../ui/parts.tsx";
import { CARS, SPREADS, type Spread } from "./car-spread.ts";
import type { Rested } from "./use-rested.ts";

type Car = CloudData["cars"][number];

interface Row {
  name: string;
  unit: string;
  more: boolean; // is better
  of: (car: Car) => number | null;
}

const ROWS: Row[] = [
  { name: t("gain margin"), unit: "dB", more: true, of: ({ margins }) => margins.gain_margin_db },
  { name: t("phase margin"), unit: "°", more: true, of: ({ margins }) => margins.phase_margin_deg },
  { name: t("delay margin"), unit: "ms", more: true, of: ({ margins }) => (margins.delay_margin_s === null ? null : 1000 * margins.delay_margin_s) },
  { name: t("modulus margin 1/max |S|"), unit: "", more: true, of: ({ margins }) => (margins.sensitivity_peak === null ? null : 1 / margins.sensitivity_peak) },
  { name: t("largest |S| in 8 to 20 Hz"), unit: "", more: false, of: ({ margins }) => margins.comfort_peak },
  ...[0, 20].map((speed, at): Row => ({ name: t("overshoot of T_s at {speed} km/h", { speed }), unit: "N m", more: false, of: (car) => car.overshoot_nm[at] ?? null })),
  { name: t("8 to 20 Hz energy of ω_m around the step"), unit: "(rad/s)²", more: false, of: (car) => car.band_energy },
];

const shown = (value: number | null, unit: string): string => (value === null ? "–" : unit ? figure(value, unit) : fixed(value, 3));

export function CarFigures({ name, role, cloud, cars }: { name: string; role: string; cloud: Rested<CloudData>; cars: number }): JSX.Element {
  const { data, error, awaited } = cloud;
  return (
    <>
      <p class="quiet" aria-live="polite">
        {cars === 0 ? t("No cars are drawn.") : awaited ? tn("Drawing {count} car …", "Drawing {count} cars …", cars) : data ? <English>{data.source}</English> : ""}
        {error ? <span class="bad"><English>{error.message}</English></span> : null}
      </p>
      {data ? <Figures name={name} role={role} data={data} /> : null}
    </>
  );
}

function Figures({ name, role, data: { cars, worst, steps_why_not: whyNot } }: { name: string; role: string; data: CloudData }): JSX.Element {
  const model = cars[0] as Car, worstCar = cars[worst] as Car, stable = cars.filter((one) => one.margins.stable).length;
  return (
    <>
      <Scroll label={t("Figures on drawn cars")}>
        <table>
          <thead><tr><th scope="col"><span class={`swatch ${role}`} />{` ${name}`}</th><th scope="col" class="number">{t("the model")}</th><th scope="col" class="number">{t("median")}</th><th scope="col" class="number">{t("worst of {cars}", { cars: cars.length - 1 })}</th><th scope="col" class="number">{t("car")}</th></tr></thead>
          <tbody>{ROWS.map((row) => <Line key={row.name} row={row} model={model} cars={cars} />)}</tbody>
        </table>
      </Scroll>
      <p><Badge kind={stable === cars.length ? "stable" : "unstable"} /> {t("{share} of the cars have a stable loop.", { share: percent(stable / cars.length) })}</p>
      <p>{tx("Car {number} is marked in the plots: max |S| {peak}; {numbers}.", { number: worst, peak: shown(worstCar.margins.sensitivity_peak, ""), numbers: <English>{numbersOf(worstCar) || t("the model itself")}</English> })}</p>
      {whyNot ? <p class="quiet"><English>{whyNot}</English></p> : null}
    </>
  );
}

const numbersOf = (car: Car): string => Object.entries(car.differs).map(([name, value]) => `${inWords(name)} ${figure(value)}`).join(", ");

function Line({ row, model, cars }: { row: Row; model: Car; cars: Car[] }): JSX.Element {
  const ranked = cars.flatMap((car, at) => { const value = row.of(car); return value === null ? [] : [{ value, at }]; }).sort((one, other) => one.value - other.value);
  const median = ranked[Math.floor(ranked.length / 2)], worst = row.more ? ranked[0] : ranked[ranked.length - 1];
  return (
    <tr><th scope="row">{row.name}</th><td class="number">{shown(row.of(model), row.unit)}</td><td class="number">{shown(median?.value ?? null, row.unit)}</td><td class="number">{shown(worst?.value ?? null, row.unit)}</td><td class="number">{worst?.at ?? "–"}</td></tr>
  );
}

const NAMES: Record<string, string> = {
  vehicle_inertia: t("vehicle inertia ± %"), tyre_stiffness: t("tyre stiffness ± %"), tyre_damping: t("tyre damping ± %"), shaft_stiffness: t("shaft stiffness ± %"), dead_time_s: t("dead time ± ms"),
};

export function ChooseCars({ cars, spread, onCars, onSpread }: { cars: number; spread: Spread | null; onCars: (cars: number) => void; onSpread: (spread: Spread | null) => void }): JSX.Element {
  const set = (name: keyof Spread, text: string) => {
    const next = { ...spread };
    if (text === "" || !Number.isFinite(Number(text))) delete next[name]; else next[name] = Number(text);
    onSpread(Object.keys(next).length ? next : null);
  };
  return (
    <>
      <label class="field">{t("Cars drawn around the model")}
        <select value={String(cars)} onChange={(event) => onCars(Number(event.currentTarget.value))}>{CARS.map((one) => <option key={one} value={one}>{one === 0 ? t("none") : one}</option>)}</select>
      </label>
      <details open={spread !== null}>
        <summary>{t("What differs from car to car")}</summary>
        <p class="quiet">{t("Empty: the tolerances of the model's file, else those of hil tune; standard errors of the model count in any case.")}</p>
        <div class="fields">
          {SPREADS.map(({ name, most }) => <label class="field" key={name}>{NAMES[name]}<NumberInput rested min={0} max={most} value={String(spread?.[name] ?? "")} onText={(text) => set(name, text)} /></label>)}
        </div>
      </details>
    </>
  );
}
