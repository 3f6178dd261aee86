// The variables of a plan as fields: what each is, its unit, its bounds.

import type { JSX } from "preact";
import type { Plan } from "../../api/types.ts";
import { t } from "../../i18n/text.ts";

export type Texts = Record<string, string>; // as they are typed, by the names of variables

export const valuesOf = (plan: Plan | null | undefined, texts: Texts): Record<string, number> =>
  Object.fromEntries(Object.entries(plan?.variables ?? {}).map(([name, { default: usual }]) => [name, Number(texts[name] ?? usual)]));

export function VariableFields({ plan, texts, onChange }: { plan: Plan; texts: Texts; onChange: (texts: Texts) => void }): JSX.Element {
  return (
    <>
      {Object.entries(plan.variables).map(([name, variable]) => (
        <label class="field" key={`${plan.name} ${name}`}>{variable.unit ? t("{name} in {unit}", { name: variable.description || name, unit: variable.unit }) : variable.description || name}
          <input type="number" step="any" required name={name} value={texts[name] ?? String(variable.default)} min={variable.lower ?? undefined} max={variable.upper ?? undefined}
            onInput={(event) => onChange({ ...texts, [name]: event.currentTarget.value })} />
        </label>
      ))}
    </>
  );
}
