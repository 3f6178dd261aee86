// The service's clock: a tablet's own may be minutes off, and what is left of a time-out counts by that of the bench.

let offsetMs = 0;

// From the header of any answer; to a second, which is what people see.
export function noteDate(date: string | null): void {
  const then = date === null ? NaN : Date.parse(date);
  if (Number.isFinite(then) && Math.abs(then - Date.now() - offsetMs) > 1500) offsetMs = then - Date.now();
}

export const serviceNowMs = (): number => Date.now() + offsetMs;
