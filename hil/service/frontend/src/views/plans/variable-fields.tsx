// The variables of a plan as fields: what each is, its unit, its bounds.

import type { JSX } from "preact";
import type { Plan } from "../../api/types.ts";
import { NumberInput } from "../../ui/number-field.tsx";
import { boundsOf, labelOf, type Texts } from "./typed-values.ts";

export function VariableFields({ plan, texts, onChange }: { plan: Plan; texts: Texts; onChange: (texts: Texts) => void }): JSX.Element {
  return (
    <>
      {Object.entries(plan.variables).map(([name, variable]) => (
        <label class="field" key={`${plan.name} ${name}`}>{labelOf(name, variable)}
          <NumberInput {...boundsOf(variable)} name={name} value={texts[name] ?? String(variable.default)} onText={(_, typed) => onChange({ ...texts, [name]: typed })} />
        </label>
      ))}
    </>
  );
}
