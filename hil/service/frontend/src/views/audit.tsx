// The audit log: who did what, when; for administrators.

import type { JSX } from "preact";
import type { AuditEntry } from "../api/types.ts";
import { useData } from "../data.ts";
import { useQuery } from "../router.ts";
import { useMay } from "../session.ts";
import { Heading, Loaded, Moment, Scroll } from "../ui/parts.tsx";

const PAGE = 100;

export function Audit(): JSX.Element {
  const may = useMay();
  const [query, setQuery] = useQuery();
  const before = Number(query.get("before")) || 0;
  const entries = useData<AuditEntry[]>(may("admin") ? `/audit?most=${PAGE}${before ? `&before=${before}` : ""}` : null);
  if (!may("admin")) return <><Heading>Audit log</Heading><p>Only administrators read the audit log.</p></>;
  return (
    <>
      <Heading>Audit log</Heading>
      <Loaded of={entries} what="the audit log">
        {(all) => (
          <>
            <Scroll label="Audit log"><table>
              <thead><tr><th scope="col" class="number">entry</th><th scope="col">when</th><th scope="col">who</th><th scope="col">role</th><th scope="col">action</th><th scope="col">of</th><th scope="col">detail</th></tr></thead>
              <tbody>{all.map((one) => <tr key={one.id}><td class="number">{one.id}</td><td><Moment at={one.at} /></td><td>{one.who}</td><td>{one.role}</td><th scope="row">{one.action}</th><td>{one.target}</td><td>{one.detail}</td></tr>)}</tbody>
            </table></Scroll>
            <div class="row">
              {before ? <button type="button" onClick={() => setQuery(new URLSearchParams(), true)}>Newest</button> : null}
              {all.length === PAGE ? <button type="button" onClick={() => setQuery(new URLSearchParams({ before: String(all.at(-1)?.id ?? 1) }), true)}>Older</button> : null}
            </div>
          </>
        )}
      </Loaded>
    </>
  );
}
