// Opens reports in headless Chromium: browser_test.mjs WEB CHROMIUM SHOTS REPORTS EVIL EXPLORED LOCKSTEP BOTH LONG
//   WEB      planner/report/web, where playwright-core is
//   SHOTS    folder for screenshots
//   REPORTS  what make_report has written: report.html and <number>/steps.csv for each run
//   EVIL     the same of a run whose names are markup
//   EXPLORED, LOCKSTEP  folders that frontlux explore has written
//   BOTH     the report of both
//   LONG     the same as REPORTS, of a run of thousands of steps
import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import { mkdir, readFile, stat, writeFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { chartsAreRight, milestonesAreRight, near, readTable } from "./number_checks.mjs";

const [web, executablePath, shots, reports, evil, explored, lockstep, both, long] = process.argv.slice(2).map((path) => resolve(path));
const { chromium } = createRequire(`${web}/package.json`)("playwright-core");
const kWithGraphics = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
const kWithout = ["--no-sandbox", "--disable-gpu", "--disable-3d-apis"];

/** Opens a report; whatever it asks of the network or complains about is an error. */
async function open(browser, folder, options = {}, hash = "") {
  const page = await browser.newPage({ viewport: { width: 1280, height: 720 }, ...options });
  const trouble = [], file = pathToFileURL(`${folder}/report.html`).href;
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && !/GPU stall|GL Driver/.test(message.text()) && trouble.push(message.text()));
  page.on("pageerror", (error) => trouble.push(error.stack));
  page.on("dialog", (dialog) => trouble.push(`dialog: ${dialog.message()}`));
  await page.route("**", (route) => {
    if (route.request().url().split("#")[0] === file) return route.continue();
    trouble.push(`request: ${route.request().url()}`);
    return route.abort();
  });
  const began = Date.now();
  await page.goto(file + hash);
  await page.waitForFunction(() => window.frontlux.ready || window.frontlux.error);
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  assert.equal(await page.evaluate(() => window.frontlux.error), undefined);
  return { page, trouble, seconds: (Date.now() - began) / 1000 };
}

async function timeLineWorks(page, rows) {
  const times = [...new Map(rows.map((row) => [row.step, row.time_s])).values()], last = times.length - 1;
  const label = () => page.textContent("#step-label"), seconds = (time) => `${time.toFixed(1)} s`;
  const says = async (step, what) => assert.ok((await label()).startsWith(`${times[step].toFixed(1)} of ${seconds(times[last])} · step ${step} of ${last} · `), `${what ?? step}: ${await label()}`);
  await says(last, "begins at the end");
  await page.keyboard.press("Home");
  await says(0);
  await page.keyboard.press("ArrowRight");
  await says(1);
  await page.click("#forward");
  await says(2);
  await page.click("#back");
  await page.click("#back");
  await says(0);
  await page.click("#last");
  await says(last);
  await page.locator("#time").fill("3");
  await says(3);
  assert.equal(await page.getAttribute("#time", "aria-valuetext"), await label());
  // It plays by the clock.
  await page.selectOption("#speed", "10");
  await page.locator("#view canvas").focus();
  await page.keyboard.press("Space");
  const [from, began] = await page.evaluate(() => [window.frontlux.page.timeline.time, performance.now()]);
  await page.waitForFunction(() => window.frontlux.page.timeline.step >= 5);
  const [to, ended] = await page.evaluate(() => [window.frontlux.page.timeline.time, performance.now()]);
  const speed = (1000 * (to - from)) / (ended - began);
  assert.ok(speed > 5 && speed < 15, `${speed} seconds of the run in a second, instead of 10`);
  assert.equal(await page.getAttribute("#play", "aria-label"), "Pause (space)");
  await page.keyboard.press("Space");
  const paused = await label();
  await page.waitForTimeout(600);
  assert.equal(await label(), paused, "it goes on although it was paused");
  const mark = () => page.evaluate(() => document.querySelector("#chart-coverage .chart-mark").style.transform);
  const before = await mark();
  await page.keyboard.press("Home");
  assert.notEqual(await mark(), before, "the charts' line stays behind");
  // A click in a chart goes to the step that is nearest.
  const box = await page.locator("#chart-coverage .u-over").boundingBox();
  await page.mouse.click(box.x + box.width * 0.5, box.y + box.height / 2);
  const middle = await page.evaluate(() => window.frontlux.page.timeline.step);
  const away = (step) => Math.abs(times[step] - times[last] / 2);
  assert.ok(times.every((_, step) => away(middle) <= away(step) + 0.02 * times[last]), `a click in the middle went to ${middle}`);
}

