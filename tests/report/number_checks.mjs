// What an open report says in numbers, compared with the steps.csv of its run.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";

/** The rows of a CSV file as objects, numbers as numbers. */
export async function readTable(file) {
  const [head, ...lines] = (await readFile(file, "utf8")).trim().split("\n").map((line) => line.split(","));
  return lines.map((line) => Object.fromEntries(head.map((name, i) => [name, line[i] !== "" && !Number.isNaN(Number(line[i])) ? Number(line[i]) : line[i]])));
}

export function near(actual, expected, what) {
  assert.ok(Math.abs(actual - expected) <= 1e-9 * Math.max(1, Math.abs(expected)), `${what}: ${actual} instead of ${expected}`);
}

/** The charts hold what the table of steps holds. */
export async function chartsAreRight(page, rows) {
  const choices = await page.locator("#over option").allTextContents();
  assert.deepEqual(choices, ["time", "path length", "steps"]);
  for (let over = choices.length - 1; over >= 0; --over) {
    await page.selectOption("#over", String(over));
    await chartsOverAreRight(page, rows, over);
  }
  await page.evaluate(() => document.activeElement.blur());
}

async function chartsOverAreRight(page, rows, over) {
  const { charts, facts, motion } = await page.evaluate(() => ({
    charts: Object.fromEntries(window.frontlux.page.charts.charts.map(({ spec, plot }) => [spec.id, plot.data.map((list) => Array.from(list))])),
    facts: { ...window.frontlux.page.run.facts, steps: null }, motion: window.frontlux.page.run.motion,
  }));
  const robots = [...new Set(rows.map((row) => row.robot))], of = (robot) => rows.filter((row) => row.robot === robot), first = of(robots[0]);
  const equal = (actual, expected, what) => {
    assert.equal(actual.length, expected.length, what);
    actual.forEach((value, i) => near(value, expected[i], `${what}, ${i}`));
  };
  const column = (list, name) => list.map((row) => row[name]);
  const times = column(first, "time_s"), together = first.map((_, s) => robots.reduce((sum, robot) => sum + of(robot)[s].travelled_m, 0));
  // Of several runs, a chart has a value for each x of each run; of steps with the same x, that of the last one.
  const curve = ([xs, ...curves], i, x, ys, what) => {
    if (xs.length === x.length && curves[i].every((y) => y !== null && y !== undefined)) {
      equal(xs, x, `${what}, x`);
      return equal(curves[i], ys, what);
    }
    const wanted = new Map(x.map((value, s) => [value, ys[s]])), values = [...wanted.keys()];
    const got = xs.map((value, k) => [value, curves[i][k]]).filter(([, y]) => y !== null && y !== undefined);
    assert.equal(got.length, wanted.size, what);
    got.forEach(([value, y], k) => {
      near(value, values[k], `${what}, x`);
      near(y, wanted.get(values[k]), what);
    });
  };
  const cube = facts.resolution ** 3, volumes = (name) => (list) => list.map((row) => row[name] * facts.bounding * cube);
  const fractions = (name) => (list) => column(list, name);
  const xs = [times, together, column(first, "step")][over];
  for (const [kind, all, part] of [["coverage", fractions("coverage_observable"), fractions("robot_observable")], ["volume", volumes("coverage_box"), volumes("robot_box")]]) {
    const data = charts[kind];
    curve(data, 0, xs, all(first), `${kind} over ${over}`);
    if (robots.length > 1) robots.forEach((robot, r) => curve(data, 1 + r, xs, part(of(robot)), `${robot}'s ${kind} over ${over}`));
  }
  // In motion, a run that a limit ends has a last step without a planning: what was counted before still holds.
  const phases = ["frontiers_s", "caster_s", "goals_s", "paths_s", "optimization_s"];
  const planned = first.map((row) => !motion || phases.slice(1).some((phase) => row[phase] > 0));
  const counted = (name) => column(first, name).reduce((list, value, s) => [...list, planned[s] ? value : (list.at(-1) ?? 0)], []);
  equal(charts.frontiers[0], xs, "x of frontiers");
  ["frontiers", "unassigned", "abandoned"].forEach((name, i) => equal(charts.frontiers[1 + i], counted(name), name));
  if (over > 0) return;
  // A bar is the mean of the steps since the bar before.
  const { planning } = charts, ends = planning[0], bar = (name) => ends.map((end, k) => {
    const steps = first.filter((row) => row.time_s <= end && (k === 0 || row.time_s > ends[k - 1]));
    return column(steps, name).reduce((a, b) => a + b, 0) / steps.length;
  });
  assert.ok(ends.length <= 120 && (ends.length >= 60 || ends.length === new Set(times).size), `${ends.length} bars of ${times.length} steps`);
  assert.equal(ends.at(-1), times.at(-1));
  equal(planning[1], bar("planning_s"), "planning");
  phases.forEach((phase, p) => {
    const below = p > 0 ? planning[phases.length - p + 1] : null;
    planning[phases.length - p].map((sum, k) => sum - (below?.[k] ?? 0)).forEach((value, k) => assert.ok(Math.abs(value - bar(phase)[k]) < 1e-9, `${phase}, ${k}`));
  });
  robots.forEach((robot, r) => {
    if (!motion) {
      equal(charts.gain[1 + 2 * r], column(of(robot), "gain_predicted"), `${robot} predicted`);
      return equal(charts.gain[2 + 2 * r], column(of(robot), "gained"), `${robot} gained`);
    }
    // Only plannings count: each value is one of the table, and each of the table that is not 0 is there.
    const predicted = column(of(robot), "gain_predicted");
    charts.gain[1 + r].forEach((value, s) => assert.ok(value === predicted[s] || (predicted[s] === 0 && value === (charts.gain[1 + r][s - 1] ?? 0)), `${robot} predicted ${s}`));
  });
  // And the legend says what holds at the step that is shown.
  await page.evaluate(() => window.frontlux.page.timeline.seek(3));
  const shown = await page.locator("#chart-frontiers .legend .value").allTextContents();
  assert.deepEqual(shown.map((text) => Number(text.replaceAll(",", ""))), [first[3].frontiers, first[3].unassigned, first[3].abandoned]);
}

