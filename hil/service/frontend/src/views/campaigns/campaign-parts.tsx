// What the list of campaigns and the view of one have in common: state, progress, shares with their intervals.

import type { JSX } from "preact";
import { ask, post } from "../../api/client.ts";
import type { Campaign } from "../../api/types.ts";
import { attempt } from "../../data.ts";
import { duration, fixed, percent, whole } from "../../format.ts";
import { useMay } from "../../session.ts";
import { inWords } from "../../ui/parts.tsx";

export const OVER = ["ended", "failed", "cancelled"];
export const stateOf = (one: Campaign): string => (one.passed == null ? one.state : one.passed ? "pass" : "fail");

export function Progress({ of: { id, state, done, simulations, rate_hz: rate } }: { of: Campaign }): JSX.Element {
  const left = state === "running" && rate > 0 ? `, ${fixed(rate, 1)} a second, ${duration((simulations - done) / rate)} left` : "";
  return (
    <>
      {OVER.includes(state) && done === simulations ? null : <progress max={simulations} value={done} aria-label={`Progress of campaign ${id}`} />}
      <span class="quiet">{`${whole(done)} of ${whole(simulations)}${left}`}</span>
    </>
  );
}

// The band is the interval, the line in it the share that passed.
export function Shares({ of: { controllers } }: { of: Campaign }): JSX.Element {
  if (!controllers.length) return <span class="quiet">–</span>;
  return (
    <>
      {controllers.map(({ controller, passed, of, share, interval }) => {
        const [low, high] = interval ?? [share ?? 0, share ?? 0];
        return (
          <div key={controller} class="shared">{`${controller ? `${inWords(controller)}: ` : ""}${share === null ? "–" : percent(share, 1)} (${passed} of ${of}${interval ? `; ${percent(interval[0], 1)} to ${percent(interval[1], 1)}` : ""})`}
            {share === null ? null : <span class="share" style={{ "--low": `${100 * low}%`, "--wide": `${100 * (high - low)}%`, "--share": `${100 * share}%` }} />}
          </div>
        );
      })}
    </>
  );
}

export function CampaignActions({ campaign, onRemoved }: { campaign: Campaign; onRemoved: () => void }): JSX.Element | null {
  const may = useMay(), isOver = OVER.includes(campaign.state), path = `/campaigns/${campaign.id}`;
  if (!may("engineer") || campaign.place) return null;
  const remove = async () => {
    if (!confirm(`Remove campaign ${campaign.id} with its files?`)) return;
    if (await attempt(async () => { await ask("DELETE", path); return true; })) onRemoved();
  };
  const button = (text: string, work: () => void) => <button type="button" aria-label={`${text}: campaign ${campaign.id}`} onClick={work}>{text}</button>;
  return (
    <span class="buttons">
      {isOver ? null : button(campaign.state === "stopping" ? "End now" : "Cancel", () => void attempt(() => post(`${path}/cancel`)))}
      {isOver && campaign.state !== "ended" ? button("Resume", () => void attempt(() => post(`${path}/resume`))) : null}
      {isOver ? button("Remove", () => void remove()) : null}
    </span>
  );
}