async function layersWork(page) {
  await page.keyboard.press("End");
  const look = async () => {
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    return createHash("sha256").update(await page.locator("#view canvas").screenshot()).digest("hex");
  };
  await page.evaluate(() => (document.querySelector("#view canvas").style.outline = "none")); // the focus is no layer
  await page.evaluate(() => window.frontlux.page.timeline.seek(2));
  const names = await page.evaluate(() => [...document.querySelectorAll(".layers input")].map((box) => box.id.replace("layer-", "")));
  assert.equal(names.length, 8, "without tours there is no layer for them");
  const all = await look();
  for (const [i, name] of names.entries()) {
    await page.locator(`#layer-${name}`).uncheck();
    assert.notEqual(await look(), all, `${name} off looks the same`);
    await page.locator("#view canvas").focus();
    await page.keyboard.press(String(i + 1));
    assert.equal(await page.isChecked(`#layer-${name}`), true, `key ${i + 1} is not for ${name}`);
    assert.equal(await look(), all, `${name} on again looks different`);
  }
  await page.selectOption("#sensor", "1");
  assert.notEqual(await look(), all, "the camera's view is not shown");
  assert.match(await page.textContent(".sensor-view"), /: ahead, 10 m/);
  await page.selectOption("#sensor", "0");
  await look();
  assert.match(await page.textContent(".sensor-view"), /: all around, ahead in the middle, 6 m/);
  await page.selectOption("#sensor", "-1");
  assert.equal(await look(), all, "the sensor's view stays");
  await page.selectOption("#colors", "owner");
  assert.notEqual(await look(), all, "colours by robot look like heights");
  await page.selectOption("#colors", "height");
  await page.locator("#cut").fill("4");
  const cut = await look();
  assert.notEqual(cut, all, "the cut hides nothing");
  await page.locator("#cut").fill(await page.getAttribute("#cut", "max"));
  assert.equal(await look(), all, "without the cut it looks different");
  await page.selectOption("#follow", "0");
  assert.notEqual(await look(), all, "following looks like not following");
  await page.click("#view-top");
  assert.notEqual(await look(), all);
  await page.click("#view-home");
  assert.equal(await look(), all);
}

/** What is drawn, compared with the map voxel by voxel: in the page, where both are. */
async function voxelsAreRight(page, rows) {
  const steps = await page.evaluate(() => window.frontlux.page.run.steps);
  for (const step of [0, 3, steps - 1, 1]) {
    const { drawn, faces, frontiers, found, parts } = await page.evaluate((s) => {
      const { page: { scene, timeline, run } } = window.frontlux, { store, voxels } = scene;
      timeline.seek(s);
      const state = (...key) => store.at(...key) & 3, sides = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
      const out = { drawn: 0, faces: 0, found: 0, frontiers: voxels.countFrontiers(), parts: run.facts.robots.map(() => 0) };
      const [low, high] = run.facts.bounds;
      for (let x = low[0] - 1; x <= high[0] + 1; ++x)
        for (let y = low[1] - 1; y <= high[1] + 1; ++y)
          for (let z = low[2] - 1; z <= high[2] + 1; ++z) {
            const here = state(x, y, z), free = sides.filter(([a, b, c]) => state(x + a, y + b, z + c) === 1).length;
            if (here === 2) out.faces += free;
            const inside = [x, y, z].every((k, i) => k >= low[i] && k <= high[i]);
            if (here === 0 && free > 0 && inside) ++out.found;
            if (here !== 0) ++out.parts[(store.at(x, y, z) >> 2) - 1];
          }
      for (const mesh of voxels.meshes) {
        if (!mesh.visible) continue;
        const bytes = mesh.geometry.getAttribute("corner").array;
        for (let f = 0; f < mesh.geometry.drawRange.count / 6; ++f) {
          const edge = (a, b) => [0, 1, 2].reduce((sum, k) => sum + Math.abs(bytes[16 * f + 4 * a + k] - bytes[16 * f + 4 * b + k]), 0);
          out.drawn += edge(0, 1) * edge(1, 2);
        }
      }
      return out;
    }, step);
    assert.ok(faces > 1000, `step ${step} has ${faces} faces only`);
    assert.equal(drawn, faces, `area of what is drawn at step ${step}`);
    assert.equal(frontiers, found, `frontiers drawn at step ${step}`);
    const next = rows.find((row) => row.step === step + 1);
    if (next) assert.equal(frontiers, next.frontiers, `frontiers at the end of step ${step} and at the beginning of the next`);
    const bounding = await page.evaluate(() => window.frontlux.page.run.facts.bounding);
    rows.filter((row) => row.step === step).forEach((row, r) => near(parts[r] / bounding, row.robot_box, `part of ${row.robot} at step ${step}`));
  }
}

