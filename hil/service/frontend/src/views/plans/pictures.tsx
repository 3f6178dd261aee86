// Pictures that plans show with their questions to the operator.

import type { JSX } from "preact";
import { API, ask } from "../../api/client.ts";
import { attempt, useData } from "../../data.ts";
import { t } from "../../i18n/text.ts";
import { agreed } from "../../question.ts";

export function Pictures(): JSX.Element {
  const names = useData<string[]>("/pictures");
  const pathOf = (name: string) => `/pictures/${encodeURIComponent(name)}`;
  const give = async (field: HTMLInputElement) => {
    const [file] = field.files ?? [];
    if (!file) return;
    await attempt(() => ask("PUT", pathOf(file.name), file));
    field.value = "";
    names.again();
  };
  const remove = async (name: string) => {
    if (!(await agreed(t("Remove the picture {name}?", { name }), t("Remove"), t("Cancel")))) return;
    await attempt(() => ask("DELETE", pathOf(name)));
    names.again();
  };
  return (
    <>
      <ul class="pictures">
        {(names.data ?? []).map((name) => (
          <li key={name}>
            <a href={API + pathOf(name)} target="_blank" rel="noopener"><img src={API + pathOf(name)} alt="" />{name}</a>
            <button type="button" class="plain" aria-label={t("Remove the picture {name}", { name })} onClick={() => void remove(name)}>{t("Remove")}</button>
          </li>
        ))}
      </ul>
      <label class="field">{t("Picture (PNG, JPEG or SVG, at most 250 kB)")}<input type="file" accept=".png,.jpg,.jpeg,.svg" onChange={(event) => void give(event.currentTarget)} /></label>
    </>
  );
}
