// Plans: what there is to run, what each does, and the form that starts it.

import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import { ask, getText } from "../../api/client.ts";
import type { Plan } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { attempt, isMissing, useData } from "../../data.ts";
import { itemOf } from "../../editor/drafts.ts";
import { Versions, versionPath } from "../../editor/versions.tsx";
import { limitText } from "../../format.ts";
import { t } from "../../i18n/text.ts";
import { agreed } from "../../question.ts";
import { go, useQuery } from "../../router.ts";
import { useMay } from "../../session.ts";
import { Heading, Loaded, Scroll, Section } from "../../ui/parts.tsx";
import { UseController } from "../design/use-controller.tsx";
import { EditPlan, PlanEditor } from "./plan-editor.tsx";
import { durationOf, torquesOf } from "./plan-facts.ts";
import { renamed, START } from "./plan-text.ts";
import { StartPlan } from "./start-plan.tsx";
import { GiveFile } from "../given/give-file.tsx";
import { NoneThere } from "../none-there.tsx";
import { Pictures } from "./pictures.tsx";

export function Plans(): JSX.Element {
  const plans = useData<Plan[]>("/plans"), [query] = useQuery();
  const may = useMay();
  if (query.get("write") === "new" && may("engineer")) return <><Heading kind={<a href={to.list("plans")}>{t("Plans")}</a>}>{t("Write a plan")}</Heading><PlanEditor text={START} tag="" item="plan" builtIn={false} /></>;
  return (
    <>
      <Heading>{t("Plans")}</Heading>
      <Loaded of={plans} what={t("plans")}>
        {(all) => (
          <Scroll label={t("Plans")}>
            <table>
              <thead><tr><th scope="col">{t("plan")}</th><th scope="col">{t("title")}</th><th scope="col">{t("origin")}</th><th scope="col" class="number">{t("duration")}</th><th scope="col">{t("largest torque")}</th><th scope="col" class="number">{t("variables")}</th></tr></thead>
              <tbody>
                {all.map((plan) => (
                  <tr key={plan.name}><th scope="row"><a href={to.plan(plan.name)}>{plan.name}</a></th>
                    <td>{plan.title}{plan.hazard ? <span class="bad"> {t("hazardous: {hazard}", { hazard: plan.hazard })}</span> : null}</td><td>{plan.built_in ? t("built in") : t("given")}</td><td class="number">{durationOf(plan)}</td><td>{torquesOf(plan) || "–"}</td><td class="number">{Object.keys(plan.variables).length}</td>
                  </tr>
                ))}
              </tbody>
            </table>
          </Scroll>
        )}
      </Loaded>
      {may("engineer") ? <p><a href={`${to.list("plans")}?write=new`}>{t("Write a plan")}</a></p> : null}
      {may("engineer") ? <Section title={t("Give a plan")} label="give"><GiveFile kind="plan" submit={t("Give the plan")} path="/plans" ending=".yaml" onGiven={(name) => go(to.plan(name))} /></Section> : null}
      {may("engineer") ? <Section title={t("Pictures for questions")} label="pictures"><Pictures /></Section> : null}
    </>
  );
}

export function PlanView({ name }: { name: string }): JSX.Element {
  const path = `/plans/${encodeURIComponent(name)}`, plan = useData<Plan>(path);
  if (isMissing(plan)) return <Gone name={name} onSaved={plan.again} />;
  return <Loaded whole of={plan} what={t("plan {name}", { name })}>{(found) => <Found plan={found} onSaved={plan.again} />}</Loaded>;
}

// Of a plan that was removed the versions stay, and one can be written on from.
function Gone({ name, onSaved }: { name: string; onSaved: () => void }): JSX.Element {
  const may = useMay(), [query] = useQuery(), version = Number(query.get("version")) || null, item = itemOf("plan", name, version);
  if (query.get("write") === "on" && version !== null && may("engineer")) return <><Heading kind={<a href={to.plan(name)}>{name}</a>}>{t("Edit the plan")}</Heading><EditPlan key={item} name={name} path={versionPath("plan", name, version)} item={item} builtIn={false} copied={(text) => text} onSaved={onSaved} /></>;
  return <NoneThere kind="plan" name={name}><Versions kind="plan" name={name} textPath={null} editPath={`${to.plan(name)}?write=on`} /></NoneThere>;
}

