// A campaign is begun: by a form, or by a text as `hil campaign` takes it, an example or a file of one's own.

import type { JSX } from "preact";
import { post } from "../../api/client.ts";
import type { Campaign, CampaignExample } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { attempt, useData } from "../../data.ts";
import { DraftNotice } from "../../editor/draft-notice.tsx";
import { useDraft } from "../../editor/use-draft.ts";
import { t } from "../../i18n/text.ts";
import { go } from "../../router.ts";
import { LONGEST_FILE, refuseTooLong, TooLong } from "../../ui/too-long.tsx";
import { CampaignForm } from "./form-fields.tsx";
import { campaignText, isWrong, NOTHING, type Chosen, type Property } from "./campaign-form.ts";

const FORM = "form", OWN = "own file";

interface Typed {
  from: string;
  typed: string; // what is not made by the form
  given: string; // as the example had it
  chosen: Chosen; // in the form
  beside: Record<string, string>; // texts of files by their names
}

const START: Typed = { from: FORM, typed: "", given: "", chosen: NOTHING, beside: {} };
const isNothing = (chosen: Chosen): boolean => JSON.stringify(chosen) === JSON.stringify(NOTHING);

export function BeginCampaign(): JSX.Element {
  const examples = useData<CampaignExample[]>("/campaign-examples").data ?? [], schema = useData<Property>("/schemas/campaign").data;
  const draft = useDraft<Typed>("campaign", START, ({ typed, given, chosen }) => typed === given && isNothing(chosen)), { from, chosen, beside } = draft.value;
  const byForm = from === FORM, text = byForm ? (schema ? campaignText(schema, chosen) : "") : draft.value.typed;
  const change = (changed: Partial<Typed>) => draft.set({ ...draft.value, ...changed });
  const choose = (name: string) => {
    const given = examples.find((one) => one.name === name)?.text ?? "";
    change({ from: name, typed: given, given });
  };
  const begin = async (event: Event) => {
    event.preventDefault();
    const campaign = await attempt(() => post<Campaign>("/campaigns", { text, files: from === OWN ? beside : {} }));
    if (!campaign) return;
    draft.saved();
    go(to.campaign(campaign.id));
  };
  return (
    <form class="card" onSubmit={(event) => void begin(event)}>
      <DraftNotice of={draft} />
      <label class="field">{t("Campaign")}
        <select value={from} onChange={(event) => choose(event.currentTarget.value)}>
          <option value={FORM}>{t("by this form")}</option>
          {examples.map((one) => <option key={one.name} value={one.name}>{t("example: {name}", { name: one.title || one.name })}</option>)}
          <option value={OWN}>{t("a file of your own")}</option>
        </select>
      </label>
      {byForm && schema ? <CampaignForm schema={schema} chosen={chosen} onChange={(chosen) => change({ chosen })} /> : null}
      {from === OWN ? <OwnFiles onText={(typed) => change({ typed })} onBeside={(beside) => change({ beside })} /> : null}
      <label class="field">{t("Content")}<textarea rows={byForm ? 6 : 14} spellcheck={false} required ref={refuseTooLong(text, LONGEST_FILE)} readOnly={byForm} value={text} onInput={(event) => change({ typed: event.currentTarget.value })} /></label>
      <TooLong text={text} most={LONGEST_FILE} />
      <button type="submit" class="main" disabled={byForm && schema !== undefined && schema !== null && isWrong(schema, chosen)}>{t("Simulate")}</button>
    </form>
  );
}

function OwnFiles({ onText, onBeside }: { onText: (text: string) => void; onBeside: (files: Record<string, string>) => void }): JSX.Element {
  const read = async (files: FileList | null): Promise<[string, string][]> => Promise.all([...(files ?? [])].map(async (file): Promise<[string, string]> => [file.name, await file.text()]));
  return (
    <div class="row">
      <label class="field">{t("Campaign file")}<input type="file" accept=".yaml,.yml" onChange={(event) => void read(event.currentTarget.files).then((all) => onText(all[0]?.[1] ?? ""))} /></label>
      <label class="field">{t("Files of plan, model and controllers that the service lacks")}<input type="file" accept=".yaml,.yml,.toml" multiple onChange={(event) => void read(event.currentTarget.files).then((all) => onBeside(Object.fromEntries(all)))} /></label>
    </div>
  );
}
