// What every chart stands in: axes with their numbers, lines, envelopes, limits.

const LEFT = 52, BOTTOM = 22, TOP = 8, RIGHT = 8;
export const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

export const number = (value) => {
  if (value === null || !Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  const text = size >= 100 ? value.toFixed(0) : size >= 10 ? value.toFixed(1) : size >= 0.1 || size === 0 ? value.toFixed(2) : value.toPrecision(2);
  return text.replace("-", "−");
};

// Axes, and what is drawn between them; `log` names the axes that are logarithmic: "x", "y" or both.
export class Frame {
  constructor(canvas, left, right, low, high, unit, log = "") {
    const scale = window.devicePixelRatio || 1;
    const { clientWidth: width, clientHeight: height } = canvas;
    canvas.width = Math.round(width * scale);
    canvas.height = Math.round(height * scale);
    Object.assign(this, { pen: canvas.getContext("2d"), width, height, left, right, low, high, log });
    this.pen.scale(scale, scale);
    this.pen.font = "12px sans-serif";
    this.axes(unit);
  }

  x(value) { return LEFT + share(value, this.left, this.right, this.log.includes("x")) * (this.width - LEFT - RIGHT); }
  y(value) { return this.height - BOTTOM - share(value, this.low, this.high, this.log.includes("y")) * (this.height - BOTTOM - TOP); }

  axes(unit) {
    const pen = this.pen;
    pen.lineWidth = 1;
    pen.textBaseline = "middle";
    pen.textAlign = "right";
    const heights = this.log.includes("y") ? decades(this.low, this.high) : ticks(this.low, this.high, 6);
    const decimals = heights.length > 1 ? Math.max(0, -Math.floor(Math.log10(heights[1] - heights[0]) + 1e-9)) : 0;
    for (const value of heights) {
      this.stroke(colour("grid"), [[LEFT, this.y(value)], [this.width - RIGHT, this.y(value)]]);
      pen.fillStyle = colour("quiet");
      pen.fillText(this.log.includes("y") ? String(value) : value.toFixed(decimals).replace("-", "−"), LEFT - 6, this.y(value));
    }
    pen.textBaseline = "alphabetic";
    pen.textAlign = "center";
    const places = this.log.includes("x") ? decades(this.left, this.right) : ticks(this.left, this.right, Math.max(2, this.width / 90));
    places.forEach((value, at) => {
      pen.fillStyle = colour("quiet");
      const text = String(value).replace("-", "−");
      pen.fillText(at === places.length - 1 ? `${text} ${unit}` : text, Math.min(this.x(value), this.width - 20), this.height - 6);
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

  // buckets: [place, lowest, highest]
  envelope(buckets, style, width = 1.4) {
    if (!buckets.length) return;
    const pen = this.pen;
    const shown = buckets.filter(([time]) => time >= this.left);
    pen.strokeStyle = pen.fillStyle = style;
    pen.lineWidth = width;
    pen.lineJoin = "round";
    pen.beginPath();
    shown.forEach(([time, , high], at) => (at ? pen.lineTo(this.x(time), this.y(high)) : pen.moveTo(this.x(time), this.y(high))));
    for (const [time, low] of [...shown].reverse()) pen.lineTo(this.x(time), this.y(low));
    pen.closePath();
    pen.fill();
    pen.stroke();
  }

  line(points, style, dashes = []) {
    this.pen.lineWidth = 1.6;
    this.pen.save();
    this.pen.setLineDash(dashes);
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

  dot(x, y, style) {
    this.pen.fillStyle = style;
    this.pen.fillRect(this.x(x) - 1.5, this.y(y) - 1.5, 3, 3);
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

function share(value, from, to, isLog) {
  return isLog ? Math.log(value / from) / Math.log(to / from) : (value - from) / (to - from);
}

function decades(low, high) {
  const found = [], steps = high / low > 2000 ? [1] : [1, 2, 5];
  for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power += 1) {
    for (const step of steps) found.push(Number((step * 10 ** power).toPrecision(6)));
  }
  return found.filter((value) => value >= low * 0.999 && value <= high * 1.001);
}

function ticks(low, high, count) {
  const raw = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((one) => one >= raw);
  const found = [];
  for (let value = Math.ceil(low / step) * step; value <= high + 1e-9 * step; value += step) found.push(Number(value.toPrecision(10)));
  return found;
}
