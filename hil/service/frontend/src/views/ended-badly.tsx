// Runs that ended badly while nobody looked: last night's stand where somebody comes in the morning. Not those whose end
// a person wanted.

import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import type { FoundRun, FoundRuns, Run } from "../api/types.ts";
import { to } from "../addresses.ts";
import { useData } from "../data.ts";
import { moment } from "../format.ts";
import { English } from "../i18n/english.tsx";
import { t, tn, tx } from "../i18n/text.ts";
import { Badge, linkTo, Moment, Section, verdictOf } from "../ui/parts.tsx";
import { nameOf } from "./runs/run-name.ts";
import { visit } from "./visits.ts";

const AGAIN_MS = 10_000, VISIT_MS = 60_000;
const SHOWN = 10, LOOKED_AT = "100";
const BAD = ["fail", "error", "interrupted"];

const isBad = (run: Run): boolean => BAD.includes(verdictOf(run)) || run.safe_state === "not_confirmed";

export function EndedBadly(): JSX.Element | null {
  const [since] = useState(() => new Date(visit().sinceMs).toISOString());
  useEffect(() => {
    const timer = setInterval(() => { if (!document.hidden) visit(); }, VISIT_MS); // it lasts as long as somebody looks
    return () => clearInterval(timer);
  }, []);
  // By their verdicts, however many ended since; and of the newest those without one.
  const judged = useData<FoundRuns>(`/run-list?${new URLSearchParams([["since", since], ["verdict", "fail"], ["verdict", "error"], ["most", LOOKED_AT]])}`, AGAIN_MS);
  const newest = useData<FoundRuns>(`/run-list?${new URLSearchParams([["since", since], ["state", "ended"], ["state", "interrupted"], ["most", LOOKED_AT]])}`, AGAIN_MS);
  if (!judged.data || !newest.data) return null;
  const runs = badOf([...judged.data.runs, ...newest.data.runs]), wanted = judged.data.runs.filter(({ run }) => !isBad(run)).length;
  const more = Math.max(runs.length, judged.data.total - wanted) - SHOWN;
  const from = moment(since);
  if (!runs.length) return <p class="quiet">{t("No run has failed since {moment}.", { moment: from })}</p>;
  return (
    <Section title={t("Runs that failed since {moment}", { moment: from })} label="failed">
      <ul class="queue">{runs.slice(0, SHOWN).map((run) => <Row key={run.id} run={run} />)}</ul>
      {more > 0 ? <p><a href={`${to.list("runs")}?${new URLSearchParams({ sort: "ended" })}`}>{tn("{count} more: all runs", "{count} more: all runs", more)}</a></p> : null}
    </Section>
  );
}

const badOf = (found: FoundRun[]): Run[] => [...new Map(found.map(({ run }) => [run.id, run])).values()].filter(isBad).sort((one, other) => other.id - one.id);

function Row({ run }: { run: Run }): JSX.Element {
  const reason = run.reason?.split("\n")[0] ?? "";
  return (
    <li>
      <span>
        <Badge kind={verdictOf(run)} /> {tx("<a>Run {run}</a>: {plan}, by {person}", { a: linkTo(to.run(run.id)), run: run.id, plan: nameOf(run), person: run.requested_by })}
        {run.safe_state === "not_confirmed" ? <span class="bad"> {t("NOT CONFIRMED SAFE")}</span> : null}
        {reason ? <span class="reason"><English>{reason}</English></span> : null}
      </span>
      <span class="quiet"><a href={to.bench(run.bench)}>{run.bench}</a>, <Moment at={run.ended_at} /></span>
    </li>
  );
}
