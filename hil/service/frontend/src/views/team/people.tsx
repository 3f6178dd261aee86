// People who have signed in with the provider's accounts; an administrator signs somebody out everywhere.

import type { JSX } from "preact";
import { ask } from "../../api/client.ts";
import type { Person } from "../../api/types.ts";
import { attempt, useData } from "../../data.ts";
import { t } from "../../i18n/text.ts";
import { agreed } from "../../question.ts";
import { kindInWords } from "../../ui/kinds.ts";
import { Moment, Scroll, Section } from "../../ui/parts.tsx";

export function People(): JSX.Element | null {
  const found = useData<Person[]>("/people");
  if (!found.data?.length) return null;
  const signOut = async (one: Person) => { if (await agreed(t("Sign {name} out everywhere?", { name: one.name }), t("Sign out"), t("Cancel"))) void attempt(() => ask("DELETE", `/people/${one.id}/sessions`)).then(found.again); };
  return (
    <Section title={t("People")} label="people">
      <Scroll label={t("People")}>
        <table>
          <thead><tr><th scope="col">{t("name")}</th><th scope="col">{t("role")}</th><th scope="col">{t("last signed in")}</th><th scope="col">{t("subject")}</th><td /></tr></thead>
          <tbody>
            {found.data.map((one) => (
              <tr key={one.id}>
                <th scope="row">{one.name}</th><td>{kindInWords(one.role)}</td><td><Moment at={one.signed_in_at} /></td><td>{one.subject}</td>
                <td><button type="button" aria-label={t("Sign out {name}", { name: one.name })} onClick={() => void signOut(one)}>{t("Sign out")}</button></td>
              </tr>
            ))}
          </tbody>
        </table>
      </Scroll>
    </Section>
  );
}
