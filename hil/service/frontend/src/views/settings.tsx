// Settings: colours of this browser; of the service its state, agents, and the tokens that let people in.

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { ask, post } from "../api/client.ts";
import { ROLES, type Agent, type Health, type KeptApart, type TokenData, type TokenMade } from "../api/types.ts";
import { attempt, useData } from "../data.ts";
import { duration } from "../format.ts";
import { useMay, useMe } from "../session.ts";
import { useStore } from "../store.ts";
import { chooseTheme, theme, THEMES } from "../theme.ts";
import { People } from "./team/people.tsx";
import { Facts, Heading, Loaded, Moment, Scroll, Section } from "../ui/parts.tsx";

export function Settings(): JSX.Element {
  const may = useMay(), me = useMe();
  return (
    <>
      <Heading>Settings</Heading>
      <Section title="Colours" label="colours"><Colours /></Section>
      <Section title="Service" label="service"><ServiceState /></Section>
      <Section title="Agents" label="agents"><Agents /></Section>
      {may("admin") ? <People /> : null}
      {may("admin") && me.tokens ? <Section title="Tokens" label="tokens"><Tokens /></Section> : null}
      {may("admin") && !me.tokens ? <p class="quiet">This service asks for no tokens. The first one is made on its machine: <code>hil serve --add-token NAME=admin</code></p> : null}
    </>
  );
}

function Colours(): JSX.Element {
  const chosen = useStore(theme);
  return (
    <fieldset class="row plainly"><legend class="hidden">Colours</legend>
      {THEMES.map((one) => <label key={one}><input type="radio" name="theme" checked={one === chosen} onChange={() => chooseTheme(one)} /> {one === "system" ? "as the system" : one}</label>)}
    </fieldset>
  );
}

function ServiceState(): JSX.Element {
  const health = useData<Health>("/health", 10_000), apart = useData<KeptApart[]>("/kept-apart").data ?? [];
  return (
    <Loaded of={health} what="the service's state">
      {(found) => (
        <>
          <Facts>
            {[
              ["version", found.version], ["up for", duration(found.up_s)],
              ["audit log", found.audit_problem ? <span class="bad">{found.audit_problem}</span> : "unchanged"],
              ["store", found.store_problem ? <span class="bad">{found.store_problem}</span> : `${found.runs_not_stored ?? 0} runs and ${found.results_not_stored ?? 0} results wait for it`],
              ["stop post", found.stop_url ? <code>{found.stop_url}</code> : <span class="bad">not available</span>],
            ]}
          </Facts>
          {apart.map((one) => <p key={one.file} class="bad">{`${one.kind} ${one.name} is kept apart: ${one.why}. ${one.fix}`}</p>)}
        </>
      )}
    </Loaded>
  );
}

function Agents(): JSX.Element {
  const agents = useData<Agent[]>("/agents", 5000);
  return (
    <Loaded of={agents} what="agents">
      {(all) => all.length
        ? <Scroll label="Agents"><table><tbody>{all.map((one) => <tr key={`${one.name} ${one.machine}`}><th scope="row">{one.name}</th><td>{one.machine}</td><td>{one.version}</td><td>{one.connected ? "connected" : "away"}</td></tr>)}</tbody></table></Scroll>
        : <p class="quiet">No agent has registered.</p>}
    </Loaded>
  );
}

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
    if (!confirm(`Revoke the token of ${token.name}?`)) return;
    await attempt(() => ask("DELETE", `/tokens/${token.id}`));
    tokens.again();
  };
  return (
    <>
      <form class="row" onSubmit={(event) => void make(event)}>
        <label class="field">Name<input required maxLength={100} value={name} onInput={(event) => setName(event.currentTarget.value)} /></label>
        <label class="field">Role<select value={role} onChange={(event) => setRole(event.currentTarget.value)}>{[...ROLES, "agent"].map((one) => <option key={one}>{one}</option>)}</select></label>
        <label class="field">Days<input type="number" min={1} max={3650} required value={days} onInput={(event) => setDays(event.currentTarget.value)} /></label>
        <button type="submit" class="main">Make a token</button>
      </form>
      {made ? <p class="message" role="status">{`The token of ${made.token.name}, shown this once: `}<code>{made.secret}</code></p> : null}
      <Loaded of={tokens} what="tokens">
        {(all) => (
          <Scroll label="Tokens"><table>
            <thead><tr><th scope="col">name</th><th scope="col">role</th><th scope="col">made</th><th scope="col">valid until</th><th scope="col"><span class="hidden">actions</span></th></tr></thead>
            <tbody>{all.map((one) => <tr key={one.id}><th scope="row">{one.name}</th><td>{one.role}</td><td><Moment at={one.made_at} /></td><td>{one.revoked_at ? <>revoked <Moment at={one.revoked_at} /></> : <Moment at={one.expires_at} />}</td><td>{one.revoked_at ? null : <button type="button" aria-label={`Revoke the token of ${one.name}`} onClick={() => void revoke(one)}>Revoke</button>}</td></tr>)}</tbody>
          </table></Scroll>
        )}
      </Loaded>
    </>
  );
}
