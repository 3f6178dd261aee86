// A model that a study has left becomes one of the service, under a name.

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { ask } from "../../api/client.ts";
import type { Study } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { attempt } from "../../data.ts";
import { t, tx } from "../../i18n/text.ts";
import { useMay } from "../../session.ts";
import { linkTo, Section } from "../../ui/parts.tsx";
import { NameField } from "../../ui/name-field.tsx";
import { textOf } from "./study-parts.tsx";

export function KeepModel({ study, file, what }: { study: Study; file: string; what: string }): JSX.Element | null {
  const may = useMay();
  const [name, setName] = useState(""), [saved, setSaved] = useState("");
  if (!may("engineer") || !(study.files ?? []).includes(file)) return null;
  const keep = async (event: Event) => {
    event.preventDefault();
    if (await attempt(async () => { await ask("PUT", `/models/${name}`, await textOf(study, file)); return true; })) setSaved(name);
  };
  return (
    <Section title={t("Keep the {what}", { what })} label="keep">
      <form class="row" onSubmit={(event) => void keep(event)}><NameField value={name} onChange={setName} /><button type="submit" class="main">{t("Save the {what}", { what })}</button><span class="quiet">{file}</span></form>
      <p aria-live="polite">{saved ? tx("Saved as {link}: for <design>design</design> and diagnosis.", { link: <a href={to.model(saved)}>{saved}</a>, design: linkTo(`${to.list("design")}?model=${saved}`) }) : null}</p>
    </Section>
  );
}