/** From above, a click on the highest voxel of a column reads that voxel. */
async function picksAreRight(page) {
  // Later on the ceiling is known, and whatever lies below it is covered.
  await page.evaluate(() => window.frontlux.page.timeline.seek(1));
  await page.click("#view-top");
  for (const name of ["frontiers", "quality", "robots", "views", "travelled", "planned", "goals"]) await page.locator(`#layer-${name}`).uncheck();
  const tops = await page.evaluate(() => {
    const { scene } = window.frontlux.page, { store, run } = scene, size = run.facts.resolution, out = [];
    const view = scene.camera.position.clone(), { clientWidth: width, clientHeight: height } = scene.host;
    for (let x = store.low[0]; x <= store.high[0]; x += 5)
      for (let y = store.low[1]; y <= store.high[1]; y += 3)
        for (let z = store.high[2]; z >= store.low[2]; --z) {
          if ((store.at(x, y, z) & 3) === 2 && (store.at(x, y, z + 1) & 3) !== 1) break; // covered
          if ((store.at(x, y, z) & 3) !== 2) continue;
          const p = view.clone().set((x - 32767.5) * size, (y - 32767.5) * size, (z - 32767) * size).project(scene.camera);
          out.push({ key: [x, y, z], at: [((p.x + 1) / 2) * width, ((1 - p.y) / 2) * height] });
          break;
        }
    return out;
  });
  assert.ok(tops.length > 20);
  let hidden = 0;
  for (const { key, at } of tops) {
    const hit = await page.evaluate(([x, y]) => window.frontlux.page.pickAt(x, y), at);
    assert.equal(hit?.kind, "voxel");
    if (JSON.stringify(hit.key) !== JSON.stringify(key)) ++hidden; // the view is no straight one: others lean over it
    else assert.match(await page.textContent("#picked"), new RegExp(`Occupied voxel.*Key${key.join(", ")}First seen byu[ag]v`));
  }
  assert.ok(hidden < 0.2 * tops.length, `${hidden} of ${tops.length} clicks read another voxel`);
  const box = await page.locator("#view canvas").boundingBox();
  await page.mouse.click(box.x + tops[0].at[0], box.y + tops[0].at[1]);
  assert.equal(await page.isVisible("#picked"), true);
  for (const name of ["planned", "quality"]) await page.locator(`#layer-${name}`).check();
  await page.evaluate(() => window.frontlux.page.timeline.seek(2));
  const kinds = await page.evaluate(() => {
    const { scene, run } = { ...window.frontlux.page, run: window.frontlux.page.run }, { clientWidth: width, clientHeight: height } = scene.host;
    const spot = (x, y, z) => {
      const p = scene.camera.position.clone().set(x, y, z).project(scene.camera);
      return window.frontlux.page.pickAt(((p.x + 1) / 2) * width, ((1 - p.y) / 2) * height)?.kind;
    };
    const path = run.paths[2 * run.robots + 1], image = run.images[2 * run.robots], size = run.facts.resolution;
    const cell = image.quality.indexOf(255), viewpoint = spot(...run.poses.subarray(path.begin + 4, path.begin + 7));
    return [viewpoint, spot((image.x[cell] - 32767.5) * size, (image.y[cell] - 32767.5) * size, 0.04)];
  });
  assert.equal(kinds[0], "viewpoint");
  assert.ok(["cell", "viewpoint", "voxel"].includes(kinds[1]), `a place on the floor read as ${kinds[1]}`);
  for (const name of ["frontiers", "robots", "views", "travelled", "goals"]) await page.locator(`#layer-${name}`).check();
  await page.click("#view-home");
}

