// A model that a study has left becomes one of the service, under a name.

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { ask } from "../../api/client.ts";
import type { Study } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { attempt } from "../../data.ts";
import { useMay } from "../../session.ts";
import { Section } from "../../ui/parts.tsx";
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
    <Section title={`Keep the ${what}`} label="keep">
      <form class="row" onSubmit={(event) => void keep(event)}><NameField value={name} onChange={setName} /><button type="submit" class="main">{`Save the ${what}`}</button></form>
      <p aria-live="polite">{saved ? <>{"Saved as "}<a href={to.model(saved)}>{saved}</a>{": for "}<a href={`${to.list("design")}?model=${saved}`}>design</a>{" and diagnosis."}</> : null}</p>
    </Section>
  );
}
