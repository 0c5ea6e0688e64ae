// Opens reports in headless Chromium: browser_test.mjs WEB CHROMIUM SHOTS REPORTS EVIL EXPLORED LOCKSTEP BOTH LONG
//   WEB      planner/report/web, where playwright-core is
//   SHOTS    folder for screenshots
//   REPORTS  what make_report has written: report.html and <number>/steps.csv for each run
//   EVIL     the same of a run whose names are markup
//   EXPLORED, LOCKSTEP  folders that frontlux explore has written
//   BOTH     the report of both
//   LONG     the same as REPORTS, of a run of thousands of steps
import assert from "node:assert/strict";
import { mkdir, readFile, stat } from "node:fs/promises";
import { commandIsRight } from "./command_checks.mjs";
import { controlsWork } from "./control_checks.mjs";
import { candidatesAreRight, frontiersAreTheirs, toursAreRight, trajectoriesAreRight } from "./motion_checks.mjs";
import { chartsAreRight, milestonesAreRight, readTable } from "./number_checks.mjs";
import { both, evil, explored, inBrowser, long, open, reports, shots, web } from "./open_report.mjs";
import { layersWork, picksAreRight, timeLineWorks, voxelsAreRight } from "./replay_checks.mjs";
import { addressIsRight, printsWhole } from "./taking_checks.mjs";

/** Every control has a name for screen readers. */
async function controlsHaveNames(page) {
  const nameless = await page.evaluate(() => [...document.querySelectorAll("button, input, select, canvas[tabindex], [role=img]")].filter((control) => !(control.getAttribute("aria-label") || control.textContent.trim() || [...(control.labels ?? [])].some((label) => label.textContent.trim()))).map((control) => control.outerHTML));
  assert.deepEqual(nameless, []);
}

async function fits(page, what) {
  const [wide, window_] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
  assert.ok(wide <= window_, `${what}: ${wide} px of page in a window of ${window_}`);
}

async function withGraphics(browser) {
  const { page, trouble, seconds } = await open(browser, reports);
  const rows = await readTable(`${reports}/0/steps.csv`), steps = rows.at(-1).step + 1;
  await timeLineWorks(page, rows);
  await layersWork(page);
  await voxelsAreRight(page, rows);
  await chartsAreRight(page, rows);
  await picksAreRight(page);
  await controlsHaveNames(page);
  const speed = await page.evaluate(() => window.frontlux.page.scene.measure(12));
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
  for (const [width, height] of [[1440, 900], [1920, 1080], [390, 844]])
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
  await trajectoriesAreRight(browser);
  await frontiersAreTheirs(browser);
  await candidatesAreRight(browser);
  await controlsWork(browser);
  await besideWorks(browser);
  await addressIsRight(browser);
  await printsWhole(browser);
  await isAccessible(browser);
  await longRunIsQuick(browser);
  console.log(`loaded in ${seconds} s, ${speed.toFixed(1)} frames a second`);
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
    // Frames and not seconds: one follows the other in the next of its frames.
    for (let frame = 0; frame < 20; ++frame) await new Promise(requestAnimationFrame);
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
  assert.ok(bytes < 5e6, `${bytes} bytes`);
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

async function withoutGraphics(browser) {
  const { page, trouble } = await open(browser, reports);
  assert.equal(await page.isVisible("#no-webgl"), true, "the page does not say that WebGL is missing");
  await chartsAreRight(page, await readTable(`${reports}/0/steps.csv`));
  await page.keyboard.press("Home");
  assert.match(await page.textContent("#step-label"), / · step 0 of /);
  await page.screenshot({ path: `${shots}/no_webgl.png` });
  assert.deepEqual(trouble, []);
  await namesAreNoMarkup(browser);
  await commandIsRight(browser);
}

await mkdir(shots, { recursive: true });
await inBrowser(true, withGraphics);
await inBrowser(false, withoutGraphics);
console.log("the report works in a browser");
