// Draws the lowest and the highest value of each bucket, so that no peak is lost, and a spectrum with its band.

const SHOWN_S = 30;
const LEFT = 52, BOTTOM = 22, TOP = 8, RIGHT = 8;
const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

export const number = (value) => {
  if (value === null || !Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  const text = size >= 100 ? value.toFixed(0) : size >= 10 ? value.toFixed(1) : size >= 0.1 || size === 0 ? value.toFixed(2) : value.toPrecision(2);
  return text.replace("-", "−");
};

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

class Frame {
  constructor(canvas, left, right, low, high, unit) {
    const scale = window.devicePixelRatio || 1;
    const { clientWidth: width, clientHeight: height } = canvas;
    canvas.width = Math.round(width * scale);
    canvas.height = Math.round(height * scale);
    Object.assign(this, { pen: canvas.getContext("2d"), width, height, left, right, low, high });
    this.pen.scale(scale, scale);
    this.pen.font = "12px sans-serif";
    this.axes(unit);
  }

  x(value) { return LEFT + ((value - this.left) / (this.right - this.left)) * (this.width - LEFT - RIGHT); }
  y(value) { return this.height - BOTTOM - ((value - this.low) / (this.high - this.low)) * (this.height - BOTTOM - TOP); }

  axes(unit) {
    const pen = this.pen;
    pen.lineWidth = 1;
    pen.textBaseline = "middle";
    pen.textAlign = "right";
    const heights = ticks(this.low, this.high, 6);
    const decimals = heights.length > 1 ? Math.max(0, -Math.floor(Math.log10(heights[1] - heights[0]) + 1e-9)) : 0;
    for (const value of heights) {
      this.stroke(colour("grid"), [[LEFT, this.y(value)], [this.width - RIGHT, this.y(value)]]);
      pen.fillStyle = colour("quiet");
      pen.fillText(value.toFixed(decimals).replace("-", "−"), LEFT - 6, this.y(value));
    }
    pen.textBaseline = "alphabetic";
    pen.textAlign = "center";
    const places = ticks(this.left, this.right, Math.max(2, this.width / 90));
    places.forEach((value, at) => {
      pen.fillStyle = colour("quiet");
      pen.fillText(at === places.length - 1 ? `${value} ${unit}` : `${value}`, Math.min(this.x(value), this.width - 20), this.height - 6);
    });
    this.stroke(colour("quiet"), [[LEFT, this.height - BOTTOM], [this.width - RIGHT, this.height - BOTTOM]]);
  }

  stroke(style, points) {
    const pen = this.pen;
    pen.strokeStyle = style;
    pen.beginPath();
    points.forEach(([x, y], at) => (at ? pen.lineTo(x, y) : pen.moveTo(x, y)));
    pen.stroke();
  }

  envelope(buckets, style) {
    if (!buckets.length) return;
    const pen = this.pen;
    const shown = buckets.filter(([time]) => time >= this.left);
    pen.strokeStyle = pen.fillStyle = style;
    pen.lineWidth = 1.4;
    pen.lineJoin = "round";
    pen.beginPath();
    shown.forEach(([time, , high], at) => (at ? pen.lineTo(this.x(time), this.y(high)) : pen.moveTo(this.x(time), this.y(high))));
    for (const [time, low] of [...shown].reverse()) pen.lineTo(this.x(time), this.y(low));
    pen.closePath();
    pen.fill();
    pen.stroke();
  }

  line(points, style) {
    this.pen.lineWidth = 1.6;
    this.pen.save();
    this.pen.beginPath();
    this.pen.rect(LEFT, TOP, this.width, this.height - BOTTOM - TOP);
    this.pen.clip();
    this.stroke(style, points.map(([x, y]) => [this.x(x), this.y(y)]));
    this.pen.restore();
  }

  point(x, y, style, square) {
    const pen = this.pen;
    pen.fillStyle = style;
    pen.beginPath();
    if (square) pen.rect(this.x(x) - 4, this.y(y) - 4, 8, 8); else pen.arc(this.x(x), this.y(y), 4, 0, 2 * Math.PI);
    pen.fill();
  }

  limit(value) {
    if (value < this.low || value > this.high) return;
    this.pen.setLineDash([6, 4]);
    this.pen.lineWidth = 1.4;
    this.stroke(colour("series-limit"), [[LEFT, this.y(value)], [this.width - RIGHT, this.y(value)]]);
    this.pen.setLineDash([]);
  }

  band(from, to) {
    this.pen.fillStyle = colour("band");
    this.pen.fillRect(this.x(from), TOP, this.x(to) - this.x(from), this.height - BOTTOM - TOP);
  }
}

function ticks(low, high, count) {
  const raw = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((one) => one >= raw);
  const found = [];
  for (let value = Math.ceil(low / step) * step; value <= high + 1e-9 * step; value += step) found.push(Number(value.toPrecision(10)));
  return found;
}
