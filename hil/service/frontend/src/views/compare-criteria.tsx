// Criteria of runs side by side: their values, and how each differs from the first run.

import type { JSX } from "preact";
import type { Comparison } from "../api/types.ts";
import { figure, figuresIn, joined } from "../format.ts";
import { t } from "../i18n/text.ts";
import { Badge, Scroll, Section } from "../ui/parts.tsx";
import { changeOf, changeText } from "./compare-changes.ts";
import { CriterionName } from "./criteria.tsx";

type Row = Comparison["criteria"][number];
const keyOf = ({ id, unit }: Row): string => `${id} ${unit}`; // as the service matches them

export function ComparedCriteria({ pairs }: { pairs: Comparison[] }): JSX.Element {
  const rows = [...new Map(pairs.flatMap((pair) => pair.criteria).reverse().map((row) => [keyOf(row), row])).values()].reverse(), first = pairs[0]?.first.id ?? 0;
  return (
    <Section title={t("Criteria")} label="criteria">
      <Scroll label={t("Criteria of the runs")}>
        <table>
          <thead>
            <tr><th scope="col">{t("criterion")}</th><th scope="col" class="number">{t("limit")}</th><th scope="col" class="number">{t("run {run}", { run: first })}</th>
              {pairs.map(({ other }) => [<th key={other.id} scope="col" class="number">{t("run {run}", { run: other.id })}</th>, <th key={`${other.id} change`} scope="col" class="number">{t("run {other} − run {first}", { other: other.id, first })}</th>])}
            </tr>
          </thead>
          <tbody>
            {rows.map((row) => (
              <tr key={keyOf(row)}><th scope="row"><CriterionName of={row} /></th><td class="number">{!row.limit ? "–" : row.limit.startsWith("<") ? row.limit : joined(figuresIn(row.limit.replace(/-(?=\d)/g, "−")), row.unit)}</td>
                <td class="number"><Value value={row.values[0]} verdict={row.verdicts[0]} unit={row.unit} /></td>
                {pairs.map((pair) => <Other key={pair.other.id} row={pair.criteria.find((one) => keyOf(one) === keyOf(row))} />)}
              </tr>
            ))}
          </tbody>
        </table>
      </Scroll>
    </Section>
  );
}

// A dash where a run's plan has no such criterion.
function Value({ value, verdict, unit }: { value: number | null; verdict: Row["verdicts"][number]; unit: string }): JSX.Element {
  return verdict === null ? <>–</> : <>{figure(value, unit)} <Badge kind={verdict} /></>;
}

function Other({ row }: { row: Row | undefined }): JSX.Element {
  const change = row ? changeOf(row) : null, words = { better: t("better"), worse: t("worse"), same: t("the same"), open: "" };
  if (!row) return <><td class="number">–</td><td class="number">–</td></>;
  return (
    <>
      <td class="number"><Value value={row.values[1]} verdict={row.verdicts[1]} unit={row.unit} /></td>
      <td class={`number ${change?.kind === "better" ? "good" : change?.kind === "worse" ? "bad" : ""}`}>{!change ? "–" : change.kind === "same" ? words.same : changeText(change, row)}{change && change.kind !== "same" && words[change.kind] ? <span class="reason">{words[change.kind]}</span> : null}</td>
    </>
  );
}
