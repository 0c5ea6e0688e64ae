// Reports that the command has written, compared with the other files of the runs.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { chartsAreRight, milestonesAreRight, readTable } from "./number_checks.mjs";
import { both, explored, lockstep, open } from "./open_report.mjs";

const percent = (part) => `${(100 * part).toFixed(1)} %`;

/** What run.json says of planning, distances, contacts, idle robots, unseen places and the map. */
export async function factsAreRight(page, json) {
  const table = (caption) => page.evaluate((name) => {
    const { tBodies } = [...document.querySelectorAll(".details table")].find((one) => one.caption.textContent === name);
    return Object.fromEntries([...tBodies[0].rows].map((row) => [row.cells[0].textContent, [...row.cells].slice(1).map((cell) => cell.textContent)]));
  }, caption);
  const run = await table("The run"), team = await table("The team"), time = (s) => page.evaluate((value) => window.frontlux.seconds(value), s);
  for (const part of [`99 % within ${await time(json.planning_p99_s)}`, `max ${await time(json.planning_max_s)}`]) assert.ok(run.Planning[0].includes(part), `${part} is not in ${run.Planning}`);
  assert.deepEqual(run.Contacts, [`${json.contacts}; robots held back ${json.held_back === 1 ? "once" : `${json.held_back} times`}`]);
  assert.deepEqual(team.idle, json.robots.map((name) => `${json.by_robot[name].idle_s.toFixed(1)} s`));
  assert.deepEqual(team["held back"], json.robots.map((name) => `${json.by_robot[name].held_back} times`));
  assert.deepEqual(await table("The last goals"), Object.fromEntries(json.robots.map((name) => [name, [json.by_robot[name].goal]])));
  const found = (cells) => cells?.[0].match(/\d+\.\d %/g), { unseen, map } = json;
  assert.deepEqual(found(run.Unseen), unseen ? [unseen.narrow, unseen.hidden, unseen.in_view].map(percent) : undefined);
  assert.deepEqual(found(run["Accuracy of the map"]), [map.surface_found, map.false_free, map.false_occupied].map(percent));
  assert.deepEqual([run["Latency charged"], run.Clearance, run["Between robots"]].map((cells) => cells?.[0].split(" ")[0]),
    json.lockstep ? [undefined, undefined, undefined] : [(await time(json.latency_s)).split(" ")[0], json.clearance_min_m.toFixed(2), json.separation_min_m.toFixed(2)]);
}

/** Reports of the command, compared with the steps.csv and run.json that the command has written. */
export async function commandIsRight(browser) {
  const runs = [];
  for (const folder of [explored, lockstep]) {
    const { page, trouble } = await open(browser, folder), rows = await readTable(`${folder}/steps.csv`);
    const json = JSON.parse(await readFile(`${folder}/run.json`, "utf8"));
    await chartsAreRight(page, rows);
    await milestonesAreRight(page, rows, json.time_s);
    const text = await page.textContent("header");
    for (const part of [`${json.time_s.end.toFixed(1)} s`, `${json.explored_m3.toFixed(json.explored_m3 < 100 ? 1 : 0)} m³`]) assert.ok(text.includes(part), `${part} is not in ${text}`);
    assert.equal(await page.locator(".warning").count(), json.warnings.length, `warnings instead of ${json.warnings.join("; ")}`);
    await factsAreRight(page, json);
    assert.deepEqual(trouble, []);
    await page.close();
    runs.push({ rows, json });
  }
  const { page, trouble } = await open(browser, both);
  for (const [i, { rows, json }] of runs.entries()) {
    await page.selectOption("#run", String(i));
    await chartsAreRight(page, rows);
    const cellsOf = (caption) => page.locator(".comparison table", { has: page.locator("caption", { hasText: caption }) }).locator(`tbody tr:nth-child(${i + 1}) > *`).allTextContents();
    const cells = await cellsOf("Comparison"), safety = await cellsOf("Planning and safety"), { unseen, map } = json;
    assert.deepEqual(safety.slice(-2), [String(json.contacts), `${json.held_back} times`]);
    const parts = [unseen?.narrow, unseen?.hidden, unseen?.in_view].map((part) => (unseen ? percent(part) : "–"));
    assert.deepEqual((await cellsOf("Unseen places and the map")).slice(1), [...parts, "–", ...[map.surface_found, map.false_free, map.false_occupied].map(percent)]);
    assert.equal(safety.at(-5), `${Object.values(json.by_robot).reduce((sum, robot) => sum + robot.idle_s, 0).toFixed(1)} s`);
    assert.equal(cells[5], json.lockstep ? "lock-step" : "in motion");
    assert.deepEqual(cells.slice(1, 4), ["room", "1", "0.3 m"]);
    assert.equal(cells[6], json.end.replaceAll("_", " "));
    assert.ok(cells[8].startsWith(`${json.time_s.end.toFixed(1)} s`), cells[8]);
    const first = rows.filter((row) => row.robot === rows[0].robot);
    [0.5, 0.9, 0.95, 0.99].forEach((part, k) => {
      const row = first.find(({ coverage_observable: coverage }) => coverage >= part);
      const begin = runs[0].rows.find(({ coverage_observable: coverage }) => coverage >= part);
      const change = row && begin && i > 0 ? Math.round(100 * (row.time_s / begin.time_s - 1)) : null;
      assert.equal(cells[9 + k], row ? `${row.time_s.toFixed(1)} s${change === null ? "" : ` (${change >= 0 ? "+" : "−"}${Math.abs(change)} %)`}` : "never");
    });
    // The legend's value of the other run is that at the same time.
    const { rows: theirs } = runs[1 - i], other = theirs.filter((row) => row.robot === theirs[0].robot);
    const step = Math.floor(first.length / 2), now = first[step].time_s;
    await page.evaluate((s) => window.frontlux.page.timeline.seek(s), step);
    const shown = (await page.locator("#chart-coverage .legend .value").allTextContents()).at(-1);
    assert.equal(shown, await page.evaluate((value) => window.frontlux.percent(value), other.findLast((row) => row.time_s <= now).coverage_observable));
  }
  assert.match(await page.textContent(".comparison"), /Compare with care: some runs are in motion and others in lock-step/);
  assert.deepEqual(trouble, []);
  await page.close();
}