/** The table of milestones, by a search through the table of steps; and run.json, which counts at every scan. */
export async function milestonesAreRight(page, rows, times) {
  const robots = [...new Set(rows.map((row) => row.robot))], first = rows.filter((row) => row.robot === robots[0]);
  const cells = await page.evaluate(() => {
    const table = [...document.querySelectorAll(".details table")].find((one) => one.caption.textContent === "Progress");
    return [...table.tBodies[0].rows].map((row) => [...row.cells].map((cell) => cell.textContent));
  });
  assert.equal(cells.length, 5);
  const length = (step) => rows.filter((row) => row.step === step).reduce((sum, row) => sum + row.travelled_m, 0);
  [0.5, 0.9, 0.95, 0.99, 0].forEach((part, i) => {
    const row = part > 0 ? first.find(({ coverage_observable: coverage }) => coverage >= part) : first.at(-1);
    const [, time, metres, step] = cells[i];
    if (!row) return assert.deepEqual([time, metres, step], ["never", "never", "never"]);
    assert.equal(time, `${row.time_s.toFixed(1)} s`);
    assert.equal(metres, `${length(row.step).toFixed(length(row.step) < 100 ? 1 : 0)} m`);
    assert.equal(Number(step.replaceAll(",", "")), row.step);
    const exact = times?.[part > 0 ? String(100 * part) : "end"];
    if (times) assert.ok(row.time_s >= exact - 1e-9 && row.time_s <= exact + (part > 0 ? 1.01 : 1e-9), `${part}: ${row.time_s} s, but ${exact} s in run.json`);
  });
}
