// Given recordings beside runs, as the address of a comparison has them: 3@12.5 is recording 3 with its step at 12.5 s.

export interface Beside {
  id: number;
  step: number; // on the recording's clock
}

export function recordingsFrom(text: string | null): Beside[] {
  const found = (text ?? "").split(",").map((one) => /^([1-9]\d{0,9})(?:@(-?\d+(?:\.\d+)?))?$/.exec(one)).filter((one) => one !== null);
  return found.map(([, id, step]) => ({ id: Number(id), step: Number(step ?? 0) }));
}

export const recordingsText = (chosen: readonly Beside[]): string => chosen.map(({ id, step }) => (step ? `${id}@${step}` : String(id))).join(",");
