// Opens reports in headless Chromium: browser_test.mjs WEB CHROMIUM SHOTS REPORTS EVIL EXPLORED
//   WEB      planner/report/web, where playwright-core is
//   SHOTS    folder for screenshots
//   REPORTS  what make_report has written: report.html and <number>/steps.csv for each run
//   EVIL     the same of a run whose names are markup
//   EXPLORED  a folder that frontlux explore has written
import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import { mkdir, readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [web, executablePath, shots, reports, evil, explored] = process.argv.slice(2).map((path) => resolve(path));
const { chromium } = createRequire(`${web}/package.json`)("playwright-core");
const kWithGraphics = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
const kWithout = ["--no-sandbox", "--disable-gpu", "--disable-3d-apis"];

/** Opens a report; whatever it asks of the network or complains about is an error. */
async function open(browser, folder, options = {}) {
  const page = await browser.newPage({ viewport: { width: 1280, height: 720 }, ...options });
  const trouble = [], file = pathToFileURL(`${folder}/report.html`).href;
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && !/GPU stall|GL Driver/.test(message.text()) && trouble.push(message.text()));
  page.on("pageerror", (error) => trouble.push(error.stack));
  page.on("dialog", (dialog) => trouble.push(`dialog: ${dialog.message()}`));
  await page.route("**", (route) => {
    if (route.request().url() === file) return route.continue();
    trouble.push(`request: ${route.request().url()}`);
    return route.abort();
  });
  const began = Date.now();
  await page.goto(file);
  await page.waitForFunction(() => window.frontlux.ready || window.frontlux.error);
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  assert.equal(await page.evaluate(() => window.frontlux.error), undefined);
  return { page, trouble, seconds: (Date.now() - began) / 1000 };
}

/** The rows of a CSV file as objects, numbers as numbers. */
async function readTable(file) {
  const [head, ...lines] = (await readFile(file, "utf8")).trim().split("\n").map((line) => line.split(","));
  return lines.map((line) => Object.fromEntries(head.map((name, i) => [name, line[i] !== "" && !Number.isNaN(Number(line[i])) ? Number(line[i]) : line[i]])));
}

function near(actual, expected, what) {
  assert.ok(Math.abs(actual - expected) <= 1e-9 * Math.max(1, Math.abs(expected)), `${what}: ${actual} instead of ${expected}`);
}

async function timeLineWorks(page, steps) {
  const label = () => page.textContent("#step-label");
  assert.match(await label(), new RegExp(`^Step ${steps - 1} of ${steps - 1}`), "begins at the end");
  await page.keyboard.press("Home");
  assert.match(await label(), /^Step 0 of/);
  await page.keyboard.press("ArrowRight");
  assert.match(await label(), /^Step 1 of/);
  await page.click("#forward");
  assert.match(await label(), /^Step 2 of/);
  await page.click("#back");
  await page.click("#back");
  assert.match(await label(), /^Step 0 of/);
  await page.click("#last");
  assert.match(await label(), new RegExp(`^Step ${steps - 1} of`));
  await page.locator("#time").fill("3");
  assert.match(await label(), /^Step 3 of/);
  assert.match(await page.getAttribute("#time", "aria-valuetext"), /^Step 3 of/);
  await page.selectOption("#speed", "4");
  await page.locator("#view canvas").focus();
  await page.keyboard.press("Space");
  await page.waitForFunction(() => window.frontlux.page.timeline.step >= 5);
  assert.equal(await page.getAttribute("#play", "aria-label"), "Pause (space)");
  await page.keyboard.press("Space");
  const paused = await label();
  await page.waitForTimeout(600);
  assert.equal(await label(), paused, "it goes on although it was paused");
  const mark = () => page.evaluate(() => document.querySelector("#chart-coverage-step .chart-mark").style.transform);
  const before = await mark();
  await page.keyboard.press("Home");
  assert.notEqual(await mark(), before, "the charts' line stays behind");
  // A click in a chart goes to the step that is nearest.
  const box = await page.locator("#chart-coverage-step .u-over").boundingBox();
  await page.mouse.click(box.x + box.width * 0.5, box.y + box.height / 2);
  const middle = await page.evaluate(() => window.frontlux.page.timeline.step);
  assert.ok(Math.abs(middle - (steps - 1) / 2) <= 1, `a click in the middle went to ${middle}`);
}

