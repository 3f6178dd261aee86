// Runs side by side: what they were given differently, traces from the step, criteria with differences.

import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import { get } from "../api/client.ts";
import type { Comparison, FoundRuns, Run, RunView } from "../api/types.ts";
import { to } from "../addresses.ts";
import { isMissing, useData } from "../data.ts";
import { moment } from "../format.ts";
import { English } from "../i18n/english.tsx";
import { t, tx } from "../i18n/text.ts";
import { roleOf } from "../plot/frame.ts";
import { useQuery } from "../router.ts";
import { runInWords } from "../ui/run-kind.ts";
import { linkTo, Heading, Section } from "../ui/parts.tsx";
import { recordingsFrom, type Beside } from "./compare-beside.ts";
import { failedIn, levelsOf } from "./compare-levels.ts";
import { ChooseRecordings } from "./compare-recordings.tsx";
import { ComparedCriteria } from "./compare-criteria.tsx";
import { Differences, Lead } from "./compare-inputs.tsx";
import { nameOf } from "./runs/run-name.ts";
import { ComparePlot, stretchOf } from "./compare-plot.tsx";

const CHANNELS = ["shaft_torque_nm", "motor_speed_rad_s", "motor_torque_nm"];
const MOST = 6;

export function Compare(): JSX.Element {
  const [query, setQuery] = useQuery();
  const chosen = (query.get("runs") ?? "").split(",").map(Number).filter((one) => Number.isInteger(one) && one > 0), each = [...new Set(chosen)], runs = each.slice(0, MOST);
  const twice = each.filter((run) => chosen.filter((one) => one === run).length > 1);
  const set = (changed: number[]) => {
    const next = new URLSearchParams(query);
    next.set("runs", changed.join(","));
    setQuery(next, true);
  };
  const beside = recordingsFrom(query.get("recordings"));
  const setBeside = (text: string) => {
    const next = new URLSearchParams(query);
    if (text) next.set("recordings", text); else next.delete("recordings");
    setQuery(next, true);
  };
  return (
    <>
      <Heading>{t("Compare runs")}</Heading>
      <Choose runs={runs} onChange={set} />
      {runs.map((run) => <NoSuchRun key={run} run={run} onLeaveOut={() => set(runs.filter((one) => one !== run))} />)}
      {twice.map((run) => <p key={run} class="bad" role="status">{t("Run {run} is named twice in the address. A run is not compared with itself: choose another one.", { run })}</p>)}
      {each.length > MOST ? <p class="bad" role="status">{t("{count} runs are chosen; the first {most} are compared.", { count: each.length, most: MOST })}</p> : null}
      {runs.length ? <ChooseRecordings chosen={beside} runs={runs.length} onChange={setBeside} /> : null}
      {runs.length >= 2 || (runs.length && beside.length) ? <Compared key={runs.join()} runs={runs} beside={beside} query={query} setQuery={setQuery} /> : <p class="quiet">{tx("Choose two runs or more, of one plan or of its copies; in the <a>table of runs</a> they can be ticked.", { a: linkTo(to.list("runs")) })}</p>}
    </>
  );
}

function NoSuchRun({ run, onLeaveOut }: { run: number; onLeaveOut: () => void }): JSX.Element | null {
  if (!isMissing(useData<Run>(`/runs/${run}`))) return null;
  return <p class="bad" role="status">{t("There is no run {run}", { run })}. <button type="button" onClick={onLeaveOut}>{t("Leave out run {run}", { run })}</button></p>;
}

const named = (run: Run): string => `${run.id}: ${nameOf(run)}, ${runInWords(run)}${run.ended_at ? `, ${moment(run.ended_at)}` : ""}`;

const OFFERED = [["state", "ended"], ["state", "interrupted"], ["most", "100"]];

function useOffered(more: string[][] | null, without: number[]): { runs: Run[]; loading: boolean } {
  const found = useData<FoundRuns>(more && `/run-list?${new URLSearchParams([...OFFERED, ...more])}`);
  return { runs: found.data?.runs.map(({ run }) => run).filter((run) => !without.includes(run.id)) ?? [], loading: found.loading };
}

function Choose({ runs, onChange }: { runs: number[]; onChange: (runs: number[]) => void }): JSX.Element {
  const first = useData<Run>(runs[0] ? `/runs/${runs[0]}` : null).data;
  const ofPlan = useOffered(first ? [["plan", first.plan]] : null, runs), all = useOffered([], runs);
  const others = first ? all.runs.filter((run) => run.plan !== first.plan) : all.runs;
  const isEmpty = !ofPlan.runs.length && !others.length && !ofPlan.loading && !all.loading;
  const options = (offered: Run[]) => offered.map((run) => <option key={run.id} value={run.id}>{named(run)}</option>);
  return (
    <div class="row small">
      {runs.map((run, at) => (
        <span key={run} class="chip"><span class={`swatch ${roleOf(at)}`} /><a href={to.run(run)}>{t("run {run}", { run })}</a>
          <button type="button" class="plain" aria-label={t("Leave out run {run}", { run })} onClick={() => onChange(runs.filter((one) => one !== run))}>×</button>
        </span>
      ))}
      {runs.length < MOST && isEmpty ? <p class="quiet">{runs.length ? t("No other run has ended yet: run this plan, or a changed copy of it, then compare.") : t("No run has ended yet.")}</p> : null}
      {runs.length < MOST && !isEmpty ? (
        <label>{runs.length ? t("and") : t("A run")}{" "}
          <select value="" onChange={(event) => onChange([...runs, Number(event.currentTarget.value)])}>
            <option value="" disabled>{t("choose …")}</option>
            {first ? <><optgroup label={t("runs of {plan}", { plan: first.plan })}>{ofPlan.runs.length ? options(ofPlan.runs) : <option disabled>{t("none that has ended")}</option>}</optgroup><optgroup label={t("runs of other plans")}>{options(others)}</optgroup></> : options(others)}
          </select>
        </label>
      ) : null}
    </div>
  );
}

