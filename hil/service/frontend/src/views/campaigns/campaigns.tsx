// Campaigns: many simulations of a plan, begun here, how far each is, and which share of them passes so far.

import type { JSX } from "preact";
import type { Campaign } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { useData } from "../../data.ts";
import { t } from "../../i18n/text.ts";
import { useMay } from "../../session.ts";
import { Badge, Heading, Loaded, Scroll, Section } from "../../ui/parts.tsx";
import { BeginCampaign } from "./begin-campaign.tsx";
import { CampaignActions, Progress, Shares, stateOf } from "./campaign-parts.tsx";

const AGAIN_MS = 1500;

export function Campaigns(): JSX.Element {
  const campaigns = useData<Campaign[]>("/campaigns", AGAIN_MS), may = useMay();
  return (
    <>
      <Heading>{t("Campaigns")}</Heading>
      <Loaded of={campaigns} what={t("campaigns")}>
        {(all) => all.length ? (
          <Scroll label={t("Campaigns")}><table class="campaigns">
            <thead><tr><th scope="col" class="number">{t("number")}</th><th scope="col">{t("campaign")}</th><th scope="col">{t("state")}</th><th scope="col">{t("simulated")}</th><th scope="col">{t("passes")}</th>{may("engineer") ? <th scope="col"><span class="hidden">{t("actions")}</span></th> : null}</tr></thead>
            <tbody>{all.map((one) => <Row key={one.id} campaign={one} onRemoved={campaigns.again} />)}</tbody>
          </table></Scroll>
        ) : <p class="quiet">{t("There is no campaign yet.")}</p>}
      </Loaded>
      {may("engineer") ? <Section title={t("Simulate a plan on many cars")} label="begin"><BeginCampaign /></Section> : null}
    </>
  );
}

function Row({ campaign, onRemoved }: { campaign: Campaign; onRemoved: () => void }): JSX.Element {
  const about = [t("{plan} on {model}, by {person}", { plan: campaign.plan, model: campaign.model, person: campaign.requested_by }), campaign.place, campaign.reason?.split("\n")[0]].filter(Boolean).join("; ");
  return (
    <tr>
      <td class="number"><a href={to.campaign(campaign.id)}>{campaign.id}</a></td>
      <th scope="row">{campaign.title || campaign.name}<span class="reason">{about}</span></th>
      <td><Badge kind={stateOf(campaign)} /></td><td><Progress of={campaign} /></td><td><Shares of={campaign} /></td>
      <td><CampaignActions campaign={campaign} onRemoved={onRemoved} /></td>
    </tr>
  );
}
