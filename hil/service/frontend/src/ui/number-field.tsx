// The one field that takes a number. The browser's own drops a decimal comma in some languages: 20,5 became 205.

import type { JSX } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import { POINTED, pointed, whyNoNumber, type Bounds } from "./typed-numbers.ts";

interface Options extends Bounds {
  value: string;
  onText: (text: string, typed: string) => void; // with a decimal point, '' where it is no number; and as it was typed
  rested?: boolean; // only when the field is left
  id?: string;
  name?: string;
  size?: number;
  placeholder?: string;
  describedBy?: string;
}

export function NumberInput({ value, onText, rested = false, describedBy, min, max, whole, required = false, ...more }: Options): JSX.Element {
  const [typed, setTyped] = useState<string | null>(null), given = useRef([value, value]); // what the parent was given last
  const text = typed ?? value, why = whyNoNumber(text, { min, max, whole: whole ?? false, required }, typed === null ? POINTED : undefined);
  const give = (now: string) => { const read = pointed(now) ?? ""; given.current = [read, now]; onText(read, now); };
  useEffect(() => { // a value that is not what was typed here: a slider's, or all was cleared
    if (given.current.some((one) => one === value || Number(one || NaN) === Number(value || NaN))) return;
    given.current = [value, value];
    setTyped(null);
  }, [value]);
  return (
    <>
      <input {...more} type="text" inputMode={whole ? "numeric" : "decimal"} autocomplete="off" required={required} value={text} aria-invalid={why !== ""} aria-describedby={describedBy} ref={(field) => field?.setCustomValidity(why)}
        onInput={(event) => { setTyped(event.currentTarget.value); if (!rested) give(event.currentTarget.value); }}
        onChange={(event) => { if (rested) give(event.currentTarget.value); }}
        onBlur={() => { if (typed !== null && pointed(typed) !== null) setTyped(null); }} />
      {why && (typed !== null || value !== "") ? <span class="bad small refused" role="alert">{why}</span> : null}
    </>
  );
}
