// Settings: language and colours of this browser; of the service its state, agents, and the tokens that let people in.

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { ask, post } from "../api/client.ts";
import { ROLES, type Agent, type Health, type KeptApart, type TokenData, type TokenMade } from "../api/types.ts";
import { attempt, useData } from "../data.ts";
import { duration } from "../format.ts";
import { English } from "../i18n/english.tsx";
import { chooseLanguage, chosenLanguage, LANGUAGES, type Language } from "../i18n/language.ts";
import { t, tx } from "../i18n/text.ts";
import { agreed } from "../question.ts";
import { useMay, useMe } from "../session.ts";
import { NumberInput } from "../ui/number-field.tsx";
import { useStore } from "../store.ts";
import { chooseTheme, theme, THEME_NAMES, THEMES } from "../theme.ts";
import { People } from "./team/people.tsx";
import { kindInWords } from "../ui/kinds.ts";
import { Facts, Heading, Loaded, Moment, Scroll, Section } from "../ui/parts.tsx";
import { LimitedField } from "../ui/too-long.tsx";

export function Settings(): JSX.Element {
  const may = useMay(), me = useMe();
  return (
    <>
      <Heading>{t("Settings")}</Heading>
      <Section title={t("Language")} label="language"><Languages /></Section>
      <Section title={t("Colours")} label="colours"><Colours /></Section>
      <Section title={t("Service")} label="service"><ServiceState /></Section>
      <Section title={t("Agents")} label="agents"><Agents /></Section>
      {may("admin") ? <People /> : null}
      {may("admin") && me.tokens ? <Section title={t("Tokens")} label="tokens"><Tokens /></Section> : null}
      {may("admin") && !me.tokens ? <p class="quiet">{tx("This service asks for no tokens. The first one is made on its machine: {command}", { command: <code>hil serve --data DIR --add-token NAME=admin</code> })}</p> : null}
    </>
  );
}

function Languages(): JSX.Element {
  return (
    <label>
      <span class="hidden">{t("Language")}</span>
      <select value={chosenLanguage} onChange={(event) => chooseLanguage(event.currentTarget.value as Language | "")}>
        <option value="">{t("as the browser")}</option>
        {Object.entries(LANGUAGES).map(([tag, name]) => <option key={tag} value={tag} lang={tag}>{name}</option>)}
      </select>
    </label>
  );
}

function Colours(): JSX.Element {
  const chosen = useStore(theme);
  return (
    <fieldset class="row plainly"><legend class="hidden">{t("Colours")}</legend>
      {THEMES.map((one) => <label key={one}><input type="radio" name="theme" checked={one === chosen} onChange={() => chooseTheme(one)} /> {THEME_NAMES[one]}</label>)}
    </fieldset>
  );
}

function ServiceState(): JSX.Element {
  const health = useData<Health>("/health", 10_000), apart = useData<KeptApart[]>("/kept-apart").data ?? [];
  return (
    <Loaded of={health} what={t("the service's state")}>
      {(found) => (
        <>
          <Facts>
            {[
              [t("version"), found.version], [t("up for"), duration(found.up_s)],
              [t("audit log"), found.audit_problem ? <span class="bad"><English>{found.audit_problem}</English></span> : t("unchanged")],
              [t("store"), found.store_problem ? <span class="bad"><English>{found.store_problem}</English></span> : t("waiting for it: {runs} runs, {results} results", { runs: found.runs_not_stored ?? 0, results: found.results_not_stored ?? 0 })],
              [t("stop post"), found.stop_url ? <code>{found.stop_url}</code> : <span class="bad">{t("not available")}</span>],
            ]}
          </Facts>
          {apart.map((one) => <p key={one.file} class="bad">{tx("{name} is kept apart: {why}", { name: `${kindInWords(one.kind)} ${one.name}`, why: <><English>{one.why}</English>{". "}<English>{one.fix}</English></> })}</p>)}
        </>
      )}
    </Loaded>
  );
}

function Agents(): JSX.Element {
  const agents = useData<Agent[]>("/agents", 5000);
  return (
    <Loaded of={agents} what={t("agents")}>
      {(all) => all.length
        ? <Scroll label={t("Agents")}><table><tbody>{all.map((one) => <tr key={`${one.name} ${one.machine}`}><th scope="row">{one.name}</th><td>{one.machine}</td><td>{one.version}</td><td>{one.connected ? t("connected") : t("away")}</td></tr>)}</tbody></table></Scroll>
        : <p class="quiet">{t("No agent has registered.")}</p>}
    </Loaded>
  );
}

const LONGEST_NAME = 100;

function Tokens(): JSX.Element {
  const tokens = useData<TokenData[]>("/tokens");
  const [made, setMade] = useState<TokenMade | null>(null);
  const [name, setName] = useState(""), [role, setRole] = useState("operator"), [days, setDays] = useState("365");
  const make = async (event: Event) => {
    event.preventDefault();
    setMade(await attempt(() => post<TokenMade>("/tokens", { name, role, for_days: Number(days) })));
    tokens.again();
  };
  const revoke = async (token: TokenData) => {
    if (!(await agreed(t("Revoke the token of {name}?", { name: token.name }), t("Revoke"), t("Cancel")))) return;
    await attempt(() => ask("DELETE", `/tokens/${token.id}`));
    tokens.again();
  };
  return (
    <>
      <form class="row" onSubmit={(event) => void make(event)}>
        <LimitedField label={t("Name")} most={LONGEST_NAME} required value={name} onText={setName} />
        <label class="field">{t("Role")}<select value={role} onChange={(event) => setRole(event.currentTarget.value)}>{[...ROLES, "agent"].map((one) => <option key={one} value={one}>{kindInWords(one)}</option>)}</select></label>
        <label class="field">{t("Days")}<NumberInput min={1} max={3650} whole required value={days} onText={setDays} /></label>
        <button type="submit" class="main">{t("Make a token")}</button>
      </form>
      {made ? <p class="message" role="status">{tx("The token of {name}, shown this once: {secret}", { name: made.token.name, secret: <code>{made.secret}</code> })}</p> : null}
      <Loaded of={tokens} what={t("tokens")}>
        {(all) => (
          <Scroll label={t("Tokens")}><table>
            <thead><tr><th scope="col">{t("name")}</th><th scope="col">{t("role")}</th><th scope="col">{t("made")}</th><th scope="col">{t("valid until")}</th><th scope="col"><span class="hidden">{t("actions")}</span></th></tr></thead>
            <tbody>{all.map((one) => <tr key={one.id}><th scope="row">{one.name}</th><td>{kindInWords(one.role)}</td><td><Moment at={one.made_at} /></td><td>{one.revoked_at ? tx("revoked {moment}", { moment: <Moment at={one.revoked_at} /> }) : <Moment at={one.expires_at} />}</td><td>{one.revoked_at ? null : <button type="button" aria-label={t("Revoke the token of {name}", { name: one.name })} onClick={() => void revoke(one)}>{t("Revoke")}</button>}</td></tr>)}</tbody>
          </table></Scroll>
        )}
      </Loaded>
    </>
  );
}
