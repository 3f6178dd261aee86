// Layouts, ranges and traces: what stands in an address comes back, no peak is lost, values are those at the cursor.

import assert from "node:assert/strict";
import test from "node:test";
import { channelsOf, layoutOf, layoutText, usualLayout, withChannel, type PlotSpec } from "../../../../hil/service/frontend/src/plot/layout.ts";
import { digitsOf } from "../../../../hil/service/frontend/src/format.ts";
import { decades, numbersFrom, numbersText, panned, rangeFrom, rangeOf, rangeText, zoomed } from "../../../../hil/service/frontend/src/plot/range.ts";
import { nearest, Recent, tracesOf, valueAt, thinned } from "../../../../hil/service/frontend/src/plot/traces.ts";

const PLOTS: PlotSpec[] = [{ kind: "time", channels: ["a", "b"] }, { kind: "spectrum", channels: ["a"] }, { kind: "xy", channels: ["a", "b"] }, { kind: "time", channels: [] }];

test("a layout is read from its text", () => assert.deepEqual(layoutOf(layoutText(PLOTS)), PLOTS));

test("samples are needed of what is drawn over time, each channel once", () => assert.deepEqual(channelsOf(PLOTS), ["a", "b"]));

test("a channel comes onto a plot once; a spectrum has one, one over another two", () => {
  assert.deepEqual(withChannel(PLOTS[0] as PlotSpec, "b").channels, ["a", "b"]);
  assert.deepEqual(withChannel(PLOTS[0] as PlotSpec, "c").channels, ["a", "b", "c"]);
  assert.deepEqual(withChannel(PLOTS[1] as PlotSpec, "c").channels, ["c"]);
  assert.deepEqual(withChannel(PLOTS[2] as PlotSpec, "c").channels, ["a", "c"]);
});

test("a run with other channels than the usual ones shows its first", () => {
  assert.deepEqual(usualLayout(["x", "y"]), [{ kind: "time", channels: ["x"] }, { kind: "time", channels: ["y"] }]);
  assert.deepEqual(usualLayout(["motor_torque_nm"]), [{ kind: "time", channels: ["motor_torque_nm"] }]);
});

test("a range is read from its text, and nonsense is none", () => {
  for (const shown of ["whole" as const, { follow: 30 }, { from: 1.5, to: 2.25 }]) assert.deepEqual(rangeFrom(rangeText(shown)), shown);
  for (const text of ["2,1", "a,b", "1", "1,2,3", null]) assert.equal(rangeFrom(text), null);
  assert.deepEqual(numbersFrom(numbersText([1.25, 3])), [1.25, 3]);
  assert.deepEqual([numbersFrom("1e99,2,-1e99"), rangeFrom("0,1e99"), rangeFrom("-1e99,0")], [[2], null, null]); // no moments of a run
});

test("what follows ends at the newest sample, what holds stays", () => {
  assert.deepEqual(rangeOf({ follow: 30 }, 0, 100), { from: 70, to: 100 });
  assert.deepEqual(rangeOf({ follow: 30 }, 0, 10), { from: 0, to: 30 });
  assert.deepEqual(rangeOf({ from: 1, to: 2 }, 0, 100), { from: 1, to: 2 });
  assert.deepEqual(rangeOf("whole", 0, 100), { from: 0, to: 100 });
});

test("zooming keeps the place under the pointer, and ends at single samples", () => {
  assert.deepEqual(zoomed({ from: 0, to: 10 }, 0.5, 2), { from: 1, to: 6 });
  const { from, to } = zoomed({ from: 0, to: 1e-3 }, 0.01);
  assert.ok(to - from >= 0.005 - 1e-12);
  assert.deepEqual(panned({ from: 0, to: 10 }, 0.5), { from: 5, to: 15 });
});

test("buckets that come after each other keep every lowest and highest value", () => {
  const recent = new Recent();
  recent.add({ run: 1, start_s: 0, width_s: 0.02, channels: { a: { lowest: [0, -5], highest: [1, 2] } } });
  recent.add({ run: 1, start_s: 0.04, width_s: 0.02, channels: { a: { lowest: [3], highest: [99] } } });
  assert.deepEqual(recent.traces.channels["a"], { lowest: [0, -5, 3], highest: [1, 2, 99] });
  assert.ok(Math.abs(recent.last - 0.05) < 1e-12);
});

test("what is sent once more after a pause takes the place of what was there", () => {
  const recent = new Recent(), channel = (...values: number[]) => ({ a: { lowest: values, highest: values } });
  recent.add({ run: 1, start_s: 0, width_s: 1, channels: channel(0, 1, 2) });
  recent.add({ run: 1, start_s: 1, width_s: 1, channels: channel(1, 2, 3) });
  assert.deepEqual([recent.traces.time, recent.traces.channels["a"]?.lowest], [[0.5, 1.5, 2.5, 3.5], [0, 1, 2, 3]]);
});

test("only the last minutes are kept, and other channels begin anew", () => {
  const recent = new Recent();
  for (let at = 0; at < 300; at += 1) recent.add({ run: 1, start_s: at, width_s: 1, channels: { a: { lowest: [at], highest: [at] } } });
  assert.equal(recent.traces.time.length, 181);
  recent.add({ run: 1, start_s: 300, width_s: 1, channels: { b: { lowest: [1], highest: [1] } } });
  assert.deepEqual(Object.keys(recent.traces.channels), ["b"]);
  assert.equal(recent.traces.time.length, 1);
});

test("a value is that of the bucket at the cursor, and none where nothing was measured", () => {
  const traces = tracesOf({ run: 1, start_s: 0, width_s: 1, exact: false, channels: { a: { lowest: [1, null, 3], highest: [2, null, 3] } } });
  assert.deepEqual(valueAt(traces, "a", 0.4), { lowest: 1, highest: 2 });
  assert.equal(valueAt(traces, "a", 1.5), null);
  assert.equal(valueAt(traces, "a", 9), null);
  assert.equal(nearest([0, 1, 2], 1.4), 1);
  assert.equal(nearest([], 1), -1);
});

test("numbers of an axis have as many digits as tell its ticks apart", () => {
  assert.deepEqual([1, 2.5, 0.25, 0.1, 0.05, 20, 1e-9].map(digitsOf), [0, 1, 2, 1, 2, 0, 6]);
});

test("a logarithmic axis that begins just below a decade has an end", () => {
  assert.deepEqual(decades(0.099995, 0.35), [0.1, 0.2, 0.3]);
  assert.equal(decades(0.099995, 28.3588).at(-1), 20);
  assert.deepEqual(decades(0, 10), []);
});

test("curves that are thinned for the screen keep every peak, and holes stay holes", () => {
  const time = Array.from({ length: 10 }, (_, at) => at), highest = [0, 9, 1, 2, 3, 4, 5, null, null, null], lowest = [-1, 0, -7, 2, 3, 4, 5, null, null, null];
  const found = thinned({ time, channels: { a: { lowest, highest } } }, 4);
  assert.deepEqual(found.time, [1, 4, 7, 9]);
  assert.deepEqual(found.channels["a"], { lowest: [-7, 2, 5, null], highest: [9, 4, 5, null] });
  assert.equal(thinned({ time, channels: { a: { lowest, highest } } }, 10).time, time);
});
