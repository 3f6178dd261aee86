// A draft becomes a controller: designed on all plants that the model's uncertainty allows, then kept or downloaded.

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { ask, post } from "../../api/client.ts";
import type { DesignData } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { attempt } from "../../data.ts";
import { download } from "../../download.ts";
import { figure, percent } from "../../format.ts";
import { English } from "../../i18n/english.tsx";
import { t, tx } from "../../i18n/text.ts";
import { NameField } from "../../ui/name-field.tsx";

export function SaveController({ body, onSaved }: { body: object | null; onSaved: (name: string) => void }): JSX.Element {
  const [name, setName] = useState(""), [busy, setBusy] = useState(false), [saved, setSaved] = useState("");
  const [found, setFound] = useState<DesignData | null>(null);
  const designed = async (): Promise<DesignData> => {
    setFound(null);
    setSaved("");
    const design = await post<DesignData>("/designs", { ...body, ...(name ? { name } : {}) });
    setFound(design);
    return design;
  };
  const work = async (keep: boolean) => {
    setBusy(true);
    await attempt(async () => {
      const { controller } = await designed();
      if (!keep) { download("controller.toml", controller, "application/toml"); return; }
      await ask("PUT", `/controllers/${name}`, controller);
      setSaved(name);
      onSaved(name);
    });
    setBusy(false);
  };
  return (
    <>
      <form class="row" onSubmit={(event) => { event.preventDefault(); void work(true); }}>
        <NameField value={name} onChange={setName} />
        <button type="submit" class="main" disabled={!body || busy}>{t("Save the controller")}</button>
        <button type="button" disabled={!body || busy} onClick={() => void work(false)}>{t("Download controller.toml")}</button>
      </form>
      <div aria-live="polite">
        {busy ? <p class="quiet">{t("Designing: every plant that the uncertainty allows …")}</p> : null}
        {saved ? <p class="good">{tx("Saved as {link}; plans can load it.", { link: <a href={to.controller(saved)}>{saved}</a> })}</p> : null}
        {found ? <p class="quiet">{tx("The worst of {plants} has |S| {peak}; {share} are stable.", { plants: <English>{found.source}</English>, peak: figure(found.worst_sensitivity_peak), share: percent(found.stable_share) })}</p> : null}
        {found?.warnings.map((text) => <p class="bad" key={text}><English>{text}</English></p>)}
      </div>
    </>
  );
}
