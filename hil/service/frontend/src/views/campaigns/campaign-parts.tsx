// What the list of campaigns and the view of one have in common: state, progress, shares with their intervals.

import type { JSX } from "preact";
import { ask, post } from "../../api/client.ts";
import type { Campaign } from "../../api/types.ts";
import { attempt } from "../../data.ts";
import { duration, fixed, percent, whole } from "../../format.ts";
import { t } from "../../i18n/text.ts";
import { agreed } from "../../question.ts";
import { useMay } from "../../session.ts";
import { inWords } from "../../ui/parts.tsx";

export const OVER = ["ended", "failed", "cancelled"];
export const stateOf = (one: Campaign): string => (one.passed == null ? one.state : one.passed ? "pass" : "fail");

export function Progress({ of: { id, state, done, simulations, rate_hz: rate } }: { of: Campaign }): JSX.Element {
  const so = { done: whole(done), all: whole(simulations) };
  const text = state === "running" && rate > 0 ? t("{done} of {all}, {rate} a second, {time} left", { ...so, rate: fixed(rate, 1), time: duration((simulations - done) / rate) }) : t("{done} of {all}", so);
  return (
    <>
      {OVER.includes(state) && done === simulations ? null : <progress max={simulations} value={done} aria-label={t("Progress of campaign {number}", { number: id })} />}
      <span class="quiet">{text}</span>
    </>
  );
}

function shareText(share: number | null, passed: number, all: number, interval: readonly (number | null)[] | null): string {
  const so = { share: share === null ? "–" : percent(share, 1), passed, all };
  return interval ? t("{share} ({passed} of {all}; {low} to {high})", { ...so, low: percent(interval[0] ?? 0, 1), high: percent(interval[1] ?? 0, 1) }) : t("{share} ({passed} of {all})", so);
}

// The band is the interval, the line in it the share that passed.
export function Shares({ of: { controllers } }: { of: Campaign }): JSX.Element {
  if (!controllers.length) return <span class="quiet">–</span>;
  return (
    <>
      {controllers.map(({ controller, passed, of, share, interval }) => {
        const [low, high] = interval ?? [share ?? 0, share ?? 0];
        return (
          <div key={controller} class="shared">{[controller ? inWords(controller) : "", shareText(share, passed, of, interval)].filter(Boolean).join(": ")}
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
    if (!(await agreed(t("Remove campaign {number} with its files?", { number: campaign.id }), t("Remove"), t("Cancel")))) return;
    if (await attempt(async () => { await ask("DELETE", path); return true; })) onRemoved();
  };
  const button = (text: string, work: () => void) => <button type="button" aria-label={t("{action}: campaign {number}", { action: text, number: campaign.id })} onClick={work}>{text}</button>;
  return (
    <span class="buttons">
      {isOver ? null : button(campaign.state === "stopping" ? t("End now") : t("Cancel"), () => void attempt(() => post(`${path}/cancel`)))}
      {isOver && campaign.state !== "ended" ? button(t("Resume"), () => void attempt(() => post(`${path}/resume`))) : null}
      {isOver ? button(t("Remove"), () => void remove()) : null}
    </span>
  );
}
