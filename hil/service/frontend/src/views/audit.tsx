// The audit log: who did what, when; for administrators.

import type { JSX } from "preact";
import type { AuditEntry } from "../api/types.ts";
import { useData } from "../data.ts";
import { personIn } from "../i18n/said.ts";
import { t } from "../i18n/text.ts";
import { useQuery } from "../router.ts";
import { useMay } from "../session.ts";
import { actionInWords, kindInWords } from "../ui/kinds.ts";
import { Heading, Loaded, Moment, Scroll } from "../ui/parts.tsx";
import { detailOf, targetOf } from "./audit-words.ts";

const PAGE = 100;

export function Audit(): JSX.Element {
  const may = useMay();
  const [query, setQuery] = useQuery();
  const before = Number(query.get("before")) || 0;
  const entries = useData<AuditEntry[]>(may("admin") ? `/audit?most=${PAGE}${before ? `&before=${before}` : ""}` : null);
  if (!may("admin")) return <><Heading>{t("Audit log")}</Heading><p>{t("Only administrators read the audit log.")}</p></>;
  return (
    <>
      <Heading>{t("Audit log")}</Heading>
      <Loaded of={entries} what={t("the audit log")}>
        {(all) => (
          <>
            <Scroll label={t("Audit log")}><table>
              <thead><tr><th scope="col" class="number">{t("entry")}</th><th scope="col">{t("when")}</th><th scope="col">{t("who")}</th><th scope="col">{t("role")}</th><th scope="col">{t("action")}</th><th scope="col">{t("target")}</th><th scope="col">{t("detail")}</th></tr></thead>
              <tbody>{all.map((one) => <tr key={one.id}><td class="number">{one.id}</td><td><Moment at={one.at} exact /></td><td>{personIn(one.who)}</td><td>{kindInWords(one.role)}</td><th scope="row">{actionInWords(one.action)}</th><td class="long">{targetOf(one.target)}</td><td class="long">{detailOf(one.detail)}</td></tr>)}</tbody>
            </table></Scroll>
            <div class="row">
              {before ? <button type="button" onClick={() => setQuery(new URLSearchParams(), true)}>{t("Newest")}</button> : null}
              {all.length === PAGE ? <button type="button" onClick={() => setQuery(new URLSearchParams({ before: String(all.at(-1)?.id ?? 1) }), true)}>{t("Older")}</button> : null}
            </div>
          </>
        )}
      </Loaded>
    </>
  );
}
