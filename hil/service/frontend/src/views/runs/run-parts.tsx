// What a run has left: events, files, and what holds them together.

import type { JSX } from "preact";
import { fileUrl } from "../../api/client.ts";
import type { Run, RunView } from "../../api/types.ts";
import { fixed, joined } from "../../format.ts";
import { English } from "../../i18n/english.tsx";
import { t, tn, tx } from "../../i18n/text.ts";
import { eventInWords, isKind, kindInWords } from "../../ui/kinds.ts";
import { FileLink, Scroll, Section } from "../../ui/parts.tsx";
import { look } from "./places.ts";

const NAMES: Record<string, string> = {
  "report.html": t("report"), "report.pdf": t("report as PDF"), "recording.mcap": t("recording (MCAP)"), "result.json": t("result (JSON)"), "junit.xml": "JUnit", "plan.yaml": t("plan as executed"), "log.txt": t("log"),
};
const AROUND_S = 2;

export function Happenings({ view }: { view: RunView }): JSX.Element | null {
  if (!view.marks.length) return null;
  const marks = [...view.marks].sort((one, other) => one.start_s - other.start_s);
  return (
    <Section title={t("Segments and events")} label="events">
      <Scroll label={t("Segments and events")}>
        <table>
          <thead><tr><th scope="col" class="number">{t("time")}</th><th scope="col" class="folds">{t("kind")}</th><th scope="col">{t("name")}</th><th scope="col">{t("what")}</th></tr></thead>
          <tbody>
            {marks.map((mark, at) => (
              <tr key={at}>
                <td class="number"><button type="button" class="plain" aria-label={t("Show {mark} at {start_s} s", { mark: mark.name, start_s: fixed(mark.start_s, 2) })} onClick={() => look(mark.end_s != null ? { from: mark.start_s, to: mark.end_s } : { from: mark.start_s - AROUND_S, to: mark.start_s + AROUND_S })}>{joined(fixed(mark.start_s, 2), "s")}</button></td>
                <td class="folds">{kindInWords(mark.kind)}</td><td>{mark.kind === "segment" ? mark.name : eventInWords(mark.name)}</td><td>{mark.kind === "segment" && isKind(mark.text) ? kindInWords(mark.text) : <English>{mark.text}</English>}</td>
              </tr>
            ))}
          </tbody>
        </table>
      </Scroll>
    </Section>
  );
}

export function Downloads({ run }: { run: Run }): JSX.Element {
  const files = run.files ?? [], known = Object.keys(NAMES);
  const sorted = [...files].sort((one, other) => (known.indexOf(one) + 1 || 99) - (known.indexOf(other) + 1 || 99));
  return (
    <Section title={t("Files")} label="files">
      {sorted.length
        ? <p class="links">{sorted.map((name) => <FileLink key={name} name={name} href={fileUrl(run.id, name)}>{NAMES[name] ?? name}</FileLink>)}</p>
        : <p class="quiet">{t("This run has left no files.")}</p>}
    </Section>
  );
}

export function Evidence({ of }: { of: NonNullable<RunView["evidence"]> }): JSX.Element {
  const files = Object.entries(of.files ?? {});
  return (
    <Section title={t("Evidence")} label="evidence">
      <p>{of.whole === false ? t("The run has no result: what is left of it is a part.") : of.signed_by ? t("Signed by {person}.", { person: of.signed_by }) : t("The recording and its report are complete.")} {tx("{command} says whether anything has changed since.", { command: <code>hil evidence verify</code> })}</p>
      {of.samples_sha256 ? <p class="quiet">{tx("SHA-256 of the samples {sum}", { sum: <code>{of.samples_sha256}</code> })}</p> : null}
      {files.length ? (
        <details>
          <summary>{tn("SHA-256 of {count} file", "SHA-256 of {count} files", files.length)}</summary>
          <Scroll label={t("SHA-256 of files")}><table><tbody>{files.map(([name, sum]) => <tr key={name}><th scope="row">{name}</th><td><code>{sum}</code></td></tr>)}</tbody></table></Scroll>
        </details>
      ) : null}
    </Section>
  );
}
