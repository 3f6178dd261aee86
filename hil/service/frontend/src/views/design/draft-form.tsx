// The numbers of a draft: each by a slider, or typed.

import type { ComponentChildren, JSX } from "preact";
import { t, tx } from "../../i18n/text.ts";
import { NumberInput } from "../../ui/number-field.tsx";
import { BOUNDS, fieldsOf, type Draft, type Field, type Kind } from "./drafts.ts";

const sub = (words: ComponentChildren): JSX.Element => <sub>{words}</sub>;
// As shown, and as it is read out.
const NAMES: Record<Field, [ComponentChildren, string]> = {
  lead_deg: [tx("Lead P<sub>h</sub> in °", { sub }), t("Lead P h in °")],
  lead_hz: [tx("at f<sub>ph</sub> in Hz", { sub }), t("at f ph in Hz")],
  notch_hz: [tx("Notch f<sub>n</sub> in Hz", { sub }), t("Notch f n in Hz")],
  notch_width: [t("Width ζ"), t("Width ζ")],
  notch_depth: [t("Depth d"), t("Depth d")],
  pole_rad_s: [t("Pole p in rad/s"), t("Pole p in rad/s")],
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
      <label class="field">{t("Stabilisation")}
        <select value={draft.kind} onChange={(event) => onChange({ ...draft, kind: event.currentTarget.value as Kind })}>
          <option value="phase">{t("phase lead")}</option><option value="gain">{t("notch")}</option>
        </select>
      </label>
      {fieldsOf(draft.kind).map((field) => {
        const { least, most, usual, slide: [from, to, step] } = BOUNDS[field], [name, spoken] = NAMES[field], text = draft.texts[field];
        const beside = text || (usual === "" && resonance ? String(resonance) : text);
        return (
          <div class="slide" key={field}>
            <label for={field}>{name}</label>
            <input type="range" min={from} max={to} step={step} value={beside} aria-label={t("{name}, slider", { name: spoken })} onInput={(event) => set(field, event.currentTarget.value)} />
            <NumberInput id={field} min={least} max={most} required={usual !== ""} value={text} placeholder={usual === "" && resonance ? resonance.toFixed(2) : ""} onText={(typed) => set(field, typed)} />
          </div>
        );
      })}
    </form>
  );
}
