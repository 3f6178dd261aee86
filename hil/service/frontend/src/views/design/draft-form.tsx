// The numbers of a draft: each by a slider, or typed.

import type { JSX } from "preact";
import { BOUNDS, fieldsOf, type Draft, type Field, type Kind } from "./drafts.ts";

const NAMES: Record<Field, [JSX.Element, string]> = {
  lead_deg: [<>Lead P<sub>h</sub> in °</>, "Lead P h in °"],
  lead_hz: [<>at f<sub>ph</sub> in Hz</>, "at f ph in Hz"],
  notch_hz: [<>Notch f<sub>n</sub> in Hz</>, "Notch f n in Hz"],
  notch_width: [<>Width ζ</>, "Width ζ"],
  notch_depth: [<>Depth d</>, "Depth d"],
  pole_rad_s: [<>Pole p in rad/s</>, "Pole p in rad/s"],
};

interface Options {
  draft: Draft;
  resonance: number | null; // where a notch lies that nobody has moved
  onChange: (draft: Draft) => void;
}

export function DraftForm({ draft, resonance, onChange }: Options): JSX.Element {
  const set = (field: Field, text: string) => onChange({ ...draft, texts: { ...draft.texts, [field]: text } });
  return (
    <form class="draft" onSubmit={(event) => event.preventDefault()}>
      <label class="field">Stabilisation
        <select value={draft.kind} onChange={(event) => onChange({ ...draft, kind: event.currentTarget.value as Kind })}>
          <option value="phase">phase lead</option><option value="gain">notch</option>
        </select>
      </label>
      {fieldsOf(draft.kind).map((field) => {
        const { least, most, usual, slide: [from, to, step] } = BOUNDS[field], [name, spoken] = NAMES[field], text = draft.texts[field];
        const beside = text || (usual === "" && resonance ? String(resonance) : text);
        return (
          <div class="slide" key={field}>
            <label for={field}>{name}</label>
            <input type="range" min={from} max={to} step={step} value={beside} aria-label={`${spoken}, slider`} onInput={(event) => set(field, event.currentTarget.value)} />
            <input id={field} type="number" min={least} max={most} step="any" required={usual !== ""} value={text} placeholder={usual === "" && resonance ? resonance.toFixed(2) : ""} onInput={(event) => set(field, event.currentTarget.value)} />
          </div>
        );
      })}
    </form>
  );
}