/** The planned tours at each step are those of tours.csv, and are drawn from where the robot is. */
async function toursAreRight(browser) {
  const { page, trouble } = await open(browser, explored), rows = await readTable(`${explored}/tours.csv`), steps = await readTable(`${explored}/steps.csv`);
  const robots = [...new Set(steps.map((row) => row.robot))], last = steps.at(-1).step;
  const planned = (step, robot) => {
    if (steps.find((row) => row.step === step && row.robot === robot).goal_x_m === "") return [];
    const made = rows.findLast((row) => row.step <= step && row.robot === robot)?.step;
    return rows.filter((row) => row.step === made && row.robot === robot);
  };
  const seen = await page.evaluate(() => {
    const { run } = window.frontlux.page;
    return run.tours.map((tour) => tour && { poses: Array.from(run.poses.subarray(tour.begin, tour.begin + 4 * tour.count)), clusters: tour.clusters, frontiers: tour.frontiers });
  });
  let longest = 0, best = 0;
  for (let step = 0; step <= last; ++step)
    robots.forEach((robot, r) => {
      const want = planned(step, robot), tour = seen[step * robots.length + r];
      assert.equal(tour?.clusters.length ?? 0, want.length, `stops of ${robot} at step ${step}`);
      if (want.length === 0) return;
      assert.deepEqual([tour.clusters, tour.frontiers], ["clusters", "frontiers"].map((name) => want.map((row) => row[name])));
      want.flatMap((row) => [row.x_m, row.y_m, row.z_m, row.yaw_rad]).forEach((value, i) => assert.ok(Math.abs(tour.poses[i] - value) < 1e-5));
      if (want.length > longest) [longest, best] = [want.length, step];
    });
  assert.ok(longest > 1, "the run has no tour of several stops");
  const shown = await page.evaluate((step) => {
    const { timeline, scene } = window.frontlux.page;
    timeline.seek(step);
    return scene.tours.map(({ group, marks, line, r }) => ({ visible: group.visible, marks: marks.filter((mark) => mark.visible).map((mark) => mark.position.toArray()), stops: line.geometry.instanceCount,
      begin: Array.from(line.geometry.attributes.instanceStart.data.array.subarray(0, 3)), robot: Array.from(scene.robots[r].pose.subarray(0, 3)) }));
  }, best);
  robots.forEach((robot, r) => {
    const want = planned(best, robot), { visible, marks, stops, begin, robot: where } = shown[r];
    assert.equal(visible, want.length > 0);
    if (!visible) return;
    assert.deepEqual([marks.length, stops], [want.length, want.length]);
    begin.forEach((value, k) => near(value, Math.fround(where[k]), "where the line begins"));
  });
  const look = async () => {
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    return createHash("sha256").update(await page.locator("#view canvas").screenshot()).digest("hex");
  };
  await page.screenshot({ path: `${shots}/tours.png` });
  await trailsWork(page);
  await page.evaluate((step) => window.frontlux.page.timeline.seek(step), best);
  await pointerIsRight(page, steps);
  await savedFilesAreRight(page, steps);
  await page.evaluate((step) => window.frontlux.page.timeline.seek(step), best);
  const before = await look();
  await page.keyboard.press("9");
  assert.equal(await page.isChecked("#layer-tours"), false);
  assert.notEqual(await look(), before, "tours off looks the same");
  await page.keyboard.press("9");
  assert.equal(await look(), before);
  // A click on a stop tells which one it is.
  for (const name of ["voxels", "frontiers", "planned"]) await page.locator(`#layer-${name}`).uncheck();
  const r = robots.findIndex((robot) => planned(best, robot).length === longest);
  const said = await page.evaluate((tour) => {
    const { page: report } = window.frontlux, { scene } = report, { clientWidth: width, clientHeight: height } = scene.host;
    const p = scene.tours[tour].marks[1].position.clone().project(scene.camera);
    return report.pickAt(((p.x + 1) / 2) * width, ((1 - p.y) / 2) * height);
  }, r);
  assert.equal(said.kind, "stop");
  assert.match(await page.textContent("#picked"), new RegExp(`Stop of the tour[12] of ${longest}, ${robots[r]}To look at\\d+ frontiers in \\d+ cluster`));
  assert.match(await page.textContent(".key"), /planned tour/);
  assert.deepEqual(trouble, []);
  await page.close();
}

/** Every control has a name for screen readers. */
async function controlsHaveNames(page) {
  const nameless = await page.evaluate(() => [...document.querySelectorAll("button, input, select, canvas[tabindex], [role=img]")].filter((control) => !(control.getAttribute("aria-label") || control.textContent.trim() || [...(control.labels ?? [])].some((label) => label.textContent.trim()))).map((control) => control.outerHTML));
  assert.deepEqual(nameless, []);
}

async function fits(page, what) {
  const [wide, window_] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
  assert.ok(wide <= window_, `${what}: ${wide} px of page in a window of ${window_}`);
}

