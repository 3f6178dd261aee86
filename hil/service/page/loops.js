// Charts of a loop: Nyquist with its forbidden circle, sensitivity with its band, steps.

import { Frame, colour, number } from "./frame.js";

const LARGEST_SENSITIVITY = 2;
const SHOWN = { left: -2.6, right: 1 };

const pairs = (xs, ys) => xs.map((x, at) => [x, ys[at]]).filter(([x, y]) => x !== null && y !== null);

// loops: [{real, imaginary, role}], the one that matters last
export function drawNyquist(canvas, loops) {
  const half = (0.5 * (SHOWN.right - SHOWN.left) * canvas.clientHeight) / canvas.clientWidth; // circles are round
  const frame = new Frame(canvas, SHOWN.left, SHOWN.right, -1.4 * half, 0.6 * half, "Re L");
  const turn = Array.from({ length: 73 }, (_, at) => (at * Math.PI) / 36);
  frame.line(turn.map((angle) => [Math.cos(angle), Math.sin(angle)]), colour("grid"));
  const around = 1 / LARGEST_SENSITIVITY; // |1 + L| = 1/|S|
  frame.line(turn.map((angle) => [-1 + around * Math.cos(angle), around * Math.sin(angle)]), colour("series-limit"), [6, 4]);
  for (const { real, imaginary, role } of loops) frame.line(pairs(real, imaginary), colour(role));
  frame.point(-1, 0, colour("series-limit"), true);
}

// lines: [{values, role}] over frequencies; limit: drawn dashed where it is one
export function drawSensitivity(canvas, hz, lines, limit = LARGEST_SENSITIVITY) {
  const high = Math.max(1.2 * limit, 1.05 * Math.max(...lines.flatMap(({ values }) => values.filter((one) => one !== null))));
  const frame = new Frame(canvas, hz[0], hz[hz.length - 1], 0, Math.min(high, 6), "Hz", "x");
  frame.band(8, 20);
  frame.axes("Hz");
  frame.limit(limit);
  for (const { values, role } of lines) frame.line(pairs(hz, values), colour(role));
}

// asked: what the step asks for, drawn dashed
export function drawStep(canvas, time, values, asked) {
  const there = values.filter((one) => one !== null);
  const low = Math.min(0, ...there), high = Math.max(asked, ...there), room = high - low;
  const frame = new Frame(canvas, time[0], time[time.length - 1], low - 0.05 * room, high + 0.08 * room, "s");
  frame.line([[time[0], 0], [0, 0], [0, asked], [time[time.length - 1], asked]], colour("series-reference"), [6, 4]);
  frame.line(pairs(time, values), colour("series-gain"));
}

export const figure = (value, unit, digits) => (value === null ? "none" : `${digits === undefined ? number(value) : value.toFixed(digits).replace("-", "−")} ${unit}`.trim());
