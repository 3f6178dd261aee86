// Controls of a campaign's form: texts and numbers as the schema has them; plans, models and controllers from the service.

import type { JSX } from "preact";
import type { Bench, Controller, Model, Plan } from "../../api/types.ts";
import { useData } from "../../data.ts";
import { English } from "../../i18n/english.tsx";
import { t } from "../../i18n/text.ts";
import { NumberInput } from "../../ui/number-field.tsx";
import { inWords } from "../../ui/parts.tsx";
import { boundsOf, COUNT, isNumber, plainKeys, whyNoName, whyNotVaried, type Chosen, type Property, type Varied } from "./campaign-form.ts";

interface Options {
  schema: Property;
  chosen: Chosen;
  onChange: (chosen: Chosen) => void;
}

export function CampaignForm({ schema, chosen, onChange }: Options): JSX.Element {
  const offered = useOffered();
  const setPlain = (name: string, text: string) => onChange({ ...chosen, plain: { ...chosen.plain, [name]: text } });
  const setList = (name: string, all: string[]) => onChange({ ...chosen, lists: { ...chosen.lists, [name]: all } });
  const drawn = Number(chosen.plain["draws"] ?? 0) > 0;
  return (
    <>
      <div class="fields">
        {plainKeys(schema).map((name) => (
          <Plain key={name} name={name} property={schema.properties?.[name] ?? {}} value={chosen.plain[name] ?? ""} offered={offered.plain[name]} required={name === "name" || name === "plan"} onChange={(text) => setPlain(name, text)} />
        ))}
        <label class="field">{t("Criteria that count, all if none")}<input value={(chosen.lists["criteria"] ?? []).join(", ")} placeholder="phase_0kmh.peak_shaft_torque" autocomplete="off" onChange={(event) => setList("criteria", event.currentTarget.value.split(",").map((one) => one.trim()).filter(Boolean))} /></label>
      </div>
      <Ticks legend={t("Controllers to compare; the plan's own if none")} all={offered.controllers} chosen={chosen.lists["controllers"] ?? []} onChange={(all) => setList("controllers", all)} />
      <Tolerance of={schema.properties?.["tolerance"] ?? {}} chosen={chosen.tolerance} drawn={drawn} onChange={(tolerance) => onChange({ ...chosen, tolerance })} />
      <Vary rows={chosen.vary} onChange={(vary) => onChange({ ...chosen, vary })} />
    </>
  );
}

interface Offered {
  plain: Record<string, string[]>;
  controllers: string[];
}

// Files that were given to the service have their endings, built-in ones are called by their names.
function useOffered(): Offered {
  const plans = useData<Plan[]>("/plans").data ?? [], models = useData<Model[]>("/models").data ?? [], controllers = useData<Controller[]>("/controllers").data ?? [];
  const benches = (useData<Bench[]>("/benches").data ?? []).filter((one) => one.simulated).map((one) => one.name);
  const names = controllers.map((one) => one.name);
  return {
    plain: {
      plan: plans.map((one) => (one.built_in ? one.name : `${one.name}.yaml`)), bench: [...new Set(["sim", ...benches])],
      model: models.filter((one) => one.kind !== "transfer_function").map((one) => `${one.name}.toml`), controller: names,
    },
    controllers: names,
  };
}

const FIELDS: Record<string, string> = {
  name: t("Name"), title: t("Title"), description: t("Description"), plan: t("Plan"), bench: t("Bench"), model: t("Model"), controller: t("Controller"), draws: t("Draws"), seed: t("Seed"), pass_share: t("Pass share"),
};

