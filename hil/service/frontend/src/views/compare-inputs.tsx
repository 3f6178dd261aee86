// What runs were given differently: of the plan in sentences, the rest in a table.

import type { JSX } from "preact";
import type { Comparison } from "../api/types.ts";
import { figuresIn, joined } from "../format.ts";
import { English } from "../i18n/english.tsx";
import { t, tn } from "../i18n/text.ts";
import { kindInWords } from "../ui/kinds.ts";
import { Scroll, Section } from "../ui/parts.tsx";
import { changeOf, keyOf, tabledOf, type Change, type Difference } from "./compare-changes.ts";

const NOTHING = "–";
const valueOf = (text: string, unit = ""): string => (text === NOTHING ? text : joined(text, unit));

export function Lead({ pair }: { pair: Comparison }): JSX.Element {
  const { first, other, criteria, notes } = pair, changes = criteria.map(changeOf).filter((one) => one !== null);
  const count = (kind: Change["kind"]): number => changes.filter((one) => one.kind === kind).length;
  return (
    <>
      <p>{changes.length === 0 ? t("No criterion has a value in both runs {first} and {other}.", { first: first.id, other: other.id })
        : t("Criteria of run {other} against run {first}: {better} better, {worse} worse, {same} the same, {open} without a direction.", { other: other.id, first: first.id, better: count("better"), worse: count("worse"), same: count("same"), open: count("open") })}</p>
      <PlanDiffers pair={pair} />
      {notes.map((note) => <p class="quiet" key={note}><English>{note}</English></p>)}
    </>
  );
}

// A run's value of a variable stands in its plan as the default.
const nameOf = (key: string): string => /^variables\.(\w+)\.default$/.exec(key)?.[1] ?? key;

// What is done otherwise, in a sentence for each value; what is said here is not in the table below.
function PlanDiffers({ pair }: { pair: Comparison }): JSX.Element | null {
  const { other, plan_summary: ones, plan_more: left } = pair;
  if (!ones.length) return null;
  const text = ({ name: of, first, other: its, unit }: Difference): string => {
    const name = nameOf(of);
    return first === NOTHING ? t("{what} is only in run {run}", { what: name, run: other.id }) : its === NOTHING ? t("{what} is not in run {run}", { what: name, run: other.id })
      : t("{what} {other} instead of {first}", { what: name, other: figuresIn(its), first: joined(figuresIn(first), unit ?? "") });
  };
  return (
    <>
      <p>{t("The plan of run {run} differs:", { run: other.id })}</p>
      <ul class="differs">
        {ones.map((one) => <li key={one.name}>{text(one)}</li>)}
        {left ? <li>{tn("{count} more difference, in the table", "{count} more differences, in the table", left)}</li> : null}
      </ul>
    </>
  );
}

export function Differences({ pairs }: { pairs: Comparison[] }): JSX.Element {
  const first = pairs[0]?.first.id ?? 0;
  const rows = new Map<string, { kind: string; name: string; first: string; others: Map<number, string> }>();
  const listed = new Set(pairs.flatMap((pair) => tabledOf(pair).map(keyOf))), isSaid = pairs.some((pair) => pair.plan_summary.length > 0);
  for (const pair of pairs) {
    for (const one of pair.differences) {
      const key = keyOf(one);
      if (!listed.has(key)) continue;
      const row = rows.get(key) ?? { kind: one.kind, name: one.name, first: valueOf(one.first, one.unit), others: new Map<number, string>() };
      row.others.set(pair.other.id, valueOf(one.other, one.unit));
      rows.set(key, row);
    }
  }
  return (
    <Section title={t("Different inputs")} label="inputs">
      {rows.size === 0 ? <p class="quiet">{isSaid ? t("Only the plan differs, as said above: controllers, model and bench are identical.") : t("Controllers, model, bench and plan values are identical.")}</p> : (
        <Scroll label={t("Different inputs")}>
          <table>
            <thead><tr><th scope="col">{t("kind")}</th><th scope="col">{t("value")}</th><th scope="col" class="number">{t("run {run}", { run: first })}</th>{pairs.map((pair) => <th key={pair.other.id} scope="col" class="number">{t("run {run}", { run: pair.other.id })}</th>)}</tr></thead>
            <tbody>{[...rows].map(([key, row]) => <tr key={key}><th scope="row">{kindInWords(row.kind)}</th><td>{row.name}</td><td class="number">{row.first}</td>{pairs.map((pair) => <td key={pair.other.id} class="number">{row.others.get(pair.other.id) ?? t("the same")}</td>)}</tr>)}</tbody>
          </table>
        </Scroll>
      )}
    </Section>
  );
}
