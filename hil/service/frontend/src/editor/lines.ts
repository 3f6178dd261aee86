// Lines of a text.

// From where to where a line goes, counted from 1; the last one where there is none of that number.
export function lineAt(text: string, line: number): [number, number] {
  const lines = text.split("\n"), at = Math.min(Math.max(1, line), lines.length) - 1;
  const start = lines.slice(0, at).reduce((sum, one) => sum + one.length + 1, 0);
  return [start, start + (lines[at] ?? "").length];
}
