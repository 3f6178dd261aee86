// How a criterion of a plan went from run to run, with its limits, its scatter, Cpk, and what tells a drift.

import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import type { Trend } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { isMissing, useData } from "../../data.ts";
import { figure, limitText } from "../../format.ts";
import { English } from "../../i18n/english.tsx";
import { t } from "../../i18n/text.ts";
import { useQuery } from "../../router.ts";
import { Section } from "../../ui/parts.tsx";
import { useSameValues, WhichRuns } from "./same-values.tsx";
import { Signals } from "./signals.tsx";
import { TrendPlot } from "./trend-plot.tsx";

const NONE: Trend[] = [];
const LEAST = 5; // values of which a scatter is reported

export function Trends({ bench, plan, empty }: { bench: string; plan: string; empty?: string }): JSX.Element | null {
  const [chosen, setChosen] = useQuery(), dut = chosen.get("dut") ?? "", criterion = chosen.get("criterion");
  const put = (name: string, value: string) => {
    const next = new URLSearchParams(chosen);
    if (value) next.set(name, value); else next.delete(name);
    setChosen(next);
  };
  const setDut = (value: string) => put("dut", value), setCriterion = (value: string) => put("criterion", value);
  const same = useSameValues(bench, plan), like = /^[1-9]\d{0,8}$/.test(chosen.get("like") ?? "") ? Number(chosen.get("like")) : null;
  const query = new URLSearchParams({ bench, plan, ...(dut ? { dut } : {}), ...(like === null ? {} : { like: String(like) }) });
  const asked = useData<Trend[]>(`/trends?${query}`), all = asked.data ?? NONE;
  const found = all.filter((one) => one.points.some((point) => point.value !== null));
  const [duts, setDuts] = useState<string[]>([]);
  useEffect(() => {
    if (!dut) setDuts([...new Set(all.flatMap((one) => one.points.map((point) => point.dut)))].filter(Boolean).sort());
  }, [all, dut]);
  const devices = dut && !duts.includes(dut) ? [dut, ...duts] : duts;
  const trend = found.find((one) => one.criterion === criterion) ?? found[0];
  if (empty && isMissing(asked)) return <NoSuch bench={bench} plan={plan} />;
  if (empty && asked.error) return <p class="bad" role="alert"><English>{asked.error.message}</English></p>;
  if (!trend) return empty && asked.data ? <p class="quiet">{empty}</p> : null;
  return (
    <Section title={t("Trend over runs of {plan}", { plan })} label="trend">
      {same ? <WhichRuns of={same} like={like} onChoose={(run) => put("like", run === same[0]?.run ? "" : String(run))} /> : null}
      <Drifting of={found} chosen={trend.criterion} onChoose={setCriterion} />
      <div class="row small">
        <label>{t("Criterion")} <select value={trend.criterion} onChange={(event) => setCriterion(event.currentTarget.value)}>{found.map((one) => <option key={one.criterion}>{one.criterion}</option>)}</select></label>
        <label>{t("of")} <select value={dut} onChange={(event) => setDut(event.currentTarget.value)}><option value="">{t("all devices")}</option>{devices.map((one) => <option key={one}>{one}</option>)}</select></label>
      </div>
      <p class="quiet">{figuresOf(trend)}</p>
      <TrendPlot trend={trend} label={t("{criterion} over {count} runs: {figures}", { criterion: trend.criterion, count: trend.points.length, figures: figuresOf(trend) })} />
      <Signals of={trend.signals ?? []} />
    </Section>
  );
}

function NoSuch({ bench, plan }: { bench: string; plan: string }): JSX.Element {
  const noBench = isMissing(useData(`/benches/${encodeURIComponent(bench)}`)), noPlan = isMissing(useData(`/plans/${encodeURIComponent(plan)}`));
  return (
    <>
      {noBench ? <p class="bad" role="status">{t("There is no bench '{bench}'", { bench })}. <a href={to.list("benches")}>{t("All benches")}</a></p> : null}
      {noPlan ? <p class="bad" role="status">{t("There is no plan '{name}'", { name: plan })}. <a href={to.list("plans")}>{t("All plans")}</a></p> : null}
    </>
  );
}

function figuresOf(trend: Trend): string {
  const limits = limitText(trend.upper, trend.lower, trend.unit), count = trend.count ?? 0;
  const hasCpk = trend.cpk !== null && trend.cpk !== undefined;
  const cpk = hasCpk ? t("Cpk {cpk} (95 %: {lower} to {upper}, {count} runs)", { cpk: figure(trend.cpk), lower: figure(trend.cpk_lower), upper: figure(trend.cpk_upper), count }) : limits !== "–" && count < LEAST ? t("Cpk: too few runs ({count} of {least})", { count, least: LEAST }) : "";
  return [t("mean {value}", { value: figure(trend.mean, trend.unit) }), limits === "–" ? "" : t("limit {limit}", { limit: limits }), cpk].filter(Boolean).join(", ");
}

// A drift is told before it fails: criteria whose newest value is part of a pattern that chance seldom makes.
function Drifting({ of, chosen, onChoose }: { of: Trend[]; chosen: string; onChoose: (criterion: string) => void }): JSX.Element | null {
  const drifting = of.filter((one) => (one.signals ?? []).some((signal) => signal.present));
  if (!drifting.length) return null;
  return (
    <p class="notice" role="status">{t("May drift:")}{" "}
      {drifting.map((one) => <button type="button" class="plain" key={one.criterion} aria-pressed={one.criterion === chosen} onClick={() => onChoose(one.criterion)}><English>{`${one.criterion} (${reasonOf(one)})`}</English></button>)}
    </p>
  );
}

function reasonOf({ signals = [] }: Trend): string {
  const present = signals.filter((signal) => signal.present), more = present.length - 1;
  return more > 0 ? t("{pattern}, and {count} more", { pattern: present[0]?.text ?? "", count: more }) : present[0]?.text ?? "";
}
