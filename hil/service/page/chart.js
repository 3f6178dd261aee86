// Live charts: the lowest and the highest value of each bucket, so that no peak is lost, and a spectrum with its band.

import { Frame, colour } from "./frame.js";

const SHOWN_S = 30;

export class TimeChart {
  // lines: [{channel, role}]; limit: largest magnitude, drawn where it is in reach
  constructor(canvas, lines) {
    this.canvas = canvas;
    this.lines = lines;
    this.limit = null;
    this.clear();
  }

  clear() {
    this.buckets = this.lines.map(() => []);
  }

  add(samples) {
    this.lines.forEach(({ channel }, index) => {
      const found = samples.channels[channel];
      if (!found) return;
      const kept = this.buckets[index];
      found.lowest.forEach((low, at) => {
        if (low !== null) kept.push([samples.start_s + (at + 0.5) * samples.width_s, low, found.highest[at]]);
      });
      const oldest = kept.length ? kept[kept.length - 1][0] - SHOWN_S : 0;
      let gone = 0;
      while (gone < kept.length && kept[gone][0] < oldest) gone += 1;
      kept.splice(0, gone);
    });
  }

  newest(index = 0) {
    const kept = this.buckets[index];
    return kept.length ? kept[kept.length - 1][2] : null;
  }

  draw() {
    const all = this.buckets.flat();
    const end = Math.max(SHOWN_S, ...this.buckets.map((kept) => (kept.length ? kept[kept.length - 1][0] : 0)));
    let low = 0, high = 1;
    if (all.length) {
      low = Math.min(...all.map((one) => one[1]));
      high = Math.max(...all.map((one) => one[2]));
    }
    const room = Math.max(high - low, 1e-3 * Math.max(Math.abs(high), Math.abs(low)), 0.1);
    low -= 0.08 * room;
    high += 0.08 * room;
    const frame = new Frame(this.canvas, end - SHOWN_S, end, low, high, "s");
    for (const limit of this.limit === null ? [] : [this.limit, -this.limit]) frame.limit(limit);
    this.lines.forEach(({ role }, index) => frame.envelope(this.buckets[index], colour(`series-${role}`)));
  }
}

export class SpectrumChart {
  constructor(canvas) {
    this.canvas = canvas;
    this.clear();
  }

  clear() {
    this.found = null;
  }

  draw() {
    const points = this.found ? this.found.density.map((value, at) => [at * this.found.step_hz, value]) : [];
    // scaled by what is near the band: slow motion would hide it
    const largest = points.length ? Math.max(...points.filter(([hz]) => hz >= 5).map(([, value]) => value), 1e-9) : 1;
    const frame = new Frame(this.canvas, 0, 40, 0, 1.1 * largest, "Hz");
    frame.band(8, 20);
    frame.line(points, colour("series-gain"));
  }
}

export class TrendChart {
  constructor(canvas) { this.canvas = canvas; }

  draw(trend) {
    const points = trend.points.filter((point) => point.value !== null).map((point) => [point.run, point.value, point.verdict]);
    const limits = [trend.lower, trend.upper].filter((one) => one !== null);
    const all = [...points.map((point) => point[1]), ...limits];
    const room = Math.max(Math.max(...all) - Math.min(...all), 1e-9);
    const runs = points.map((point) => point[0]);
    const frame = new Frame(this.canvas, Math.min(...runs) - 1, Math.max(...runs) + 1, Math.min(...all) - 0.1 * room, Math.max(...all) + 0.1 * room, "run");
    for (const limit of limits) frame.limit(limit);
    frame.line(points, colour("series-reference"));
    for (const [run, value, verdict] of points) frame.point(run, value, colour(verdict === "fail" ? "fail" : "series-gain"), verdict === "fail");
  }
}