function Found({ plan, onSaved }: { plan: Plan; onSaved: () => void }): JSX.Element {
  const may = useMay(), [query] = useQuery(), textPath = `/plans/${encodeURIComponent(plan.name)}/text`, version = Number(query.get("version")) || null;
  const remove = async () => {
    if (!(await agreed(t("Remove the plan {name}? Its runs stay.", { name: plan.name }), t("Remove"), t("Cancel")))) return;
    if (await attempt(async () => { await ask("DELETE", `/plans/${encodeURIComponent(plan.name)}`); return true; })) go(to.list("plans"));
  };
  const variables = Object.entries(plan.variables);
  const edited = (text: string) => (plan.built_in ? renamed(text, `${plan.name}_copy`) : text);
  if (query.get("write") === "on" && may("engineer")) return <><Heading kind={<a href={to.plan(plan.name)}>{plan.name}</a>}>{plan.built_in ? t("A copy of this plan") : t("Edit the plan")}</Heading><EditPlan key={itemOf("plan", plan.name, version)} name={plan.name} path={version === null ? textPath : versionPath("plan", plan.name, version)} item={itemOf("plan", plan.name, version)} builtIn={plan.built_in} copied={edited} onSaved={onSaved} /></>;
  return (
    <>
      <Heading kind={plan.built_in ? t("Built-in plan {name}", { name: plan.name }) : t("Given plan {name}", { name: plan.name })}>{plan.title || plan.name}</Heading>
      {plan.description ? <p>{plan.description}</p> : null}
      {plan.hazard ? <p class="bad">{t("Hazardous: {hazard}. A second person approves each run.", { hazard: plan.hazard })}</p> : null}
      <p class="links"><a href={`${to.list("runs")}?plan=${encodeURIComponent(plan.name)}`}>{t("All runs of this plan")}</a> <a href={`${to.list("trends")}?plan=${encodeURIComponent(plan.name)}`}>{t("Trends")}</a>{may("engineer") ? <a href={`${to.plan(plan.name)}?write=on`}>{plan.built_in ? t("Edit a copy") : t("Edit")}</a> : null}</p>
      <div class="columns">
        <div>
          {variables.length ? (
            <Section title={t("Variables")} label="variables">
              <Scroll label={t("Variables")}><table>
                <thead><tr><th scope="col">{t("variable")}</th><th scope="col">{t("what")}</th><th scope="col" class="number">{t("default")}</th><th scope="col" class="number">{t("bounds")}</th></tr></thead>
                <tbody>{variables.map(([name, one]) => <tr key={name}><th scope="row">{name}</th><td>{one.description}</td><td class="number">{`${one.default} ${one.unit}`}</td><td class="number">{limitText(one.upper, one.lower)}</td></tr>)}</tbody>
              </table></Scroll>
            </Section>
          ) : null}
          <Section title={t("Text")} label="text"><FileText path={textPath} label={t("Plan {name}", { name: plan.name })} /></Section>
          <Versions kind="plan" name={plan.name} textPath={textPath} editPath={`${to.plan(plan.name)}?write=on`} />
          {may("engineer") && !plan.built_in ? <div class="row"><button type="button" onClick={() => void remove()}>{t("Remove the plan")}</button></div> : null}
        </div>
        {may("operator") ? (
          <div>
            <Section title={t("Start it")} label="start"><StartPlan plan={plan.name} /></Section>
            {may("engineer") ? <Section title={t("With another controller")} label="controller"><p class="quiet">{t("A copy of the plan loads it; the copy is started with the same values.")}</p><UseController plan={plan.name} query={query.toString()} /></Section> : null}
          </div>
        ) : null}
      </div>
    </>
  );
}

export function FileText({ path, label }: { path: string; label: string }): JSX.Element {
  const [text, setText] = useState(t("Loading …"));
  useEffect(() => {
    const control = new AbortController();
    getText(path, control.signal).then(setText).catch((error: Error) => { if (!control.signal.aborted) setText(error.message); });
    return () => control.abort();
  }, [path]);
  return <pre tabIndex={0} role="region" aria-label={label}>{text}</pre>;
}
