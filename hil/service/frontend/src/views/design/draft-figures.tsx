// Margins and peaks of drafts side by side.

import type { JSX } from "preact";
import type { DraftData } from "../../api/types.ts";
import { figure } from "../../format.ts";
import { Badge, Scroll } from "../../ui/parts.tsx";
import type { NamedDraft } from "./draft-plots.tsx";

interface Row {
  name: string;
  of: (data: DraftData) => [string, string]; // a figure, and where it is
}

const at = (hz: number | null): string => (hz === null ? "" : `at ${figure(hz, "Hz")}`);
const figureOf = (value: number | null, unit: string): string => (value === null ? "none" : figure(value, unit));

const ROWS: Row[] = [
  { name: "gain margin", of: ({ margins }) => [figureOf(margins.gain_margin_db, "dB"), at(margins.gain_margin_hz)] },
  { name: "phase margin", of: ({ margins }) => [figureOf(margins.phase_margin_deg, "°"), at(margins.phase_margin_hz)] },
  { name: "delay margin", of: ({ margins }) => [figureOf(margins.delay_margin_s === null ? null : 1000 * margins.delay_margin_s, "ms"), ""] },
  { name: "largest |S|", of: ({ margins }) => [margins.sensitivity_peak === null ? "none" : margins.sensitivity_peak.toFixed(3), at(margins.sensitivity_peak_hz)] },
  { name: "largest |S| in 8 to 20 Hz", of: ({ margins }) => [margins.comfort_peak === null ? "none" : margins.comfort_peak.toFixed(3), ""] },
  ...[0, 1].map((index): Row => ({
    name: `peak of T_s at ${index ? 20 : 0} km/h`,
    of: ({ steps }) => [figureOf(steps[index]?.peak_shaft_torque_nm ?? null, "N m"), steps[index] ? `overshoot ${figure(steps[index].overshoot_shaft_torque_nm, "N m")}` : ""],
  })),
];

export function DraftFigures({ drafts }: { drafts: NamedDraft[] }): JSX.Element {
  const notes = [...new Set(drafts.flatMap(({ drawn: { found } }) => (found ? [...found.notes, found.steps_why_not] : [])))].filter(Boolean);
  return (
    <>
      <Scroll label="Margins and peaks">
        <table>
          <thead><tr><th scope="col">figure</th>{drafts.map(({ name, role }) => <th scope="col" class="number" key={name}><span class={`swatch ${role}`} />{` ${name}`}</th>)}</tr></thead>
          <tbody>
            <tr><th scope="row">loop</th>{drafts.map(({ name, drawn: { found } }) => <td class="number" key={name}>{found ? <Badge kind={found.unstable || !found.margins.stable ? "unstable" : "stable"} /> : "–"}</td>)}</tr>
            {ROWS.map((row) => (
              <tr key={row.name}><th scope="row">{row.name}</th>
                {drafts.map(({ name, drawn: { found } }) => { const [value, where] = found ? row.of(found) : ["–", ""]; return <td class="number" key={name}>{value}<span class="reason">{where}</span></td>; })}
              </tr>
            ))}
          </tbody>
        </table>
      </Scroll>
      <div aria-live="polite">
        {drafts.map(({ name, drawn: { found, error } }) => (error || found?.unstable ? <p class="bad" key={name}>{`${name}: ${error ? error.message : found?.unstable}`}</p> : null))}
      </div>
      {notes.map((note) => <p class="quiet" key={note}>{note}</p>)}
    </>
  );
}
