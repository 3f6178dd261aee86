// What is drawn on plots beside their lines: limits, segments, events, cursors, a band of frequencies.

import type uPlot from "uplot";
import type { Mark } from "../api/types.ts";
import { colour } from "../theme.ts";
import type { LimitMark } from "./limit-lines.ts";

export const NAMES_OF_CURSORS = "ABCDEF";
const DASH = [6, 4];
const NAME_PX = 15; // of a line of text

function inside(plot: uPlot, draw: (pen: CanvasRenderingContext2D, box: uPlot.BBox) => void): void {
  const { ctx: pen, bbox: box } = plot;
  pen.save();
  pen.beginPath();
  pen.rect(box.left, box.top, box.width, box.height);
  pen.clip();
  draw(pen, box);
  pen.restore();
}

function upright(pen: CanvasRenderingContext2D, box: uPlot.BBox, x: number): void {
  pen.beginPath();
  pen.moveTo(x, box.top);
  pen.lineTo(x, box.top + box.height);
  pen.stroke();
}

// Lines with their names, each where it holds; a name that would lie over another stands at the other end.
export function drawLimits(plot: uPlot, scale: string, lines: readonly LimitMark[]): void {
  const one = devicePixelRatio, taken: number[] = [];
  inside(plot, (pen, box) => {
    pen.setLineDash(DASH.map((length) => length * one));
    pen.lineWidth = 1.4 * one;
    pen.font = `${11 * one}px sans-serif`;
    for (const { value, label, failed, holds } of lines) {
      const y = plot.valToPos(value, scale, true);
      const from = holds ? Math.max(box.left, plot.valToPos(holds.from, "x", true)) : box.left;
      const to = holds && Number.isFinite(holds.to) ? Math.min(box.left + box.width, plot.valToPos(holds.to, "x", true)) : box.left + box.width;
      if (to < from) continue;
      pen.strokeStyle = pen.fillStyle = colour(failed ? "fail" : "series-limit");
      pen.beginPath();
      pen.moveTo(from, y);
      pen.lineTo(to, y);
      pen.stroke();
      if (!label || y < box.top || y > box.top + box.height) continue;
      const high = y - box.top > NAME_PX * one, left = taken.some((other) => Math.abs(other - y) < NAME_PX * one);
      taken.push(y);
      nameAt(pen, label, left ? box.left + 3 * one : Math.max(box.left, box.left + box.width - 3 * one - pen.measureText(label).width), y + (high ? 2 - NAME_PX : 2) * one);
    }
  });
}

// With an edge in the page's colour, so that it is read where it lies over a curve.
function nameAt(pen: CanvasRenderingContext2D, name: string, x: number, top: number): void {
  pen.save();
  pen.textAlign = "left";
  pen.textBaseline = "top";
  pen.setLineDash([]);
  pen.lineJoin = "round";
  pen.lineWidth = 3 * devicePixelRatio;
  pen.strokeStyle = colour("page");
  pen.strokeText(name, x, top);
  pen.fillText(name, x, top);
  pen.restore();
}

// Segments as a bar at the top with their names, steps and events as lines, holds shaded.
export function drawMarks(plot: uPlot, marks: readonly Mark[], last: number): void {
  const one = devicePixelRatio, bar = 14 * one;
  inside(plot, (pen, box) => {
    pen.font = `${11 * one}px sans-serif`;
    pen.textAlign = "left";
    pen.textBaseline = "middle";
    for (const mark of marks) {
      const from = plot.valToPos(mark.start_s, "x", true), to = plot.valToPos(mark.end_s ?? (mark.kind === "event" ? mark.start_s : last), "x", true);
      if (to < box.left || from > box.left + box.width) continue;
      if (mark.kind === "event") {
        pen.strokeStyle = colour("quiet");
        pen.lineWidth = one;
        pen.setLineDash([one, 3 * one]);
        upright(pen, box, from);
        continue;
      }
      pen.setLineDash([]);
      pen.fillStyle = colour(mark.kind === "hold" ? "error" : "rule");
      pen.globalAlpha = mark.kind === "hold" ? 0.18 : 0.75;
      pen.fillRect(from, box.top, to - from, mark.kind === "hold" ? box.height : bar);
      pen.globalAlpha = 1;
      pen.fillStyle = colour("ink");
      const left = Math.max(from, box.left) + 4 * one;
      if (Math.min(to, box.left + box.width) - left > pen.measureText(mark.name).width) pen.fillText(mark.name, left, box.top + bar / 2);
      if (mark.step_s === null || mark.step_s === undefined) continue;
      pen.strokeStyle = colour("quiet");
      pen.lineWidth = one;
      pen.setLineDash(DASH.map((length) => length * one));
      upright(pen, box, plot.valToPos(mark.step_s, "x", true));
    }
  });
}

export function drawCursors(plot: uPlot, cursors: readonly number[], chosen: number): void {
  const one = devicePixelRatio;
  inside(plot, (pen, box) => {
    pen.font = `bold ${12 * one}px sans-serif`;
    pen.textAlign = "center";
    pen.textBaseline = "bottom";
    cursors.forEach((at, number) => {
      const x = plot.valToPos(at, "x", true);
      pen.strokeStyle = pen.fillStyle = colour("ink");
      pen.lineWidth = (number === chosen ? 2 : 1) * one;
      upright(pen, box, x);
      pen.fillRect(x - 8 * one, box.top + box.height - 16 * one, 16 * one, 16 * one);
      pen.fillStyle = colour("page");
      pen.fillText(NAMES_OF_CURSORS[number] ?? "", x, box.top + box.height - one);
    });
  });
}

export function drawBand(plot: uPlot, from: number, to: number): void {
  inside(plot, (pen, box) => {
    const left = plot.valToPos(from, "x", true);
    pen.fillStyle = colour("band");
    pen.fillRect(left, box.top, plot.valToPos(to, "x", true) - left, box.height);
  });
}