async function layersWork(page) {
  await page.keyboard.press("End");
  const look = async () => {
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    return createHash("sha256").update(await page.locator("#view canvas").screenshot()).digest("hex");
  };
  await page.evaluate(() => (document.querySelector("#view canvas").style.outline = "none")); // the focus is no layer
  await page.evaluate(() => window.frontlux.page.timeline.seek(2));
  const names = await page.evaluate(() => Object.keys(window.frontlux.page.scene.layers));
  assert.equal(names.length, 8);
  const all = await look();
  for (const [i, name] of names.entries()) {
    await page.locator(`#layer-${name}`).uncheck();
    assert.notEqual(await look(), all, `${name} off looks the same`);
    await page.locator("#view canvas").focus();
    await page.keyboard.press(String(i + 1));
    assert.equal(await page.isChecked(`#layer-${name}`), true, `key ${i + 1} is not for ${name}`);
    assert.equal(await look(), all, `${name} on again looks different`);
  }
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

/** The charts hold what the table of steps holds. */
async function chartsAreRight(page, rows) {
  const charts = await page.evaluate(() => Object.fromEntries(window.frontlux.page.charts.charts.map(({ spec, plot }) => [spec.id, { data: plot.data.map((list) => Array.from(list)), names: spec.series.map((series) => series.name), other: spec.series.map((series) => series.other === true) }])));
  const robots = [...new Set(rows.map((row) => row.robot))], of = (robot) => rows.filter((row) => row.robot === robot), first = of(robots[0]);
  const equal = (actual, expected, what) => {
    assert.equal(actual.length, expected.length, what);
    actual.forEach((value, i) => near(value, expected[i], `${what}, ${i}`));
  };
  const column = (list, name) => list.map((row) => row[name]);
  const coverage = charts["coverage-step"], team = robots.length > 1 ? 1 : 0;
  if (!coverage.other.some(Boolean)) equal(coverage.data[0], column(first, "step"), "steps");
  const short = (list) => list.slice(0, first.length);
  equal(short(coverage.data[1]), column(first, "coverage_observable"), "coverage");
  if (team) robots.forEach((robot, r) => equal(short(coverage.data[2 + r]), column(of(robot), "robot_observable"), `${robot}'s part`));
  equal(charts.frontiers.data[1], column(first, "frontiers"), "frontiers");
  equal(charts.frontiers.data[2], column(first, "unassigned"), "unassigned");
  equal(charts.frontiers.data[3], column(first, "abandoned"), "abandoned");
  const phases = ["frontiers_s", "caster_s", "goals_s", "paths_s", "optimization_s"], { data } = charts.planning;
  equal(data[1], column(first, "planning_s"), "planning");
  phases.forEach((phase, p) => equal(data[phases.length - p].map((sum, i) => sum - (p > 0 ? data[phases.length - p + 1][i] : 0)), column(first, phase), phase));
  robots.forEach((robot, r) => {
    equal(charts.gain.data[1 + 2 * r], column(of(robot), "gain_predicted"), `${robot} predicted`);
    equal(charts.gain.data[2 + 2 * r], column(of(robot), "gained"), `${robot} gained`);
  });
  // Coverage by length: at each length of the path the value at the last step with it.
  const [lengths, ...curves] = charts["coverage-length"].data;
  const curve = (values, xs, ys, what) => {
    const wanted = new Map(xs.map((x, i) => [x, ys[i]]));
    const got = lengths.map((x, i) => [x, values[i]]).filter(([, y]) => y !== null && y !== undefined);
    assert.equal(got.length, wanted.size, what);
    for (const [x, y] of got) {
      const nearest = [...wanted.keys()].reduce((a, b) => (Math.abs(b - x) < Math.abs(a - x) ? b : a));
      near(x, nearest, `${what}, length`);
      near(y, wanted.get(nearest), what);
    }
  };
  const together = first.map((_, s) => robots.reduce((sum, robot) => sum + of(robot)[s].travelled_m, 0));
  curve(curves[0], together, column(first, "coverage_observable"), "coverage by length");
  if (team) robots.forEach((robot, r) => curve(curves[1 + r], column(of(robot), "travelled_m"), column(of(robot), "robot_observable"), `${robot} by length`));
  // And the legend says what holds at the step that is shown.
  await page.evaluate(() => window.frontlux.page.timeline.seek(3));
  const shown = await page.locator("#chart-frontiers .legend .value").allTextContents();
  assert.deepEqual(shown.map((text) => Number(text.replaceAll(",", ""))), [first[3].frontiers, first[3].unassigned, first[3].abandoned]);
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
    await timeLineWorks(page, steps);
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
    console.log(`loaded in ${seconds} s, ${speed.toFixed(1)} frames a second`);
  } finally {
    await browser.close();
  }
}

/** A report of the command, compared with the steps.csv that the command has written. */
async function commandIsRight(browser) {
  const { page, trouble } = await open(browser, explored);
  await chartsAreRight(page, await readTable(`${explored}/steps.csv`));
  assert.deepEqual(trouble, []);
  await page.close();
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
    assert.match(await page.textContent("#step-label"), /^Step 0 of/);
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
