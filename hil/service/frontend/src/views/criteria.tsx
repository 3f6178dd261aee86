// Criteria with their values, limits and how much room is left.

import type { JSX } from "preact";
import { figure, limitText, percent } from "../format.ts";
import { English } from "../i18n/english.tsx";
import { t } from "../i18n/text.ts";
import { Badge, Scroll } from "../ui/parts.tsx";

interface Shown {
  id: string;
  title?: string;
  value: number | null;
  unit: string;
  upper?: number | null;
  lower?: number | null;
  below?: string;
  verdict: string;
  margin?: number | null;
  reason?: string;
  source?: string;
}

export function Criteria({ of, onSegment }: { of: Shown[]; onSegment?: (segment: string) => void }): JSX.Element {
  if (!of.length) return <p class="quiet">{t("None has been decided yet.")}</p>;
  const own = of.filter((one) => one.source !== "device"), device = of.filter((one) => one.source === "device");
  return (
    <Scroll label={t("Criteria")}>
      <table>
        <thead><tr><th scope="col">{t("criterion")}</th><th scope="col" class="number">{t("value")}</th><th scope="col" class="number">{t("limit")}</th><th scope="col" class="number">{t("margin")}</th><th scope="col">{t("verdict")}</th></tr></thead>
        <tbody>
          {[...own, ...device].map((one) => (
            <tr key={one.id}>
              <th scope="row">
                {onSegment && one.id.includes(".") ? <button type="button" class="plain" onClick={() => onSegment(one.id.slice(0, one.id.lastIndexOf(".")))}>{one.title || one.id}</button> : one.title || one.id}
                {one.reason ? <span class="reason"><English>{one.reason}</English></span> : null}
                {one.title ? <span class="reason">{one.source === "device" ? t("{criterion}, of any device", { criterion: one.id }) : one.id}</span> : null}
              </th>
              <td class="number">{figure(one.value, one.unit)}</td>
              <td class="number">{one.below ? t("below {limit}", { limit: one.below }) : limitText(one.upper, one.lower, one.unit)}</td>
              <td class="number">{one.margin === null || one.margin === undefined ? "–" : percent(one.margin, 1)}</td>
              <td><Badge kind={one.verdict} /></td>
            </tr>
          ))}
        </tbody>
      </table>
    </Scroll>
  );
}
