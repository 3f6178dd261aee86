// Margins in every segment of a plan: of the controller that it loads there, and of the draft in its place.

import type { JSX } from "preact";
import type { Plan, SegmentsData } from "../../api/types.ts";
import { useData } from "../../data.ts";
import { figure, fixed, percent, significant } from "../../format.ts";
import { English } from "../../i18n/english.tsx";
import { t, tn } from "../../i18n/text.ts";
import { Badge, inWords, Scroll } from "../../ui/parts.tsx";
import { listed } from "../plans/plan-facts.ts";
import { useRested } from "./use-rested.ts";

type Row = SegmentsData["segments"][number];
type Loop = Row["own"];

interface Options {
  name: string;
  body: object | null; // of the draft, with its cars
  plan: string;
  onPlan: (plan: string) => void;
}

export function SegmentMargins({ name, body, plan, onPlan }: Options): JSX.Element {
  const plans = useData<Plan[]>("/plans").data ?? [];
  const { data, error, awaited } = useRested<SegmentsData>("/drafts/segments", body && plan ? { ...body, plan } : null);
  return (
    <>
      <label class="field">{t("Plan")}
        <select value={plan} onChange={(event) => onPlan(event.currentTarget.value)}>
          <option value="">{t("none")}</option>
          {plans.map((one) => <option key={one.name} value={one.name}>{listed(one)}</option>)}
        </select>
      </label>
      <div aria-live="polite">
        {awaited ? <p class="quiet">{t("Looking at the segments …")}</p> : null}
        {error ? <p class="bad"><English>{error.message}</English></p> : null}
      </div>
      {data ? <Table name={name} data={data} /> : null}
    </>
  );
}

function Table({ name, data: { segments, cars, notes } }: { name: string; data: SegmentsData }): JSX.Element {
  return (
    <>
      <Scroll label={t("Margins by segment")}>
        <table>
          <thead><tr><th scope="col">{t("segment")}</th><th scope="col" class="number">{t("speed")}</th><th scope="col">{t("road")}</th><th scope="col">{t("controller of the plan")}</th><th scope="col">{t("with {name}", { name })}</th></tr></thead>
          <tbody>{segments.map((row) => (
            <tr key={`${row.segment} ${row.sliding}`}>
              <th scope="row">{row.segment}</th><td class="number">{figure(row.speed_km_h, "km/h")}</td><td>{roadOf(row)}</td>
              <td>{inWords(row.controller)} <Margins of={row.own} /></td><td><Margins of={row.draft} /></td>
            </tr>
          ))}</tbody>
        </table>
      </Scroll>
      <p class="quiet">{tn("Gain and phase margin and 1/max |S| on the model; in brackets those of the worst of {count} car.", "Gain and phase margin and 1/max |S| on the model; in brackets those of the worst of {count} cars.", cars)}</p>
      {notes.map((note) => <p class="quiet" key={note}><English>{note}</English></p>)}
    </>
  );
}

function roadOf({ friction, sliding, mass_kg: mass }: Row): string {
  const road = friction === 1 ? t("dry") : sliding ? t("friction {friction}, tyres slide", { friction: significant(friction, 2) }) : t("friction {friction}, tyres grip", { friction: significant(friction, 2) });
  return mass === null ? road : `${road}, ${figure(mass, "kg")}`;
}

const modulus = (peak: number | null): string => (peak === null ? "–" : fixed(1 / peak, 2));

function Margins({ of: { margins, worst, stable_share: share } }: { of: Loop }): JSX.Element {
  return (
    <>
      {share < 1 ? <Badge kind="unstable" /> : null}
      <span class="reason">
        {`${figure(margins.gain_margin_db, "dB")} (${figure(worst.gain_margin_db)}), ${figure(margins.phase_margin_deg, "°")} (${figure(worst.phase_margin_deg)}), ${modulus(margins.sensitivity_peak)} (${modulus(worst.sensitivity_peak)})`}
        {share < 1 ? `, ${t("{share} stable", { share: percent(share) })}` : ""}
      </span>
    </>
  );
}