function Plain({ name, property, value, offered, required, onChange }: { name: string; property: Property; value: string; offered: string[] | undefined; required: boolean; onChange: (text: string) => void }): JSX.Element {
  const usual = property.default === undefined || property.default === null || property.default === "" ? "" : String(property.default), bounds = boundsOf(property);
  const about = `about-${name}`, described = property.description && !offered ? { "aria-describedby": about } : {};
  const take = (event: { currentTarget: HTMLInputElement | HTMLSelectElement }) => onChange(event.currentTarget.value);
  const refused = name === "name" ? whyNoName(value) : "";
  return (
    <div><label class="field">{FIELDS[name] ?? inWords(name).replace(/^./, (letter) => letter.toUpperCase())}
      {offered
        ? <select value={value} required={required} onChange={take}><option value="">{usual || (required ? t("choose …") : t("the usual one"))}</option>{offered.map((one) => <option key={one}>{one}</option>)}</select>
        : isNumber(property)
          ? <NumberInput {...(property.description ? { describedBy: about } : {})} {...bounds} placeholder={usual} value={value} onText={onChange} />
          : <input required={required} {...described} aria-invalid={refused !== ""} placeholder={usual} autocomplete="off" value={value} onInput={take} />}
      </label>{refused ? <span class="bad small refused" role="alert">{refused}</span> : null}{property.description && !offered ? <span class="reason" id={about}><English>{property.description}</English></span> : null}
    </div>
  );
}

function Ticks({ legend, all, chosen, onChange }: { legend: string; all: string[]; chosen: string[]; onChange: (all: string[]) => void }): JSX.Element {
  return (
    <fieldset class="ticks"><legend>{legend}</legend>
      <div class="fields">{all.map((one) => <label class="tick" key={one}><input type="checkbox" checked={chosen.includes(one)} onChange={(event) => onChange(event.currentTarget.checked ? [...chosen, one] : chosen.filter((other) => other !== one))} />{one}</label>)}</div>
    </fieldset>
  );
}

function Tolerance({ of, chosen, drawn, onChange }: { of: Property; chosen: Record<string, string>; drawn: boolean; onChange: (chosen: Record<string, string>) => void }): JSX.Element {
  const set = (name: string, text: string) => onChange({ ...chosen, [name]: text });
  return (
    <details>
      <summary>{drawn ? t("What differs from car to car") : t("What differs from car to car (with draws)")}</summary>
      <div class="fields">
        {Object.entries(of.properties ?? {}).map(([name, property]) => (
          <label class={property.type === "boolean" ? "tick" : "field"} key={name}>
            {property.type === "boolean"
              ? <><input type="checkbox" checked={chosen[name] === "true"} onChange={(event) => set(name, String(event.currentTarget.checked))} /><English>{inWords(name)}</English></>
              : <><English>{`${inWords(name)}${property.description ? `, ${property.description}` : ""}`}</English><NumberInput {...boundsOf(property)} value={chosen[name] ?? ""} onText={(text) => set(name, text)} /></>}
          </label>
        ))}
      </div>
    </details>
  );
}

const EMPTY: Varied = { name: "", from: "", to: "", count: "" };

function Vary({ rows, onChange }: { rows: Varied[]; onChange: (rows: Varied[]) => void }): JSX.Element {
  const set = (at: number, changed: Partial<Varied>) => onChange(rows.map((one, number) => (number === at ? { ...one, ...changed } : one)));
  return (
    <details>
      <summary>{t("Values that are tried one after the other")}</summary>
      {rows.map((row, at) => (
        <div class="row" key={at}>
          <label class="field">{t("Name")}<input placeholder="model.vehicle_inertia" autocomplete="off" aria-invalid={whyNotVaried(row.name) !== ""} title="controller.NAME, model.NAME, effect.ID.NAME, plan.NAME" value={row.name} onInput={(event) => set(at, { name: event.currentTarget.value })} />{whyNotVaried(row.name) ? <span class="bad small refused" role="alert">{whyNotVaried(row.name)}</span> : null}</label>
          <label class="field">{t("from")}<NumberInput value={row.from} onText={(from) => set(at, { from })} /></label>
          <label class="field">{t("to")}<NumberInput value={row.to} onText={(to) => set(at, { to })} /></label>
          <label class="field">{t("in so many values")}<NumberInput {...COUNT} value={row.count} onText={(count) => set(at, { count })} /></label>
          <button type="button" class="plain" onClick={() => onChange(rows.filter((_, number) => number !== at))}>{t("Leave out")}</button>
        </div>
      ))}
      <div class="row"><button type="button" onClick={() => onChange([...rows, EMPTY])}>{t("Vary a value")}</button></div>
    </details>
  );
}
