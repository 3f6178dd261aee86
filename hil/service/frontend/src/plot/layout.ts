// Which plots are shown, of which channels: as text, in an address or kept in the browser.

export type PlotKind = "time" | "spectrum" | "xy";

// Of an XY plot the first channel is x.
export interface PlotSpec {
  kind: PlotKind;
  channels: string[];
}

export const MOST_PLOTS = 8;
export const MOST_CHANNELS = 12;

// "a,b;psd:a;xy:a,b"
export function layoutText(plots: readonly PlotSpec[]): string {
  const heads: Record<PlotKind, string> = { time: "", spectrum: "psd:", xy: "xy:" };
  return plots.map(({ kind, channels }) => heads[kind] + channels.join(",")).join(";");
}

export function layoutOf(text: string): PlotSpec[] {
  return text.split(";").slice(0, MOST_PLOTS).map((one): PlotSpec => {
    const [, head = "", rest = ""] = /^(psd:|xy:)?(.*)$/.exec(one) ?? [];
    const channels = rest.split(",").filter(Boolean).slice(0, MOST_CHANNELS);
    return { kind: head === "psd:" ? "spectrum" : head === "xy:" ? "xy" : "time", channels };
  });
}

const USUAL: PlotSpec[] = [
  { kind: "time", channels: ["motor_speed_rad_s"] },
  { kind: "time", channels: ["shaft_torque_nm"] },
  { kind: "time", channels: ["motor_torque_ref_nm", "motor_torque_nm"] },
  { kind: "spectrum", channels: ["motor_speed_rad_s"] },
];

// What is shown until somebody chooses: the usual channels as far as the run has them, else its first ones; and those
// of which it failed a limit, each on a plot of its own.
export function usualLayout(channels: readonly string[], failed: readonly string[] = []): PlotSpec[] {
  const usual = usualOf(channels), shown = channelsOf(usual);
  return [...usual, ...failed.filter((one) => channels.includes(one) && !shown.includes(one)).map((one) => ({ kind: "time" as const, channels: [one] }))].slice(0, MOST_PLOTS);
}

function usualOf(channels: readonly string[]): PlotSpec[] {
  const known = USUAL.map(({ kind, channels: some }) => ({ kind, channels: some.filter((one) => channels.includes(one)) })).filter((one) => one.channels.length);
  return known.length ? known : channels.slice(0, 3).map((channel) => ({ kind: "time", channels: [channel] }));
}

export const channelsOf = (plots: readonly PlotSpec[]): string[] => [...new Set(plots.filter((plot) => plot.kind === "time").flatMap((plot) => plot.channels))];

// A channel onto a plot: once; of an XY plot in the place of the second.
export function withChannel(plot: PlotSpec, channel: string): PlotSpec {
  if (plot.channels.includes(channel)) return plot;
  if (plot.kind === "spectrum") return { ...plot, channels: [channel] };
  if (plot.kind === "xy") return { ...plot, channels: [...plot.channels.slice(0, 1), channel] };
  return plot.channels.length < MOST_CHANNELS ? { ...plot, channels: [...plot.channels, channel] } : plot;
}

export const withoutChannel = (plot: PlotSpec, channel: string): PlotSpec => ({ ...plot, channels: plot.channels.filter((one) => one !== channel) });
