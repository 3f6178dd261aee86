// Margins and peaks of drafts side by side.

import type { JSX } from "preact";
import type { DraftData } from "../../api/types.ts";
import { figure, fixed } from "../../format.ts";
import { English } from "../../i18n/english.tsx";
import { t } from "../../i18n/text.ts";
import { Badge, Scroll } from "../../ui/parts.tsx";
import type { NamedDraft } from "./draft-plots.tsx";

interface Row {
  name: string;
  of: (data: DraftData) => [string, string]; // a figure, and where it is
}

const at = (hz: number | null): string => (hz === null ? "" : t("at {frequency}", { frequency: figure(hz, "Hz") }));
const figureOf = (value: number | null, unit: string): string => (value === null ? t("none") : figure(value, unit));

const ROWS: Row[] = [
  { name: t("gain margin"), of: ({ margins }) => [figureOf(margins.gain_margin_db, "dB"), at(margins.gain_margin_hz)] },
  { name: t("phase margin"), of: ({ margins }) => [figureOf(margins.phase_margin_deg, "°"), at(margins.phase_margin_hz)] },
  { name: t("delay margin"), of: ({ margins }) => [figureOf(margins.delay_margin_s === null ? null : 1000 * margins.delay_margin_s, "ms"), ""] },
  { name: t("largest |S|"), of: ({ margins }) => [margins.sensitivity_peak === null ? t("none") : fixed(margins.sensitivity_peak, 3), at(margins.sensitivity_peak_hz)] },
  { name: t("largest |S| in 8 to 20 Hz"), of: ({ margins }) => [margins.comfort_peak === null ? t("none") : fixed(margins.comfort_peak, 3), ""] },
  ...[0, 1].map((index): Row => ({
    name: t("peak of T_s at {speed} km/h", { speed: index ? 20 : 0 }),
    of: ({ steps }) => [figureOf(steps[index]?.peak_shaft_torque_nm ?? null, "N m"), steps[index] ? t("overshoot {torque}", { torque: figure(steps[index].overshoot_shaft_torque_nm, "N m") }) : ""],
  })),
];

export function DraftFigures({ drafts }: { drafts: NamedDraft[] }): JSX.Element {
  const notes = [...new Set(drafts.flatMap(({ drawn: { found } }) => (found ? [...found.notes, found.steps_why_not] : [])))].filter(Boolean);
  return (
    <>
      <Scroll label={t("Margins and peaks")}>
        <table>
          <thead><tr><th scope="col">{t("figure")}</th>{drafts.map(({ name, role }) => <th scope="col" class="number" key={name}><span class={`swatch ${role}`} />{` ${name}`}</th>)}</tr></thead>
          <tbody>
            <tr><th scope="row">{t("loop")}</th>{drafts.map(({ name, drawn: { found } }) => <td class="number" key={name}>{found ? <Badge kind={found.unstable || !found.margins.stable ? "unstable" : "stable"} /> : "–"}</td>)}</tr>
            {ROWS.map((row) => (
              <tr key={row.name}><th scope="row">{row.name}</th>
                {drafts.map(({ name, drawn: { found } }) => { const [value, where] = found ? row.of(found) : ["–", ""]; return <td class="number" key={name}>{value}<span class="reason">{where}</span></td>; })}
              </tr>
            ))}
          </tbody>
        </table>
      </Scroll>
      <div aria-live="polite">
        {drafts.map(({ name, drawn: { found, error } }) => (error || found?.unstable ? <p class="bad" key={name}>{`${name}: `}<English>{error ? error.message : found?.unstable}</English></p> : null))}
      </div>
      {notes.map((note) => <p class="quiet" key={note}><English>{note}</English></p>)}
    </>
  );
}
