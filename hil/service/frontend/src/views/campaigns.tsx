// Campaigns: many simulations of a plan, how many are done, and which share of them passes so far.

import type { JSX } from "preact";
import { API, ask, post } from "../api/client.ts";
import type { Campaign } from "../api/types.ts";
import { to } from "../addresses.ts";
import { attempt, useData } from "../data.ts";
import { duration, percent, whole } from "../format.ts";
import { go } from "../router.ts";
import { useMay } from "../session.ts";
import { Badge, Facts, Heading, Loaded, Moment, Scroll, Section } from "../ui/parts.tsx";
import { FormerPage } from "./former-page.tsx";

const AGAIN_MS = 2000;
const OVER = ["ended", "failed", "cancelled"];
const stateOf = (one: Campaign): string => (one.passed == null ? one.state : one.passed ? "pass" : "fail");

export function Campaigns(): JSX.Element {
  const campaigns = useData<Campaign[]>("/campaigns", AGAIN_MS);
  return (
    <>
      <Heading>Campaigns</Heading>
      <FormerPage what="Begin a campaign" role="engineer" />
      <Loaded of={campaigns} what="campaigns">
        {(all) => all.length ? (
          <Scroll label="Campaigns"><table>
            <thead><tr><th scope="col" class="number">number</th><th scope="col">campaign</th><th scope="col">state</th><th scope="col">progress</th><th scope="col">passes</th></tr></thead>
            <tbody>{all.map((one) => <tr key={one.id}><td class="number"><a href={to.campaign(one.id)}>{one.id}</a></td><th scope="row">{one.title || one.name}<span class="reason">{`${one.plan} on ${one.model}, by ${one.requested_by}`}</span></th><td><Badge kind={stateOf(one)} /></td><td><Progress of={one} /></td><td><Shares of={one} /></td></tr>)}</tbody>
          </table></Scroll>
        ) : <p class="quiet">None yet.</p>}
      </Loaded>
    </>
  );
}

export function CampaignView({ id }: { id: number }): JSX.Element {
  const campaign = useData<Campaign>(`/campaigns/${id}`, AGAIN_MS);
  return <Loaded of={campaign} what={`campaign ${id}`}>{(found) => <Found campaign={found} />}</Loaded>;
}

function Found({ campaign }: { campaign: Campaign }): JSX.Element {
  const may = useMay(), isOver = OVER.includes(campaign.state), files = campaign.files ?? [];
  const remove = async () => {
    if (!confirm(`Remove campaign ${campaign.id} with its files?`)) return;
    if (await attempt(async () => { await ask("DELETE", `/campaigns/${campaign.id}`); return true; })) go(to.list("campaigns"));
  };
  return (
    <>
      <Heading kind={`Campaign ${campaign.id}`}>{campaign.title || campaign.name} <Badge kind={stateOf(campaign)} /></Heading>
      <Facts>
        {([["plan", <a href={to.plan(campaign.plan)}>{campaign.plan}</a>], ["model", campaign.model], ["asked for by", campaign.requested_by], ["asked for", <Moment at={campaign.asked_at} />], campaign.ended_at ? ["ended", <Moment at={campaign.ended_at} />] : null, campaign.reason ? ["reason", campaign.reason] : null, campaign.place ? ["at", campaign.place] : null] as ([string, JSX.Element] | null)[]).filter((one) => one !== null)}
      </Facts>
      <Section title="Progress" label="progress"><Progress of={campaign} /></Section>
      <Section title="Share that passes" label="shares"><Shares of={campaign} /></Section>
      {files.length ? <Section title="Files" label="files"><p class="links">{files.map((name) => <a key={name} href={`${API}/campaigns/${campaign.id}/files/${encodeURIComponent(name)}`} target="_blank" rel="noopener">{name}</a>)}</p></Section> : null}
      {may("engineer") && !campaign.place ? (
        <div class="row">
          {!isOver ? <button type="button" onClick={() => void attempt(() => post(`/campaigns/${campaign.id}/cancel`))}>{campaign.state === "stopping" ? "End now" : "Cancel"}</button> : null}
          {isOver && campaign.state !== "ended" ? <button type="button" onClick={() => void attempt(() => post(`/campaigns/${campaign.id}/resume`))}>Resume</button> : null}
          {isOver ? <button type="button" onClick={() => void remove()}>Remove</button> : null}
        </div>
      ) : null}
    </>
  );
}

function Progress({ of: { id, state, done, simulations, rate_hz: rate } }: { of: Campaign }): JSX.Element {
  const left = state === "running" && rate > 0 ? `, ${duration((simulations - done) / rate)} left` : "";
  return (
    <>
      {OVER.includes(state) && done === simulations ? null : <progress max={simulations} value={done} aria-label={`Progress of campaign ${id}`} />}
      <span class="quiet">{`${whole(done)} of ${whole(simulations)}${left}`}</span>
    </>
  );
}

function Shares({ of: { controllers } }: { of: Campaign }): JSX.Element {
  if (!controllers.length) return <span class="quiet">–</span>;
  return (
    <>
      {controllers.map(({ controller, passed, of, share, interval }) => (
        <p key={controller}>{`${controller ? `${controller.replaceAll("_", " ")}: ` : ""}${share === null ? "–" : percent(share, 1)} (${passed} of ${of}${interval ? `; ${percent(interval[0], 1)} to ${percent(interval[1], 1)}` : ""})`}</p>
      ))}
    </>
  );
}
