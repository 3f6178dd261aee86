// What a campaign came to: how each criterion is distributed, what it hangs on, which cars are worst.

import type { JSX } from "preact";
import { useMemo, useState } from "preact/hooks";
import type { Campaign, CampaignFindings } from "../../api/types.ts";
import { figure, limitText, percent } from "../../format.ts";
import { English } from "../../i18n/english.tsx";
import { t, tx } from "../../i18n/text.ts";
import { CurvePlot, type Curve } from "../../plot/curve-plot.tsx";
import { roleOf } from "../../plot/frame.ts";
import { useMay } from "../../session.ts";
import { Badge, inWords, Scroll, Section } from "../../ui/parts.tsx";
import { benchOf, RunCar, useCarRuns } from "./run-car.tsx";

type Controller = CampaignFindings["controllers"][number];
type Criterion = Controller["criteria"][number];

const nameOf = (one: Controller): string => (one.controller ? inWords(one.controller) : t("the plan's own"));

export function Findings({ of, campaign }: { of: CampaignFindings; campaign: Campaign }): JSX.Element {
  const { controllers } = of, ids = controllers[0]?.criteria.map((one) => one.id) ?? [];
  const [chosen, setChosen] = useState("");
  const id = ids.includes(chosen) ? chosen : mostFailed(controllers);
  const errors = Object.entries(of.errors);
  return (
    <>
      <Section title={t("Criteria")} label="criteria"><Criteria controllers={controllers} chosen={id} onChoose={setChosen} /></Section>
      <Section title={t("Distribution of {criterion}", { criterion: id })} label="distribution"><Distribution controllers={controllers} id={id} /></Section>
      <Section title={t("What decides {criterion}", { criterion: id })} label="decides"><Decides controllers={controllers} id={id} units={of.inputs} /></Section>
      <Section title={t("Worst cars")} label="worst"><Worst of={of} campaign={campaign} /></Section>
      {errors.length ? <Section title={t("What went wrong")} label="errors"><ul>{errors.map(([why, count]) => <li key={why}>{tx("{count} with: {why}", { count, why: <English>{why}</English> })}</li>)}</ul></Section> : null}
    </>
  );
}

// That which passes least often is looked at first.
function mostFailed(controllers: Controller[]): string {
  const all = controllers.flatMap((one) => one.criteria).filter((one) => one.share !== null);
  return all.sort((one, other) => (one.share ?? 1) - (other.share ?? 1))[0]?.id ?? controllers[0]?.criteria[0]?.id ?? "";
}

const of = (controller: Controller, id: string): Criterion | undefined => controller.criteria.find((one) => one.id === id);

function Criteria({ controllers, chosen, onChoose }: { controllers: Controller[]; chosen: string; onChoose: (id: string) => void }): JSX.Element {
  return (
    <Scroll label={t("Criteria")}><table>
      <thead><tr><th scope="col">{t("criterion")}</th><th scope="col" class="number">{t("limit")}</th>{controllers.map((one) => <th scope="col" class="number" key={one.controller}>{t("{controller}: passes, median, range", { controller: nameOf(one) })}</th>)}</tr></thead>
      <tbody>
        {(controllers[0]?.criteria ?? []).map((one) => (
          <tr key={one.id}>
            <th scope="row"><button type="button" class="plain" aria-pressed={one.id === chosen} onClick={() => onChoose(one.id)}>{one.id}</button></th>
            <td class="number">{one.below ? t("below {limit}", { limit: one.below }) : limitText(one.upper, one.lower, one.unit)}</td>
            {controllers.map((controller) => { const found = of(controller, one.id); return <td class="number" key={controller.controller}>{found ? `${found.share === null ? "–" : percent(found.share, 1)}, ${figure(found.median, found.unit)}` : "–"}<span class="reason">{found?.least == null ? "" : t("{lower} to {upper}", { lower: figure(found.least), upper: figure(found.largest) })}</span></td>; })}
          </tr>
        ))}
      </tbody>
    </table></Scroll>
  );
}

function Distribution({ controllers, id }: { controllers: Controller[]; id: string }): JSX.Element {
  return <div class="plots">{controllers.map((one, at) => <Histogram key={one.controller} criterion={of(one, id)} name={nameOf(one)} role={roleOf(at)} />)}</div>;
}

