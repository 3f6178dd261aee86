// How far model and bench are apart: by channel and band over noise, and by channel over the signal.

import type { JSX } from "preact";
import type { Diagnosis } from "../../api/types.ts";
import { figure } from "../../format.ts";
import { t } from "../../i18n/text.ts";
import { Scroll } from "../../ui/parts.tsx";
import { heatOf, percentOf, worstOf } from "./wording.ts";

export function ErrorMap({ of: { channels, bands_hz: bands, before, after } }: { of: Diagnosis["map"] }): JSX.Element {
  return (
    <Scroll label={t("Map of the error by channel and frequency")}><table>
      <thead><tr><th scope="col">{t("channel")}</th>{bands.map(([low, high]) => <th scope="col" class="number" key={low}>{t("{low} to {high} Hz", { low, high })}</th>)}</tr></thead>
      <tbody>
        {channels.map((name, channel) => (
          <tr key={name}><th scope="row">{name}</th>
            {bands.map(([low], band) => {
              const was = worstOf(before, channel, band), is = worstOf(after, channel, band);
              return <td key={low} class="number heat" style={{ "--heat": `${heatOf(was)}%` }}>{was === null ? "–" : `${figure(was)} → ${figure(is)}`}</td>;
            })}
          </tr>
        ))}
      </tbody>
    </table></Scroll>
  );
}

export function Gaps({ of, label }: { of: Diagnosis["gap"]; label: string }): JSX.Element {
  return (
    <Scroll label={label}><table>
      <thead><tr><th scope="col">{t("channel")}</th><th scope="col" class="number">{t("before")}</th><th scope="col" class="number">{t("after")}</th><th scope="col" class="number">{t("noise")}</th></tr></thead>
      <tbody>{Object.entries(of).map(([name, one]) => <tr key={name}><th scope="row">{name}</th>{[one.before, one.after, one.noise_floor].map((share, at) => <td key={at} class="number">{share == null ? "–" : percentOf(share)}</td>)}</tr>)}</tbody>
    </table></Scroll>
  );
}