async function withGraphics() {
  const browser = await chromium.launch({ executablePath, args: kWithGraphics });
  try {
    const { page, trouble, seconds } = await open(browser, reports);
    assert.ok(seconds < 5, `loading took ${seconds} s`);
    const rows = await readTable(`${reports}/0/steps.csv`), steps = rows.at(-1).step + 1;
    await timeLineWorks(page, rows);
    await layersWork(page);
    await voxelsAreRight(page, rows);
    await chartsAreRight(page, rows);
    await picksAreRight(page);
    await controlsHaveNames(page);
    const speed = await page.evaluate(() => window.frontlux.page.scene.measure(12));
    assert.ok(speed >= 4, `${speed} frames a second`);
    const idle = await page.evaluate(() => new Promise((done) => setTimeout(() => { const { scene } = window.frontlux.page, before = scene.drawn; setTimeout(() => done(scene.drawn - before), 500); }, 300)));
    assert.equal(idle, 0, "it draws although nothing changes");
    // The other run.
    await page.selectOption("#run", "1");
    await chartsAreRight(page, await readTable(`${reports}/1/steps.csv`));
    await page.evaluate(() => window.frontlux.page.timeline.seek(2));
    await page.screenshot({ path: `${shots}/comparison.png` });
    await page.selectOption("#run", "0");
    // Light and dark, by the system's wish and by the button.
    const ground = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    const light = await ground();
    await page.emulateMedia({ colorScheme: "dark" });
    const dark = await ground();
    assert.notEqual(dark, light);
    await page.waitForFunction(() => window.frontlux.page.scene.theme === "dark" && window.frontlux.page.charts.theme === "dark");
    await page.click("#theme");
    assert.equal(await ground(), light);
    await page.locator("summary").first().click();
    await page.waitForSelector("details tbody tr");
    assert.equal(await page.locator("details tbody tr").count(), steps);
    assert.deepEqual(trouble, []);
    await page.close();
    for (const [width, height] of [[1280, 720], [1920, 1080], [390, 844]])
      for (const colorScheme of ["light", "dark"]) {
        const shown = await open(browser, reports, { viewport: { width, height }, colorScheme });
        await shown.page.evaluate(() => window.frontlux.page.timeline.seek(3));
        await fits(shown.page, `${width} x ${height}`);
        await shown.page.waitForTimeout(200);
        await shown.page.screenshot({ path: `${shots}/${width}_${colorScheme}.png` });
        assert.deepEqual(shown.trouble, []);
        await shown.page.close();
      }
    await toursAreRight(browser);
    await besideWorks(browser);
    await addressIsRight(browser);
    await printsWhole(browser);
    await isAccessible(browser);
    await longRunIsQuick(browser);
    console.log(`loaded in ${seconds} s, ${speed.toFixed(1)} frames a second`);
  } finally {
    await browser.close();
  }
}

/** What run.json says of planning, distances, contacts and idle robots. */
async function safetyIsRight(page, json) {
  const table = (caption) => page.evaluate((name) => {
    const { tBodies } = [...document.querySelectorAll(".details table")].find((one) => one.caption.textContent === name);
    return Object.fromEntries([...tBodies[0].rows].map((row) => [row.cells[0].textContent, [...row.cells].slice(1).map((cell) => cell.textContent)]));
  }, caption);
  const run = await table("The run"), team = await table("The team"), time = (s) => page.evaluate((value) => window.frontlux.seconds(value), s);
  for (const part of [`99 % within ${await time(json.planning_p99_s)}`, `max ${await time(json.planning_max_s)}`]) assert.ok(run.Planning[0].includes(part), `${part} is not in ${run.Planning}`);
  assert.deepEqual(run.Contacts, [`${json.contacts}; robots held back ${json.held_back === 1 ? "once" : `${json.held_back} times`}`]);
  assert.deepEqual(team.idle, json.robots.map((name) => `${json.by_robot[name].idle_s.toFixed(1)} s`));
  assert.deepEqual(team["held back"], json.robots.map((name) => `${json.by_robot[name].held_back} times`));
  assert.deepEqual([run["Latency charged"], run.Clearance, run["Between robots"]].map((cells) => cells?.[0].split(" ")[0]),
    json.lockstep ? [undefined, undefined, undefined] : [(await time(json.latency_s)).split(" ")[0], json.clearance_min_m.toFixed(2), json.separation_min_m.toFixed(2)]);
}

