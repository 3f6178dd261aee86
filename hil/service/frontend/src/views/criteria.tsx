// Criteria with their values, limits and how much room is left.

import type { JSX } from "preact";
import { to } from "../addresses.ts";
import { figure, percent } from "../format.ts";
import { English } from "../i18n/english.tsx";
import { t } from "../i18n/text.ts";
import { Badge, Scroll } from "../ui/parts.tsx";
import { allowed, inOrder, meaningOf, metricsOf, metricWords, namedBy, wordsOfCriterion, type Measured } from "./criterion-words.ts";

export function Criteria({ of, onSegment }: { of: Measured[]; onSegment?: (segment: string) => void }): JSX.Element {
  if (!of.length) return <p class="quiet">{t("None has been decided yet.")}</p>;
  return (
    <>
      <Scroll label={t("Criteria")}>
        <table>
          <thead><tr><th scope="col">{t("criterion")}</th><th scope="col" class="number">{t("value")}</th><th scope="col" class="number">{t("limit")}</th><th scope="col" class="number">{t("margin")}</th><th scope="col">{t("verdict")}</th></tr></thead>
          <tbody>
            {inOrder(of).map((one) => (
              <tr key={one.id}>
                <th scope="row">
                  <CriterionName of={one} onSegment={onSegment} />
                  {one.reason ? <span class="reason"><English>{one.reason}</English></span> : null}
                </th>
                <td class="number">{figure(one.value, one.unit)}</td>
                <td class="number limit">{allowed(one)}</td>
                <td class="number">{one.margin === null || one.margin === undefined ? "–" : percent(one.margin, 1)}</td>
                <td><Badge kind={one.verdict} /></td>
              </tr>
            ))}
          </tbody>
        </table>
      </Scroll>
      <Meanings of={of} />
    </>
  );
}

// In words, with the id by which plans, files and the API name it.
export function CriterionName({ of: one, onSegment }: { of: Pick<Measured, "id" | "title" | "source">; onSegment?: ((segment: string) => void) | undefined }): JSX.Element {
  const { segment } = namedBy(one.id), words = wordsOfCriterion(one);
  return (
    <>
      {onSegment && segment ? <button type="button" class="plain" onClick={() => onSegment(segment)}>{words}</button> : words}
      {words === one.id ? null : <span class="reason">{one.source === "device" ? t("{criterion}, of any device", { criterion: one.id }) : one.id}</span>}
    </>
  );
}

function Meanings({ of }: { of: Measured[] }): JSX.Element | null {
  const metrics = metricsOf(of);
  if (!metrics.length) return null;
  return (
    <details>
      <summary>{t("What is measured")}</summary>
      <dl class="meanings">{metrics.map((one) => <div key={one}><dt>{metricWords(one)}</dt><dd>{meaningOf(one)}</dd></div>)}</dl>
      <p class="links"><a href={to.list("glossary")}>{t("Words of this page")}</a></p>
    </details>
  );
}
