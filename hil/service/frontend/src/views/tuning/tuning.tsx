// One tuning: how far it is, what it decides, the front of controllers, and the best one to be taken.

import type { JSX } from "preact";
import { useMemo, useState } from "preact/hooks";
import { ask } from "../../api/client.ts";
import type { Autotuning, Study, Tuning } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { attempt, useData } from "../../data.ts";
import { figure, percent } from "../../format.ts";
import { English } from "../../i18n/english.tsx";
import { t, tx } from "../../i18n/text.ts";
import { CurvePlot, type Curve } from "../../plot/curve-plot.tsx";
import { useMay } from "../../session.ts";
import { NameField } from "../../ui/name-field.tsx";
import { Facts, inWords, Loaded, Scroll, Section } from "../../ui/parts.tsx";
import { OVER, StudyPage, textOf } from "../studies/study-parts.tsx";

const AGAIN_MS = 1500;

export function TuningView({ id }: { id: number }): JSX.Element {
  return <StudyPage id={id} kind="tuning">{(study) => (study.kind === "autotuning" ? <Sequence study={study} /> : <OnModel study={study} />)}</StudyPage>;
}

function OnModel({ study }: { study: Study }): JSX.Element {
  const found = useData<Tuning>(`/tunings/${study.id}`, OVER.includes(study.state) ? 0 : AGAIN_MS);
  return (
    <Loaded of={found} what={t("the tuning")}>
      {(data) => (
        <>
          <Progress of={data.progress} over={OVER.includes(study.state)} />
          <KeepController study={study} />
          {data.worst_margin === null || data.worst_margin === undefined ? null : <Result data={data} />}
        </>
      )}
    </Loaded>
  );
}

function Progress({ of: { text, share = 0, lines = [] }, over }: { of: Tuning["progress"]; over: boolean }): JSX.Element | null {
  if (over && !lines.length) return null;
  return (
    <Section title={t("Progress")} label="progress">
      {over ? null : <><progress max={1} value={share} aria-label={t("Progress")} /> <span class="quiet"><English>{text || t("waiting")}</English></span></>}
      {lines.length ? <ul>{lines.map((line, at) => <li key={at}><English>{line}</English></li>)}</ul> : null}
    </Section>
  );
}

function Result({ data }: { data: Tuning }): JSX.Element {
  const { parameters = {}, worse = [] } = data;
  return (
    <>
      <Section title={t("Worst margin")} label="margin">
        <Facts>{[[t("with the plan's controller"), percent(data.start_worst_margin ?? 0, 1)], [t("tuned"), percent(data.worst_margin ?? 0, 1)], [t("the search"), <English>{data.ended ?? ""}</English>]]}</Facts>
        {worse.length ? <><p>{t("Worse than with the plan's controller:")}</p><ul>{worse.map((one) => <li key={one}><English>{one}</English></li>)}</ul></> : null}
      </Section>
      <Section title={t("What can be traded")} label="front"><Front data={data} /></Section>
      <Section title={t("Numbers of the controller")} label="numbers">
        <Scroll label={t("Numbers of the controller")}><table>
          <thead><tr><th scope="col">{t("parameter")}</th><th scope="col" class="number">{t("before")}</th><th scope="col" class="number">{t("tuned")}</th><th scope="col" class="number">{t("range")}</th></tr></thead>
          <tbody>{Object.entries(parameters).map(([name, one]) => <tr key={name}><th scope="row">{inWords(name)}</th><td class="number">{figure(one.start)}</td><td class="number">{figure(one.value)}</td><td class="number">{t("{lower} to {upper}", { lower: figure(one.lower), upper: figure(one.upper) })}</td></tr>)}</tbody>
        </table></Scroll>
      </Section>
    </>
  );
}

// Each figure over the response time, which a slow controller pays with.
function Front({ data: { figures = [], front = [] } }: { data: Tuning }): JSX.Element {
  const across = figures.length - 1;
  const sorted = useMemo(() => front.filter((one) => one.figures.every((value) => value !== null)).sort((one, other) => (one.figures[across] as number) - (other.figures[across] as number)), [front, across]);
  if (!sorted.length) return <p class="quiet">{t("There is nothing to trade.")}</p>;
  const x = sorted.map((one) => one.figures[across] as number);
  return <div class="plots">{figures.slice(0, across).map((name, at) => <FrontPlot key={name} name={inWords(name)} x={x} y={sorted.map((one) => one.figures[at] as number)} />)}</div>;
}

function FrontPlot({ name, x, y }: { name: string; x: number[]; y: number[] }): JSX.Element {
  const curves = useMemo((): Curve[] => [{ name, role: "gain", looks: "dots", x, y }], [name, x.join(), y.join()]);
  return <CurvePlot title={t("{figure} over response time", { figure: name })} label={t("{figure} over response time: {count} controllers", { figure: name, count: x.length })} curves={curves} x={{ unit: "s" }} y={{ unit: "" }} />;
}

function Sequence({ study }: { study: Study }): JSX.Element {
  const over = OVER.includes(study.state), found = useData<Autotuning>(`/autotunings/${study.id}`, over ? 0 : AGAIN_MS);
  return (
    <Loaded of={found} what={t("the tuning")}>
      {(data) => (
        <>
          <Progress of={data.progress} over={over} />
          <KeepController study={study} />
          <Section title={t("Decisions")} label="decisions"><div aria-live="polite"><Decisions of={data.decisions ?? []} /></div></Section>
          {data.ended ? <p><English>{data.ended}</English></p> : null}
          {Object.keys(data.worst_margin ?? {}).length ? <Section title={t("Worst margin")} label="margin"><Facts>{Object.entries(data.worst_margin ?? {}).map(([name, value]): [string, string] => [inWords(name), value === null ? "–" : percent(value, 1)])}</Facts></Section> : null}
        </>
      )}
    </Loaded>
  );
}

function Decisions({ of }: { of: NonNullable<Autotuning["decisions"]> }): JSX.Element {
  if (!of.length) return <p class="quiet">{t("None yet.")}</p>;
  return (
    <Scroll label={t("Decisions")}><table>
      <thead><tr><th scope="col" class="number">{t("round")}</th><th scope="col">{t("stage")}</th><th scope="col">{t("found")}</th><th scope="col">{t("decided")}</th></tr></thead>
      <tbody>{of.map((one, at) => <tr key={at}><td class="number">{one.round}</td><th scope="row"><English>{one.stage}</English></th><td><English>{one.found}</English></td><td><English>{one.decided}<span class="reason">{one.why}</span></English></td></tr>)}</tbody>
    </table></Scroll>
  );
}

function KeepController({ study }: { study: Study }): JSX.Element | null {
  const may = useMay(), [name, setName] = useState(""), [saved, setSaved] = useState("");
  if (!may("engineer") || !(study.files ?? []).includes("controller.toml")) return null;
  const keep = async (event: Event) => {
    event.preventDefault();
    if (await attempt(async () => { await ask("PUT", `/controllers/${name}`, await textOf(study, "controller.toml")); return true; })) setSaved(name);
  };
  return (
    <Section title={t("Take the controller")} label="keep">
      <form class="row" onSubmit={(event) => void keep(event)}><NameField value={name} onChange={setName} /><button type="submit" class="main">{t("Save the controller")}</button></form>
      <p aria-live="polite">{saved ? tx("Saved as {link}; plans can load it.", { link: <a href={to.controller(saved)}>{saved}</a> }) : null}</p>
    </Section>
  );
}