interface Found {
  views: RunView[] | null; // there at once, as their traces are
  pairs: Comparison[] | null; // of the first run with each other: recordings are read for it
  error: Error | null;
}

function useFound(runs: number[]): Found {
  const [found, setFound] = useState<Found>({ views: null, pairs: null, error: null });
  useEffect(() => {
    const control = new AbortController();
    const [first, ...others] = runs;
    const look = async <T,>(name: "views" | "pairs", asked: Promise<T>[]) => {
      try {
        const all = await Promise.all(asked);
        setFound((before) => ({ ...before, [name]: all }));
      } catch (error) {
        if (!control.signal.aborted) setFound((before) => ({ ...before, error: error as Error }));
      }
    };
    void look("views", runs.map((run) => get<RunView>(`/runs/${run}/view`, control.signal)));
    void look("pairs", others.map((other) => get<Comparison>(`/comparisons?first=${first}&other=${other}`, control.signal)));
    return () => control.abort();
  }, []);
  return found;
}

interface Common {
  id: string;
  channels: string[];
}

// Segments that all runs have, and the channels of all.
function segmentsOf(views: RunView[]): Common[] {
  const [first, ...others] = views;
  if (!first) return [];
  const channels = Object.keys(first.channels).filter((one) => others.every((view) => one in view.channels));
  const names = first.marks.filter((mark) => mark.kind === "segment" && mark.end_s !== null).map((mark) => mark.name);
  return names.filter((name) => views.every((view) => stretchOf(view, name, false) !== null)).map((id) => ({ id, channels }));
}

function Compared({ runs, beside, query, setQuery }: { runs: number[]; beside: Beside[]; query: URLSearchParams; setQuery: (query: URLSearchParams) => void }): JSX.Element | null {
  const { views, pairs, error } = useFound(runs);
  if (error) return isMissing({ error }) ? null : <p class="bad" role="alert"><English>{error.message}</English></p>; // which is said above
  if (!views) return <p class="quiet">{t("Loading the runs …")}</p>;
  const segments = segmentsOf(views).filter(({ id }) => !pairs || pairs.every((pair) => pair.segments.some((one) => one.id === id)));
  const segment = segments.find((one) => one.id === query.get("segment")) ?? segments.find((one) => one.id === failedIn(views, segments.map(({ id }) => id))) ?? segments[0];
  const near = query.get("stretch") !== "whole";
  const put = (name: string, value: string) => {
    const next = new URLSearchParams(query);
    next.set(name, value);
    setQuery(next);
  };
  const channels = (query.get("channels")?.split(",") ?? CHANNELS).filter((one) => segment?.channels.includes(one));
  const ofRuns = segment ? views.map((view) => stretchOf(view, segment.id, near)).filter((one) => one !== null) : [];
  const stretches = [...ofRuns, ...beside.map(({ id, step }) => ({ recording: id, run: 0, step, from: ofRuns[0]?.from ?? 0, to: ofRuns[0]?.to ?? 0 }))];
  return (
    <>
      {pairs ? pairs.map((pair) => <Lead key={pair.other.id} pair={pair} />) : <p class="quiet">{t("Comparing criteria and inputs …")}</p>}
      {pairs?.length ? <Differences pairs={pairs} /> : null}
      {segment ? (
        <Section title={t("Traces from the step")} label="traces">
          <div class="row small">
            <label>{t("Segment")} <select value={segment.id} onChange={(event) => put("segment", event.currentTarget.value)}>{segments.map((one) => <option key={one.id}>{one.id}</option>)}</select></label>
            <label>{t("Stretch")} <select value={near ? "near" : "whole"} onChange={(event) => put("stretch", event.currentTarget.value)}><option value="near">{t("first 2 s")}</option><option value="whole">{t("whole segment")}</option></select></label>
            <label>{t("Channel")} <select value="" onChange={(event) => put("channels", [...channels, event.currentTarget.value].join(","))}><option value="" disabled>{t("add …")}</option>{segment.channels.filter((one) => !channels.includes(one)).map((one) => <option key={one}>{one}</option>)}</select></label>
            {channels.length ? <button type="button" class="plain" onClick={() => put("channels", channels.slice(0, -1).join(","))}>{t("Leave out the last")}</button> : null}
          </div>
          <div class="plots part">{channels.map((channel) => <ComparePlot key={channel} channel={channel} unit={views[0]?.channels[channel] ?? ""} stretches={stretches} levels={levelsOf(views, segment.id, channel)} />)}</div>
        </Section>
      ) : <p class="quiet">{t("No segment of the same name and kind is in all of these runs: their traces cannot be laid over each other.")}</p>}
      {pairs?.length ? <ComparedCriteria pairs={pairs} /> : null}
    </>
  );
}
