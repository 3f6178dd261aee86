// Rules of control charts that a trend broke, newest first.

import type { JSX } from "preact";
import type { Trend } from "../../api/types.ts";

const SHOWN = 6;
const NELSON = /^nelson_(\d)$/;

export function Signals({ of }: { of: NonNullable<Trend["signals"]> }): JSX.Element | null {
  if (!of.length) return null;
  return (
    <>
      <ul class="signals">
        {[...of].reverse().slice(0, SHOWN).map((one) => (
          <li key={`${one.rule} ${one.runs[0]}`} class={one.present ? "" : "quiet"}>{`${one.text} (Nelson's rule ${NELSON.exec(one.rule)?.[1] ?? one.rule}): ${stretchOf(one.runs)}${one.present ? ", still so" : ""}`}</li>
        ))}
      </ul>
      {of.length > SHOWN ? <p class="quiet">{`And ${of.length - SHOWN} earlier ones.`}</p> : null}
    </>
  );
}

export const stretchOf = (runs: number[]): string => (runs.length > 1 ? `runs ${runs[0]} to ${runs.at(-1)}` : `run ${runs[0]}`);
