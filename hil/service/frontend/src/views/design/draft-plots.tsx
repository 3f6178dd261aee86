// What drafts come to, laid over each other: Nyquist curves, sensitivities, steps at both speeds.

import type { JSX } from "preact";
import { useMemo } from "preact/hooks";
import type { CloudData, DraftData } from "../../api/types.ts";
import { figure } from "../../format.ts";
import { t, tx } from "../../i18n/text.ts";
import { CurvePlot, type Curve } from "../../plot/curve-plot.tsx";
import { LARGEST_SENSITIVITY, NyquistPlot, type Cloud } from "../../plot/nyquist-plot.tsx";
import type { Drawn } from "./use-drafts.ts";

export interface NamedDraft {
  name: string;
  role: string;
  drawn: Drawn;
}

interface Found {
  name: string;
  role: string;
  data: DraftData;
}

const BAND_HZ = [8, 20] as const;
const HIGHEST_SHOWN = 6; // of |S|: an unstable loop would hide all others

// Cars around the draft of this role.
export interface Around {
  role: string;
  data: CloudData;
}

export function DraftPlots({ drafts, around }: { drafts: NamedDraft[]; around: Around | null }): JSX.Element {
  const key = drafts.map(({ drawn }) => drawn.found);
  const found = useMemo(() => drafts.flatMap(({ name, role, drawn }) => (drawn.found ? [{ name, role, data: drawn.found }] : [])), [...key, ...Array<null>(4 - key.length).fill(null), drafts.map(({ name }) => name).join()]);
  const loops = useMemo(() => found.flatMap(loopsOf), [found]);
  const cars = around?.data ?? null, role = around?.role ?? "";
  const sensitivities = useMemo(() => [...(cars ? carsSensitivities(role, cars) : []), ...found.flatMap(sensitivitiesOf)], [found, cars, role]);
  const cloud = useMemo((): Cloud | null => (cars ? { role, cars: cars.loops, worst: cars.worst } : null), [cars, role]);
  if (!found.length && drafts.every(({ drawn }) => drawn.error)) return <></>; // the table below says why
  if (!found.length) return <p class="quiet">{t("Reading the model …")}</p>;
  const worst = found.map(({ data }) => data.margins.sensitivity_peak ?? 0), all = [...worst, cars?.cars[cars.worst]?.margins.sensitivity_peak ?? 0];
  const margins = found.map(({ name, data }) => t("{name}: gain margin {gain}, phase margin {phase}", { name, gain: figure(data.margins.gain_margin_db, "dB"), phase: figure(data.margins.phase_margin_deg, "°") })).join("; ");
  return (
    <div class="plots">
      <NyquistPlot loops={loops} cloud={cloud} label={t("Nyquist curve of the open loop. {margins}", { margins })} />
      <CurvePlot
        title={t("Sensitivity |S|")} label={t("Sensitivity over frequency: at most {values}", { values: worst.map((one) => figure(one)).join(", ") })} curves={sensitivities}
        x={{ unit: "Hz", log: true }} y={{ unit: "", low: 0, high: Math.min(HIGHEST_SHOWN, Math.max(1.2 * LARGEST_SENSITIVITY, 1.05 * Math.max(...all))) }} band={BAND_HZ} limits={[LARGEST_SENSITIVITY]}
      />
      {[0, 1].map((at) => <StepPlot key={at} found={found} at={at} />)}
    </div>
  );
}

const WITHOUT = { name: t("PI alone"), role: "reference" };

// The loop without a stabilisation is the same of all that have its pole: it is drawn once.
function loopsOf({ name, role, data }: Found, at: number) {
  const [pi, chosen] = data.loops;
  return [...(pi && at === 0 ? [{ ...WITHOUT, real: pi.real, imaginary: pi.imaginary }] : []), ...(chosen ? [{ name, role, real: chosen.real, imaginary: chosen.imaginary }] : [])];
}

function sensitivitiesOf({ name, role, data }: Found, at: number): Curve[] {
  const [pi, chosen] = data.loops, x = data.frequency_hz;
  return [...(pi && at === 0 ? [{ ...WITHOUT, x, y: pi.sensitivity }] : []), ...(chosen ? [{ name, role, x, y: chosen.sensitivity }] : [])];
}

// What all cars span, and the worst of them.
function carsSensitivities(role: string, { frequency_hz: x, sensitivity_lower: lower, sensitivity_upper: upper, worst_sensitivity: worst }: CloudData): Curve[] {
  return [
    { name: t("all cars"), role, x, y: x.map(() => null), reach: { lower, upper } },
    { name: t("worst car"), role: "measured", looks: "dashes", x, y: worst },
  ];
}

function StepPlot({ found, at }: { found: Found[]; at: number }): JSX.Element | null {
  const curves = useMemo(() => curvesOf(found, at), [found, at]);
  const steps = found.flatMap(({ data }) => data.steps[at] ?? []), speed = steps[0]?.speed_km_h;
  if (speed === undefined) return null;
  const peaks = steps.map((one) => figure(one.peak_shaft_torque_nm)).join(", "), asked = found[0]?.data.step_nm ?? 0;
  return (
    <CurvePlot
      title={<>{tx("T<sub>s</sub> after a step at {speed} km/h", { sub: (text) => <sub>{text}</sub>, speed })}</>} label={t("Shaft torque at {speed} km/h after a step of {asked} N m: peak {peaks} N m", { speed, asked, peaks })} says={t("peak {peaks} N m", { peaks })}
      curves={curves} x={{ unit: "s" }} y={{ unit: "N m" }}
    />
  );
}

function curvesOf(found: Found[], at: number): Curve[] {
  const first = found[0]?.data;
  if (!first) return [];
  const asked: Curve = { name: t("requested torque"), role: "reference", looks: "dashes", x: first.time_s, y: first.time_s.map((time) => (time < 0 ? 0 : first.step_nm)) };
  return [asked, ...found.flatMap(({ name, role, data }) => { const step = data.steps[at]; return step ? [{ name, role, x: data.time_s, y: step.shaft_torque_nm }] : []; })];
}
