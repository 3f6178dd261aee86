// Rules of control charts that a trend broke, newest first.

import type { JSX } from "preact";
import type { Trend } from "../../api/types.ts";
import { English } from "../../i18n/english.tsx";
import { t, tn, tx } from "../../i18n/text.ts";

const SHOWN = 6;
const NELSON = /^nelson_(\d)$/;

export function Signals({ of }: { of: NonNullable<Trend["signals"]> }): JSX.Element | null {
  if (!of.length) return null;
  return (
    <>
      <ul class="signals">
        {[...of].reverse().slice(0, SHOWN).map((one) => (
          <li key={`${one.rule} ${one.runs[0]}`} class={one.present ? "" : "quiet"}>{tx("{pattern} (Nelson's rule {rule}): {runs}", { pattern: <English>{one.text}</English>, rule: NELSON.exec(one.rule)?.[1] ?? one.rule, runs: [stretchOf(one.runs), one.present ? t("still so") : ""].filter(Boolean).join(", ") })}</li>
        ))}
      </ul>
      {of.length > SHOWN ? <p class="quiet">{tn("And {count} earlier one.", "And {count} earlier ones.", of.length - SHOWN)}</p> : null}
    </>
  );
}

export const stretchOf = (runs: number[]): string => (runs.length > 1 ? t("runs {first} to {last}", { first: runs[0] ?? 0, last: runs.at(-1) ?? 0 }) : t("run {run}", { run: runs[0] ?? 0 }));
