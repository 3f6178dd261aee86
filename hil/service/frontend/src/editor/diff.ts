// Two texts line by line: what stays, what goes, what comes.

export interface DiffLine {
  kind: "same" | "gone" | "new" | "left out";
  text: string;
}

const AROUND = 3; // lines that are shown beside a change
const MOST = 4_000_000; // pairs of lines that are compared

// By the longest common subsequence of what differs between their common beginning and end.
export function diffOf(before: string, after: string): DiffLine[] {
  const one = before.split("\n"), other = after.split("\n");
  let start = 0, end = 0;
  while (start < one.length && start < other.length && one[start] === other[start]) start += 1;
  while (end < one.length - start && end < other.length - start && one.at(-1 - end) === other.at(-1 - end)) end += 1;
  const same = (text: string): DiffLine => ({ kind: "same", text });
  return folded([...one.slice(0, start).map(same), ...between(one.slice(start, one.length - end), other.slice(start, other.length - end)), ...one.slice(one.length - end).map(same)]);
}

function between(one: string[], other: string[]): DiffLine[] {
  const gone = (text: string): DiffLine => ({ kind: "gone", text }), come = (text: string): DiffLine => ({ kind: "new", text });
  if (one.length * other.length > MOST) return [...one.map(gone), ...other.map(come)];
  const width = other.length + 1, longest = new Uint32Array((one.length + 1) * width);
  for (let i = one.length - 1; i >= 0; i -= 1) {
    for (let j = other.length - 1; j >= 0; j -= 1) {
      longest[i * width + j] = one[i] === other[j] ? longest[(i + 1) * width + j + 1]! + 1 : Math.max(longest[(i + 1) * width + j]!, longest[i * width + j + 1]!);
    }
  }
  const found: DiffLine[] = [];
  let i = 0, j = 0;
  while (i < one.length || j < other.length) {
    if (i < one.length && j < other.length && one[i] === other[j]) { found.push({ kind: "same", text: one[i]! }); i += 1; j += 1; }
    else if (j >= other.length || (i < one.length && longest[(i + 1) * width + j]! >= longest[i * width + j + 1]!)) { found.push(gone(one[i]!)); i += 1; }
    else { found.push(come(other[j]!)); j += 1; }
  }
  return found;
}

// Long stretches without a change are one line that tells how long they are.
function folded(lines: DiffLine[]): DiffLine[] {
  const near = lines.map((_, at) => lines.slice(Math.max(0, at - AROUND), at + AROUND + 1).some((one) => one.kind !== "same"));
  const found: DiffLine[] = [];
  for (let at = 0; at < lines.length; at += 1) {
    if (near[at]) { found.push(lines[at]!); continue; }
    const from = at;
    while (at + 1 < lines.length && !near[at + 1]) at += 1;
    found.push({ kind: "left out", text: String(at + 1 - from) });
  }
  return found;
}
