// All runs: filtered, sorted and paged by the service; two or more are chosen to be compared.

import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import type { FoundRun, FoundRuns } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { isMissing, useData } from "../../data.ts";
import { figure, limitText, whole } from "../../format.ts";
import { English } from "../../i18n/english.tsx";
import { t, tn, tx } from "../../i18n/text.ts";
import { go, useQuery } from "../../router.ts";
import { Badge, Heading, linkTo, Moment, Scroll, verdictOf } from "../../ui/parts.tsx";
import { RunFilters } from "./run-filters.tsx";
import { impossibleIn, PAGE, queryFrom, sorted, ticked, toAddress, toService, type Order, type RunsQuery } from "./runs-query.ts";
import { detailsOf, titleOf } from "./run-name.ts";
import { tookOf } from "./run-values.ts";

const AGAIN_MS = 10_000;

export function Runs(): JSX.Element {
  const [address, setAddress] = useQuery();
  const query = queryFrom(address), { chosen } = query, impossible = impossibleIn(query);
  const found = useData<FoundRuns>(impossible ? null : `/run-list?${toService(query)}`, AGAIN_MS);
  const [kept, setKept] = useState<FoundRuns | null>(null), shown = impossible || (isMissing(found) && !found.loading) ? null : kept; // stays while the next page is asked for
  useEffect(() => { if (found.data) setKept(found.data); }, [found.data]);
  const set = (changed: RunsQuery, step = true) => setAddress(toAddress(changed), step);
  const total = shown?.total ?? 0, pages = Math.max(1, Math.ceil(total / PAGE));
  return (
    <>
      <Heading>{t("Runs")}</Heading>
      <RunFilters query={query} onChange={(changed) => set({ ...changed, page: 1 })} />
      <div class="part-head">
        <p aria-live="polite">
          {impossible ? <NoSuch of={impossible} /> : shown ? tn("{count} run", "{count} runs", total) : found.error ? null : "…"}
          {found.error ? <span class="bad"> <English>{found.error.message}</English></span> : null}{isMissing(found) ? <> <a href={to.list("runs")}>{t("All runs")}</a></> : null}
        </p>
        <span class="buttons small">
          {chosen.length ? <span class="quiet">{t("{count} chosen", { count: chosen.length })}</span> : null}
          <button type="button" disabled={chosen.length < 2} onClick={() => go(`${to.list("compare")}?runs=${chosen.join(",")}`)}>{t("Compare")}</button>
          {chosen.length ? <button type="button" class="plain" onClick={() => set({ ...query, chosen: [] }, false)}>{t("Choose none")}</button> : null}
        </span>
      </div>
      {shown && total === 0 ? <p class="quiet">{[...toAddress({ ...query, page: 1, sort: "run", rising: false, chosen: [] })].length ? t("No run passes these filters.") : tx("No run yet. A plan is started at <bench>a bench</bench> or from <plan>its own page</plan>.", { bench: linkTo(to.list("benches")), plan: linkTo(to.list("plans")) })}</p> : null}
      {shown && total > 0 ? <Table runs={shown.runs} query={query} chosen={chosen} busy={found.loading} onChoose={(run) => set(ticked(query, run), false)} onSort={(by) => set(sorted(query, by))} /> : null}
      {pages > 1 ? (
        <nav class="row pages" aria-label={t("Pages of runs")}>
          <button type="button" disabled={query.page <= 1} onClick={() => set({ ...query, page: query.page - 1 })}>{t("Previous")}</button>
          <span>{t("Page {page} of {pages}", { page: query.page, pages: whole(pages) })}</span>
          <button type="button" disabled={query.page >= pages} onClick={() => set({ ...query, page: query.page + 1 })}>{t("Next")}</button>
        </nav>
      ) : null}
    </>
  );
}

function NoSuch({ of: { filter, name } }: { of: NonNullable<ReturnType<typeof impossibleIn>> }): JSX.Element {
  const shown = { name, a: linkTo(to.list("runs")) };
  return <span class="bad">{filter === "verdict" ? tx("There is no verdict '{name}'. Choose one of the list, or see <a>all runs</a>.", shown) : tx("There is no state '{name}'. Choose one of the list, or see <a>all runs</a>.", shown)}</span>;
}

const COLUMNS: [Order | "", string, string][] = [["run", t("run"), "number"], ["plan", t("plan"), ""], ["verdict", t("verdict"), ""], ["bench", t("bench"), ""], ["dut", t("device"), ""], ["ended", t("ended"), ""], ["duration", t("duration"), "number"], ["", t("by"), ""]];

interface TableOptions {
  runs: FoundRun[];
  query: RunsQuery;
  chosen: number[];
  busy: boolean;
  onChoose: (run: number) => void;
  onSort: (by: Order) => void;
}

function Table({ runs, query, chosen, busy, onChoose, onSort }: TableOptions): JSX.Element {
  const columns = query.criterion ? [...COLUMNS.slice(0, 3), ["value", query.criterion, "number"] as [Order, string, string], ...COLUMNS.slice(3)] : COLUMNS;
  return (
    <Scroll label={t("Runs")}>
      <table aria-busy={busy}>
        <thead>
          <tr><th scope="col"><span class="hidden">{t("compare")}</span></th>
            {columns.map(([by, name, kind]) => (
              <th key={name} scope="col" class={kind} aria-sort={by === query.sort ? (query.rising ? "ascending" : "descending") : undefined}>
                {by ? <button type="button" class="plain sort" onClick={() => onSort(by)}>{name}<span aria-hidden="true">{by === query.sort ? (query.rising ? " ▲" : " ▼") : ""}</span></button> : name}
              </th>
            ))}
          </tr>
        </thead>
        <tbody>{runs.map((one) => <Row key={one.run.id} found={one} withValue={query.criterion !== ""} chosen={chosen.includes(one.run.id)} onChoose={onChoose} />)}</tbody>
      </table>
    </Scroll>
  );
}

function Row({ found, withValue, chosen, onChoose }: { found: FoundRun; withValue: boolean; chosen: boolean; onChoose: (run: number) => void }): JSX.Element {
  const { run } = found;
  const details = detailsOf(run);
  const reason = run.reason?.split("\n")[0] ?? "";
  return (
    <tr>
      <td><input type="checkbox" aria-label={t("Compare run {run}", { run: run.id })} checked={chosen} onChange={() => onChoose(run.id)} /></td>
      <td class="number"><a href={to.run(run.id)}>{run.id}</a></td>
      <th scope="row"><a href={to.run(run.id)} class="quietly">{titleOf(run)}</a>{found.tags?.map((tag) => <span class="tag" key={tag}>{tag}</span>)}{details ? <span class="reason">{details}</span> : null}{reason ? <span class="reason"><English>{reason}</English></span> : null}</th>
      <td><Badge kind={verdictOf(run)} />{run.safe_state === "not_confirmed" ? <span class="bad"> {t("NOT CONFIRMED SAFE")}</span> : null}</td>
      {withValue ? <td class={`number ${found.criterion_verdict === "fail" ? "bad" : ""}`}>{figure(found.value, found.unit)}<span class="reason">{limitText(found.upper, found.lower)}</span></td> : null}
      <td><a href={to.bench(run.bench)}>{run.bench}</a></td>
      <td>{run.dut || "–"}</td>
      <td>{run.ended_at ? <Moment at={run.ended_at} /> : <span class="quiet">{t("queued")} <Moment at={run.queued_at} /></span>}</td>
      <td class="number">{tookOf(run) || "–"}</td>
      <td>{run.requested_by}</td>
    </tr>
  );
}