/** Reports of the command, compared with the steps.csv and run.json that the command has written. */
async function commandIsRight(browser) {
  const runs = [];
  for (const folder of [explored, lockstep]) {
    const { page, trouble } = await open(browser, folder), rows = await readTable(`${folder}/steps.csv`);
    const json = JSON.parse(await readFile(`${folder}/run.json`, "utf8"));
    await chartsAreRight(page, rows);
    await milestonesAreRight(page, rows, json.time_s);
    const text = await page.textContent("header");
    for (const part of [`${json.time_s.end.toFixed(1)} s`, `${json.explored_m3.toFixed(json.explored_m3 < 100 ? 1 : 0)} m³`]) assert.ok(text.includes(part), `${part} is not in ${text}`);
    assert.equal(await page.locator(".warning").count(), json.warnings.length, `warnings instead of ${json.warnings.join("; ")}`);
    await safetyIsRight(page, json);
    assert.deepEqual(trouble, []);
    await page.close();
    runs.push({ rows, json });
  }
  const { page, trouble } = await open(browser, both);
  for (const [i, { rows, json }] of runs.entries()) {
    await page.selectOption("#run", String(i));
    await chartsAreRight(page, rows);
    const cells = await page.locator(`.comparison tbody tr:nth-child(${i + 1}) > *`).allTextContents();
    assert.deepEqual(cells.slice(-2), [String(json.contacts), `${json.held_back} times`]);
    assert.equal(cells.at(-5), `${Object.values(json.by_robot).reduce((sum, robot) => sum + robot.idle_s, 0).toFixed(1)} s`);
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

/** The values at the pointer are in the legends of all charts at once. */
async function pointerIsRight(page, rows) {
  const first = rows.filter((row) => row.robot === rows[0].robot), last = first.length - 1;
  await page.evaluate(() => window.frontlux.page.timeline.seek(0));
  const legend = (id) => page.locator(`#chart-${id} .legend .value`).allTextContents(), before = await legend("frontiers");
  const box = await page.locator("#chart-volume .u-over").boundingBox();
  await page.mouse.move(box.x + box.width - 2, box.y + box.height / 2);
  assert.deepEqual((await legend("frontiers")).map((text) => Number(text.replaceAll(",", "")))[0], first[last].frontiers);
  assert.equal((await legend("coverage"))[0], await page.evaluate((value) => window.frontlux.percent(value), first[last].coverage_observable));
  assert.equal(await page.isVisible("#chart-gain .pointed"), true);
  await page.mouse.move(2, 2);
  assert.deepEqual(await legend("frontiers"), before, "the time line's values are not back");
  assert.equal(await page.isVisible("#chart-gain .pointed"), false);
}

/** What is saved holds what is shown. */
async function savedFilesAreRight(page, rows) {
  const saved = async (act) => {
    const [download] = await Promise.all([page.waitForEvent("download"), act()]);
    return { name: download.suggestedFilename(), bytes: await readFile(await download.path()) };
  };
  const button = (id, kind) => () => page.locator(`#chart-${id} .save button`, { hasText: kind }).click();
  const first = rows.filter((row) => row.robot === rows[0].robot), robots = [...new Set(rows.map((row) => row.robot))];
  const table = await saved(button("coverage", "CSV"));
  assert.match(table.name, /_coverage_time\.csv$/);
  const lines = table.bytes.toString().trim().split("\n").map((line) => line.split(","));
  assert.equal(table.bytes.toString().split("\n")[0], `"time, s",team,${robots.join(",")}`);
  assert.equal(lines.length, 1 + first.length);
  first.forEach((row, s) => {
    near(Number(lines[1 + s][0]), row.time_s, "time in the table");
    near(Number(lines[1 + s][1]), row.coverage_observable, "coverage in the table");
  });
  for (const id of ["coverage", "planning"]) {
    const picture = await saved(button(id, "SVG"));
    const curves = await page.evaluate((text) => {
      const svg = new DOMParser().parseFromString(text, "image/svg+xml");
      return svg.querySelector("parsererror") ? -1 : svg.querySelectorAll(".curve").length;
    }, picture.bytes.toString());
    assert.equal(curves, await page.locator(`#chart-${id} .legend li`).count(), `curves in the picture of ${id}`);
    await writeFile(`${shots}/chart_${id}.svg`, picture.bytes);
  }
  const view = await saved(() => page.click("#save-view"));
  assert.match(view.name, /^[\w.+-]+\.png$/);
  assert.equal(view.bytes.subarray(1, 4).toString(), "PNG");
  const size = await page.evaluate(() => [window.frontlux.page.scene.canvas.width, window.frontlux.page.scene.canvas.height]);
  assert.equal(view.bytes.readUInt32BE(16), size[0]);
  assert.ok(view.bytes.readUInt32BE(20) > size[1] && view.bytes.length > 5000, `${view.bytes.length} bytes`);
  await writeFile(`${shots}/view.png`, view.bytes);
}

/** The address names the moment and the camera, and a report that is opened with it shows them. */
async function addressIsRight(browser) {
  const { page, trouble } = await open(browser, explored);
  assert.equal(await page.evaluate(() => location.hash), "", "nothing was moved");
  await page.evaluate(() => {
    window.frontlux.page.timeline.seek(7);
    window.frontlux.page.scene.orbit(0.7, 0.2);
  });
  await page.waitForFunction(() => location.hash !== "");
  const [hash, time, place] = await page.evaluate(() => [location.hash, window.frontlux.page.timeline.time, window.frontlux.page.scene.place]);
  assert.match(hash, /^#t=[\d.]+&camera=[-\d.,]+$/);
  const shown = (where) => where.evaluate(() => [window.frontlux.page.timeline.time, window.frontlux.page.scene.place, window.frontlux.page.shown]);
  const other = await open(browser, explored, {}, hash);
  const [theirTime, theirPlace] = await shown(other.page);
  assert.ok(Math.abs(theirTime - time) < 0.001, `${theirTime} s instead of ${time} s`);
  theirPlace.forEach((value, i) => assert.ok(Math.abs(value - place[i]) < 0.01, `camera ${theirPlace} instead of ${place}`));
  await other.page.evaluate(() => (location.hash = "#t=3"));
  await other.page.waitForFunction(() => Math.abs(window.frontlux.page.timeline.time - 3) < 1e-9);
  for (const wild of ["#t=x&camera=1,2", "#t=&run=9", "#camera=1,2,3,4,5,Infinity", "#%zz", "#t=1e9"]) {
    const odd = await open(browser, both, {}, wild);
    const [t] = await shown(odd.page);
    assert.ok(Number.isFinite(t));
    assert.deepEqual(odd.trouble, [], wild);
    await odd.page.close();
  }
  const second = await open(browser, both, {}, "#run=1&t=20");
  assert.deepEqual((await shown(second.page)).filter((_, i) => i !== 1), [20, 1]);
  assert.equal(await second.page.inputValue("#run"), "1");
  assert.deepEqual([...trouble, ...other.trouble, ...second.trouble], []);
  for (const opened of [page, other.page, second.page]) await opened.close();
}

/** Only the last part of the travelled paths stands out, if that is wanted. */
async function trailsWork(page) {
  await page.evaluate(() => window.frontlux.page.timeline.seek(30));
  const counts = () => page.evaluate(() => window.frontlux.page.scene.robots.map(({ trail, recent, materials }) => [trail.geometry.instanceCount, recent.geometry.instanceCount, materials.trail.opacity]));
  const whole = await counts();
  assert.ok(whole.every(([all, recent, opacity]) => all > 0 && recent === 0 && opacity === 1));
  const { run, time } = await page.evaluate(() => ({ run: { steps: window.frontlux.page.run.steps }, time: Array.from(window.frontlux.page.run.numbers.time) }));
  assert.ok(run.steps > 30 && time[30] > 3);
  await page.evaluate(() => window.frontlux.page.scene.setTrail(3));
  const recent = await counts(), after = time.findIndex((end) => end > time[30] - 3);
  const ends = await page.evaluate((s) => window.frontlux.page.scene.robots.map((robot) => robot.trailEnd[s - 1]), after);
  recent.forEach(([all, last], r) => assert.deepEqual([all, last], [whole[r][0], whole[r][0] - ends[r]]));
  await page.selectOption("#trail", "10");
  await page.selectOption("#trail", "Infinity");
  assert.deepEqual(await counts(), whole);
}

/** WCAG 2.1 AA as far as axe-core can tell: contrast, names, keyboard access; in both colour schemes and widths. */
async function isAccessible(browser) {
  const source = await readFile(`${web}/node_modules/axe-core/axe.min.js`, "utf8");
  for (const folder of [explored, both])
    for (const colorScheme of ["light", "dark"])
      for (const [width, height] of [[1440, 900], [390, 844]]) {
        const { page, trouble } = await open(browser, folder, { colorScheme, viewport: { width, height } });
        await page.evaluate(() => document.querySelectorAll("details").forEach((part) => (part.open = true)));
        await page.waitForSelector("details tbody tr");
        await page.evaluate(source);
        const violations = await page.evaluate(async () => (await window.axe.run(document, { runOnly: ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa"] })).violations.map(({ id, nodes }) => `${id}: ${nodes[0].html.slice(0, 200)}`));
        assert.deepEqual(violations, [], `${folder}, ${colorScheme}, ${width}`);
        assert.deepEqual(trouble, []);
        await page.close();
      }
}

/** On paper nothing is cropped, and the views are there in light colours. */
async function printsWhole(browser) {
  for (const folder of [explored, both]) {
    const { page, trouble } = await open(browser, folder, { colorScheme: "dark", viewport: { width: 718, height: 1000 } });
    await page.emulateMedia({ media: "print", colorScheme: "dark" });
    await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
    await page.waitForFunction(() => document.querySelector(".print-view").complete);
    const found = await page.evaluate(() => ({
      wide: [...document.querySelectorAll("body *")].filter((one) => one.getClientRects().length > 0 && one.getBoundingClientRect().right > innerWidth + 1).map((one) => `${one.tagName}.${one.className}`),
      cropped: [...document.querySelectorAll(".table-scroll")].filter((one) => one.scrollWidth > one.clientWidth + 1 || one.scrollHeight > one.clientHeight + 1).length,
      paper: getComputedStyle(document.body).backgroundColor, swatches: getComputedStyle(document.querySelector(".swatch")).printColorAdjust,
      picture: document.querySelector(".print-view").naturalWidth,
    }));
    assert.deepEqual(found.wide, [], "wider than the page");
    assert.equal(found.cropped, 0);
    assert.deepEqual([found.paper, found.swatches], ["rgb(255, 255, 255)", "exact"]);
    assert.ok(found.picture > 100);
    await page.screenshot({ path: `${shots}/print_${folder === both ? "both" : "one"}.png`, fullPage: true });
    await page.evaluate(() => dispatchEvent(new Event("afterprint")));
    assert.equal(await page.locator(".print-view").count(), 0);
    assert.ok((await page.pdf({ format: "A4" })).length > 20000);
    assert.deepEqual(trouble, []);
    await page.close();
  }
}

/** A second replay shows another run at the same time and, of the same world, from the same place. */
async function besideWorks(browser) {
  const { page, trouble } = await open(browser, both);
  await page.selectOption("#beside", "1");
  for (const step of [3, 20, 7]) {
    const [time, theirs, ends] = await page.evaluate((s) => {
      const { page: report } = window.frontlux;
      report.timeline.seek(s);
      return [report.timeline.time, report.second.position, Array.from(report.runs[1].numbers.time)];
    }, step);
    assert.ok(theirs.step === ends.length - 1 || (ends[theirs.step] >= time && (ends[theirs.step - 1] ?? 0) <= time), `step ${theirs.step} at ${time} s`);
  }
  const apart = () => page.evaluate(async () => {
    const { scene, second } = window.frontlux.page;
    await new Promise((done) => setTimeout(done, 300));
    return [scene.camera.position.distanceTo(second.camera.position), second.layers.voxels, second.drawn];
  });
  await page.evaluate(() => window.frontlux.page.scene.orbit(0.5, 0.1));
  await page.locator("#layer-voxels").uncheck();
  const [distance, voxels, drawn] = await apart();
  assert.ok(distance < 0.01, `the cameras are ${distance} m apart`);
  assert.equal(voxels, false);
  assert.equal((await apart())[2], drawn, "it draws although nothing changes");
  await page.locator("#layer-voxels").check();
  await page.screenshot({ path: `${shots}/beside.png` });
  await page.selectOption("#beside", "-1");
  assert.equal(await page.isVisible("#beside-view"), false);
  assert.deepEqual(trouble, []);
  await page.close();
}

/** A run of thousands of steps is as quick as others. */
async function longRunIsQuick(browser) {
  const { page, trouble, seconds } = await open(browser, long), rows = await readTable(`${long}/0/steps.csv`);
  assert.ok(rows.length > 6000);
  assert.ok(seconds < 5, `loading took ${seconds} s`);
  await chartsAreRight(page, rows);
  await milestonesAreRight(page, rows);
  const slowest = await page.evaluate(() => {
    const { timeline } = window.frontlux.page, times = [];
    for (let i = 0; i < 40; ++i) {
      const began = performance.now();
      timeline.seek(1000 + 20 * i);
      times.push(performance.now() - began);
    }
    return times.sort((a, b) => b - a)[1];
  });
  assert.ok(slowest < 250, `a step takes ${slowest} ms`);
  await page.locator("summary").first().click();
  await page.waitForSelector("details tbody tr");
  const shown = await page.locator("details tbody tr").count(), bytes = (await stat(`${long}/report.html`)).size;
  assert.ok(shown > 250 && shown <= 502, `${shown} rows of ${rows.length / 2} steps`);
  assert.ok(bytes < 8e6, `${bytes} bytes`);
  await page.screenshot({ path: `${shots}/long.png` });
  assert.deepEqual(trouble, []);
  await page.close();
  console.log(`${rows.length / 2} steps in ${(bytes / 1e6).toFixed(1)} MB loaded in ${seconds} s, slowest step ${slowest.toFixed(0)} ms`);
}

async function namesAreNoMarkup(browser) {
  const { page, trouble } = await open(browser, evil);
  assert.equal(await page.locator("img").count(), 0);
  assert.equal(await page.evaluate(() => window.evil), undefined);
  assert.match(await page.textContent("h1"), /<img src=x onerror=/);
  assert.deepEqual(trouble, []);
  await page.close();
}

async function withoutGraphics() {
  const browser = await chromium.launch({ executablePath, args: kWithout });
  try {
    const { page, trouble } = await open(browser, reports);
    assert.equal(await page.isVisible("#no-webgl"), true, "the page does not say that WebGL is missing");
    await chartsAreRight(page, await readTable(`${reports}/0/steps.csv`));
    await page.keyboard.press("Home");
    assert.match(await page.textContent("#step-label"), / · step 0 of /);
    await page.screenshot({ path: `${shots}/no_webgl.png` });
    assert.deepEqual(trouble, []);
    await namesAreNoMarkup(browser);
    await commandIsRight(browser);
  } finally {
    await browser.close();
  }
}

await mkdir(shots, { recursive: true });
await withGraphics();
await withoutGraphics();
console.log("the report works in a browser");
