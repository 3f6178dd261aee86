// One campaign: how far it is, and afterwards distributions, what decides, and the worst cars.

import type { ComponentChildren, JSX } from "preact";
import { API } from "../../api/client.ts";
import type { Campaign, CampaignFindings } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { isMissing, useData } from "../../data.ts";
import { percent } from "../../format.ts";
import { English } from "../../i18n/english.tsx";
import { t } from "../../i18n/text.ts";
import { go } from "../../router.ts";
import { Badge, Facts, FileLink, Heading, Loaded, Moment, Section } from "../../ui/parts.tsx";
import { NoneThere } from "../none-there.tsx";
import { CampaignActions, Progress, Shares, stateOf } from "./campaign-parts.tsx";
import { Findings } from "./findings.tsx";

const AGAIN_MS = 1500;
const NAMES: Record<string, string> = { "report.html": t("report"), "report.pdf": t("report as PDF"), "simulations.parquet": t("table (Parquet)"), "campaign.json": t("figures (JSON)") };

export function CampaignView({ id }: { id: number }): JSX.Element {
  const campaign = useData<Campaign>(`/campaigns/${id}`, AGAIN_MS);
  if (isMissing(campaign)) return <NoneThere kind="campaign" name={id} />;
  return <Loaded whole of={campaign} what={t("campaign {number}", { number: id })}>{(found) => <Found campaign={found} />}</Loaded>;
}

function Found({ campaign }: { campaign: Campaign }): JSX.Element {
  const files = campaign.files ?? [], done = files.includes("campaign.json") && files.includes("simulations.parquet");
  const findings = useData<CampaignFindings>(done ? `/campaigns/${campaign.id}/findings` : null);
  const facts: ([string, ComponentChildren] | null)[] = [
    [t("plan"), <a href={to.plan(campaign.plan)}>{campaign.plan}</a>], [t("model"), <a href={to.model(campaign.model)}>{campaign.model}</a>],
    campaign.pass_share_wanted == null ? null : [t("required pass rate"), percent(campaign.pass_share_wanted, 1)],
    [t("asked for by"), campaign.requested_by], [t("asked for"), <Moment at={campaign.asked_at} />],
    campaign.ended_at ? [t("ended"), <Moment at={campaign.ended_at} />] : null, campaign.reason ? [t("reason"), <English>{campaign.reason}</English>] : null, campaign.place ? [t("on service"), campaign.place] : null,
  ];
  return (
    <>
      <Heading kind={<a href={to.list("campaigns")}>{t("Campaign {number}", { number: campaign.id })}</a>}>{campaign.title || campaign.name} <Badge kind={stateOf(campaign)} /></Heading>
      <Facts>{facts.filter((one) => one !== null)}</Facts>
      <div class="row"><CampaignActions campaign={campaign} onRemoved={() => go(to.list("campaigns"))} /></div>
      <Section title={t("Simulated")} label="progress"><Progress of={campaign} /></Section>
      <Section title={t("Share that passes")} label="shares"><Shares of={campaign} /></Section>
      {done ? <Loaded of={findings} what={t("distributions")}>{(found) => <Findings of={found} campaign={campaign} />}</Loaded> : null}
      {files.length ? <Section title={t("Files")} label="files"><p class="links">{files.map((name) => <FileLink key={name} name={name} href={`${API}/campaigns/${campaign.id}/files/${encodeURIComponent(name)}`}>{NAMES[name] ?? name}</FileLink>)}</p></Section> : null}
    </>
  );
}
