// What an identification tried, side by side: orders and chains with their misfit, criteria and numbers; one is chosen.

import type { JSX } from "preact";
import type { Identification } from "../../api/types.ts";
import { figure, fixed, percent, significant, wordsOf } from "../../format.ts";
import { t } from "../../i18n/text.ts";
import { Badge, inWords, Scroll } from "../../ui/parts.tsx";

export type Order = Identification["orders"][number];
export type Chain = Identification["chains"][number];

export const nameOfOrder = ({ order, integrator }: Order): string => (integrator ? t("order {order}", { order }) : t("order {order}, no pole at the origin", { order }));

interface Chosen {
  file: string;
  onChoose: (file: string) => void;
}

export function Orders({ orders, file, onChoose }: { orders: Order[] } & Chosen): JSX.Element {
  const least = Math.min(...orders.flatMap((one) => one.bic ?? []));
  const channels = Object.keys(orders.find((one) => Object.keys(one.misfit).length)?.misfit ?? {});
  return (
    <>
      <Scroll label={t("Orders")}><table>
        <thead><tr>
          <th scope="col">{t("order")}</th><th scope="col" class="number">{t("error on held-out data")}</th><th scope="col" class="number">χ²</th><th scope="col" class="number">ΔBIC</th>
          {channels.map((channel) => <th scope="col" class="number" key={channel}>{t("misfit of {channel}", { channel: wordsOf(channel) })}</th>)}
          <th scope="col" class="number">{t("dead time")}</th><th scope="col" class="number">{t("resonances and damping")}</th>
        </tr></thead>
        <tbody>{orders.map((one) => (
          <tr key={`${one.order} ${one.integrator}`}>
            <th scope="row"><Choose name={nameOfOrder(one)} file={one.model} chosen={file} onChoose={onChoose} />{one.chosen ? <> <span class="reason">{t("taken by hil identify")}</span></> : null}{one.verdict === "doubtful" ? <Badge kind="doubtful" /> : null}</th>
            <td class="number">{percent(one.relative_excess, 1)}<span class="reason">{t("{count} noise variances", { count: significant(one.held_out, 3) })}</span></td>
            <td class="number">{figure(one.chi_square)}</td>
            <td class="number">{one.bic === null ? "–" : significant(Math.round(one.bic - least), 6)}<span class="reason">{one.parameters === null ? "" : t("{count} parameters", { count: one.parameters })}</span></td>
            {channels.map((channel) => <td class="number" key={channel}>{misfitText(one.misfit[channel])}</td>)}
            <td class="number">{withError(1000 * one.dead_time_s, one.dead_time_error_s === null ? null : 1000 * one.dead_time_error_s, "ms")}</td>
            <td class="number">{one.resonances.map((pair, at) => <span class="reason" key={at}>{withError(pair.frequency_hz, pair.frequency_error_hz, "Hz")}; {withError(pair.damping, pair.damping_error, "")}</span>)}</td>
          </tr>
        ))}</tbody>
      </table></Scroll>
      <p class="quiet">{t("Error beyond noise on frequencies left out of the fit, χ² per degree of freedom (1 is noise), BIC above the smallest (10 is much), rms of gain and phase; ± is one standard error, left out where it does not hold.")}</p>
    </>
  );
}

export function Chains({ chains, file, onChoose }: { chains: Chain[] } & Chosen): JSX.Element {
  const channels = Object.keys(chains[0]?.misfit ?? {}), names = [...new Set(chains.flatMap((one) => one.parameters.map(({ name }) => name)))];
  return (
    <Scroll label={t("Chains")}><table>
      <thead><tr><th scope="col">{t("figure")}</th>{chains.map((one) => <th scope="col" class="number" key={one.kind}><Choose name={inWords(one.kind)} file={one.model} chosen={file} onChoose={onChoose} />{one.chosen ? <span class="reason">{t("taken by hil identify")}</span> : null}</th>)}</tr></thead>
      <tbody>
        <tr><th scope="row">{t("explains the data")}</th>{chains.map((one) => <td class="number" key={one.kind}>{one.explains ? t("yes") : t("no")}</td>)}</tr>
        {channels.map((channel) => <tr key={channel}><th scope="row">{t("misfit of {channel}", { channel: wordsOf(channel) })}</th>{chains.map((one) => <td class="number" key={one.kind}>{misfitText(one.misfit[channel])}</td>)}</tr>)}
        {names.map((name) => <tr key={name}><th scope="row">{inWords(name)}</th>{chains.map((one) => { const found = one.parameters.find((parameter) => parameter.name === name); return <td class="number" key={one.kind}>{found ? withError(found.value, errorOf(found), found.unit) : "–"}</td>; })}</tr>)}
      </tbody>
    </table></Scroll>
  );
}

const IN_95 = 1.959964; // standard errors

const errorOf = ({ value, upper }: Chain["parameters"][number]): number | null => (upper === null ? null : (upper - value) / IN_95);

const misfitText = (of: { gain_db: number | null; phase_deg: number | null } | undefined): string => (of ? `${figure(of.gain_db, "dB")}, ${figure(of.phase_deg, "°")}` : "–");

// As many digits as the error has two of; five where there is none.
export function withError(value: number | null, error: number | null, unit: string): string {
  if (value === null) return "–";
  const behind = unit ? `\u00a0${unit}` : "";
  if (error === null || !(error > 0)) return significant(value, 5) + behind;
  const digits = Math.max(0, Math.min(9, 1 - Math.floor(Math.log10(error))));
  return `${fixed(value, digits)} ± ${fixed(error, digits)}${behind}`;
}

function Choose({ name, file, chosen, onChoose }: { name: string; file: string; chosen: string; onChoose: (file: string) => void }): JSX.Element {
  if (!file) return <>{name}</>;
  return <label class="tick"><input type="radio" name="taken-model" checked={file === chosen} onChange={() => onChoose(file)} />{name}</label>;
}