function Histogram({ criterion, name, role }: { criterion: Criterion | undefined; name: string; role: string }): JSX.Element | null {
  const curves = useMemo((): Curve[] => {
    const found = criterion?.histogram;
    return found ? [{ name, role, looks: "bars", x: found.counts.map((_, at) => found.start + (at + 0.5) * found.width), y: found.counts }] : [];
  }, [criterion, name, role]);
  if (!criterion || !curves.length) return null;
  const limits = [criterion.upper, criterion.lower].filter((one): one is number => one !== null);
  const about = t("median {median}, {lower} to {upper}", { median: figure(criterion.median, criterion.unit), lower: figure(criterion.least), upper: figure(criterion.largest, criterion.unit) });
  return <CurvePlot title={name} label={t("Histogram of {criterion} with {name}: {about}", { criterion: criterion.id, name, about })} says={about} curves={curves} x={{ unit: criterion.unit }} y={{ unit: t("cars"), low: 0 }} uprights={limits} />;
}

// The strongest first; a bar to the right rises together with the criterion, one to the left against it.
function Decides({ controllers, id, units }: { controllers: Controller[]; id: string; units: Record<string, string> }): JSX.Element {
  const names = Object.keys(units), strength = (name: string) => Math.max(...controllers.map((one) => Math.abs(of(one, id)?.rank_correlations[name] ?? 0)));
  if (!names.length) return <p class="quiet">{t("Nothing differs from car to car.")}</p>;
  const sorted = names.sort((one, other) => strength(other) - strength(one));
  return (
    <Scroll label={t("What decides")}><table>
      <thead><tr><th scope="col">{t("input")}</th>{controllers.map((one) => <th scope="col" key={one.controller}>{nameOf(one)}</th>)}</tr></thead>
      <tbody>{sorted.map((name) => <tr key={name}><th scope="row">{name}</th>{controllers.map((one) => <td key={one.controller}><Correlation value={of(one, id)?.rank_correlations[name] ?? null} /></td>)}</tr>)}</tbody>
    </table><p class="quiet">{t("Rank correlation (Spearman's ρ) of the criterion with the input, from −1 to 1.")}</p></Scroll>
  );
}

function Correlation({ value }: { value: number | null }): JSX.Element {
  if (value === null) return <span class="quiet">–</span>;
  return <span class="correlation"><span class="rho" style={{ "--from": `${50 + 50 * Math.min(0, value)}%`, "--wide": `${50 * Math.abs(value)}%` }} /> {figure(value)}</span>;
}

const SHOWN = 10;

function Worst({ of: { controllers, inputs }, campaign: { id, place } }: { of: CampaignFindings; campaign: Campaign }): JSX.Element {
  const may = useMay(), runs = useCarRuns(id), runnable = may("engineer") && !place;
  const all = controllers.flatMap((controller) => controller.worst.map((one) => ({ controller, one }))).sort((a, b) => a.one.margin - b.one.margin).slice(0, SHOWN);
  const names = Object.keys(inputs);
  if (!all.length) return <p class="quiet">{t("No simulation has a margin.")}</p>;
  return (
    <Scroll label={t("Worst cars")}><table>
      <thead><tr><th scope="col" class="number">{t("simulation")}</th><th scope="col">{t("controller")}</th><th scope="col" class="number">{t("margin")}</th><th scope="col">{t("verdict")}</th><th scope="col">{t("binding criterion")}</th>{runnable ? <th scope="col">{t("on a simulated bench")}</th> : null}{names.map((name) => <th scope="col" class="number" key={name}>{inputs[name] && inputs[name] !== "1" ? t("{name} in {unit}", { name, unit: inputs[name] }) : name}</th>)}</tr></thead>
      <tbody>{all.map(({ controller, one }) => <tr key={`${controller.controller} ${one.simulation}`}><td class="number">{one.simulation}</td><td>{nameOf(controller)}</td><td class="number">{percent(one.margin, 1)}</td><td><Badge kind={one.verdict} /></td><td>{one.binding}</td>{runnable ? <td><RunCar campaign={id} simulation={one.simulation} run={runs.get(benchOf(id, one.simulation))} /></td> : null}{names.map((name) => <td class="number" key={name}>{figure(one.inputs[name])}</td>)}</tr>)}</tbody>
    </table></Scroll>
  );
}
