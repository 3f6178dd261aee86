// Versions of a file: who gave which when, what differs from today's, and the way back.

import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import { getText } from "../api/client.ts";
import type { Version } from "../api/types.ts";
import { attempt, useData } from "../data.ts";
import { t, tn } from "../i18n/text.ts";
import { useMay } from "../session.ts";
import { Moment, Scroll, Section } from "../ui/parts.tsx";
import { diffOf } from "./diff.ts";

export type VersionedKind = "plan" | "model" | "controller" | "bench";

export const versionPath = (kind: VersionedKind, name: string, number: number): string => `/versions/${kind}/${encodeURIComponent(name)}/${number}/text`;

interface Options {
  kind: VersionedKind;
  name: string;
  textPath: string | null; // of today's text; null where it was removed
  editPath: string; // where it is edited; the version is added
}

export function Versions({ kind, name, textPath, editPath }: Options): JSX.Element | null {
  const versions = useData<Version[]>(`/versions/${kind}/${encodeURIComponent(name)}`).data ?? [];
  const [shown, setShown] = useState<number | null>(null), may = useMay();
  if (!versions.length) return null;
  return (
    <Section title={t("Versions")} label="versions">
      <Scroll label={t("Versions")}><table>
        <thead><tr><th scope="col" class="number">{t("version")}</th><th scope="col">{t("name")}</th><th scope="col">{t("given by")}</th><th scope="col">{t("given")}</th><td /></tr></thead>
        <tbody>{versions.map((one) => (
          <tr key={one.number}><td class="number">{one.number}</td><th scope="row">{one.name}</th><td>{one.given_by}</td><td><Moment at={one.given_at} /></td>
            <td><span class="buttons">{textPath === null ? null : <button type="button" aria-pressed={shown === one.number} aria-label={t("Differences of version {number} from today's text", { number: one.number })} onClick={() => setShown(shown === one.number ? null : one.number)}>{t("Differences")}</button>}{may("engineer") ? <a class="button" href={`${editPath}&version=${one.number}`} aria-label={t("Write on from version {number}", { number: one.number })}>{t("Write on")}</a> : null}</span></td>
          </tr>
        ))}</tbody>
      </table></Scroll>
      {shown !== null && textPath !== null ? <Differences key={shown} before={versionPath(kind, name, shown)} after={textPath} /> : null}
    </Section>
  );
}

function Differences({ before, after }: { before: string; after: string }): JSX.Element {
  const [texts, setTexts] = useState<[string, string] | null>(null);
  useEffect(() => {
    const control = new AbortController();
    void attempt(async () => setTexts(await Promise.all([getText(before, control.signal), getText(after, control.signal)])));
    return () => control.abort();
  }, [before, after]);
  if (!texts) return <p class="quiet">{t("Loading the texts …")}</p>;
  if (texts[0] === texts[1]) return <p class="quiet">{t("It is today's text.")}</p>;
  return <Difference before={texts[0]} after={texts[1]} label={t("Differences, from that version to today's text")} />;
}

export function Difference({ before, after, label }: { before: string; after: string; label: string }): JSX.Element {
  const marks = { same: " ", gone: "−", new: "+", "left out": "…" };
  return (
    <pre class="diff" tabIndex={0} role="region" aria-label={label}>
      {diffOf(before, after).map((line, at) => <span key={at} class={line.kind.replace(" ", "-")}>{`${marks[line.kind]} ${line.kind === "left out" ? tn("{count} line is the same", "{count} lines are the same", Number(line.text)) : line.text}\n`}</span>)}
    </pre>
  );
}
